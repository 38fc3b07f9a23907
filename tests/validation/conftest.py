"""The fixture `case` of the validation cases, and the report of a run with ``--report DIR``."""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from pathlib import Path

import pytest

from .report import Case, write

CASES = pytest.StashKey[list[Case]]()


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--report", metavar="DIR", help="run slow cases, too, and write the report")


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line("markers", "slow: runs with --report only")
    config.stash[CASES] = []


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    if config.getoption("--report", None) is None:
        skip = pytest.mark.skip(reason="slow; runs by ./dev validate")
        for item in items:
            if item.get_closest_marker("slow"):
                item.add_marker(skip)


@pytest.fixture
def case(request: pytest.FixtureRequest) -> Case:
    """Return what the test reports to."""
    title, _, about = (inspect.getdoc(request.function) or "").partition("\n")
    made = Case(
        name=request.function.__name__.removeprefix("test_").replace("_", "-"),
        title=title.removesuffix("."),
        about=" ".join(about.split()),
        family=request.module.FAMILY,
    )
    request.config.stash[CASES].append(made)
    return made


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item, call: pytest.CallInfo[None]) -> Iterator[None]:
    report = yield
    made = getattr(item, "funcargs", {}).get("case")
    if isinstance(made, Case) and call.when == "call":
        made.verdict = report.outcome
        if call.excinfo is not None:
            made.reason = str(call.excinfo.value)
            if not report.skipped:
                made.reason = f"{call.excinfo.typename}: {made.reason}"
    return report


def pytest_sessionfinish(session: pytest.Session) -> None:
    folder = session.config.getoption("--report", None)
    if folder is not None and session.config.stash[CASES]:
        print(f"\nreport: {write(session.config.stash[CASES], Path(folder))}")

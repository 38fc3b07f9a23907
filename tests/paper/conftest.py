from __future__ import annotations

from pathlib import Path

import pytest

from flexor.paper import Reproduction, Settings, reproduce

# As small as each item can be: the numbers mean nothing, but every line of the study runs.
SMALL = Settings(grid=5, search=20, thorough=50, compared_seeds=1, compared_budget=10)


@pytest.fixture(scope="session")
def small() -> Settings:
    return SMALL


@pytest.fixture(scope="session")
def whole(tmp_path_factory) -> Reproduction:
    """The whole study, in small."""
    folder: Path = tmp_path_factory.mktemp("whole")
    return reproduce(folder / "out", settings=SMALL, docs=folder / "docs" / "reproduction.md")

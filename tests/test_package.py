from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

import flexor


def test_importing_flexor_loads_nothing_heavy() -> None:
    heavy = ["matplotlib", "pymoo", "scipy", "pydantic", "cma", "numpy", "rich"]
    code = f"import sys, flexor; print([m for m in {heavy} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


@pytest.mark.parametrize("name", flexor.__all__)
def test_public_names_are_there(name: str) -> None:
    assert getattr(flexor, name) is not None
    assert name in dir(flexor)


def test_every_package_is_found_by_its_name() -> None:
    here = Path(flexor.__file__).parent
    packages = {place.parent.name for place in here.glob("*/__init__.py")}
    assert packages <= set(dir(flexor))
    for name in packages:
        assert getattr(flexor, name).__name__ == f"flexor.{name}"


def test_a_name_that_is_not_there_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="no attribute 'optimise'"):
        flexor.optimise  # noqa: B018

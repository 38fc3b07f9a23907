from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import pytest


@pytest.fixture(scope="session")
def analytic() -> ModuleType:
    """The stand-in model's module of the studies' tests."""
    path = Path(__file__).parents[1] / "study" / "analytic.py"
    spec = importlib.util.spec_from_file_location("analytic_model", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["analytic_model"] = module
    spec.loader.exec_module(module)
    return module

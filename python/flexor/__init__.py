"""Flexor: design soft exosuits with the wearer in the loop.

Examples
--------
>>> import flexor
>>> model = flexor.load("examples/finger.toml")
>>> path = model.equilibrium(force=[0, 1, 2, 3, 4, 5])  # N
>>> path.joint_angles.shape
(6, 3)
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from flexor.errors import InputError, ModelWarning
    from flexor.inverse import reach
    from flexor.model import Model, Path, load
    from flexor.study import Study, objective_function, optimize
    from flexor.study.comparison import MethodComparison, compare
    from flexor.study.landscape import Landscape, landscape

    __version__: str

__all__ = [
    "InputError",
    "Landscape",
    "MethodComparison",
    "Model",
    "ModelWarning",
    "Path",
    "Study",
    "__version__",
    "compare",
    "landscape",
    "load",
    "objective_function",
    "optimize",
    "reach",
]

# Public names are found where they live only when asked for, so that `import flexor` (and with it
# the command line's --help) does not wait for pydantic, scipy or matplotlib.
_HOME = {
    "InputError": "flexor.errors",
    "Model": "flexor.model",
    "ModelWarning": "flexor.errors",
    "Path": "flexor.model",
    "Landscape": "flexor.study.landscape",
    "MethodComparison": "flexor.study.comparison",
    "Study": "flexor.study",
    "compare": "flexor.study.comparison",
    "landscape": "flexor.study.landscape",
    "load": "flexor.model",
    "objective_function": "flexor.study",
    "optimize": "flexor.study",
    "reach": "flexor.inverse",
}
_PACKAGES = (
    "calibration",
    "cli",
    "constraints",
    "design",
    "errors",
    "exchange",
    "export",
    "inverse",
    "materials",
    "model",
    "notebook",
    "objectives",
    "observables",
    "plot",
    "optimizers",
    "scene",
    "scenarios",
    "sections",
    "store",
    "studio",
    "study",
    "viewer",
)


def __getattr__(name: str) -> object:
    if name == "__version__":
        from importlib.metadata import version

        value: object = version("flexor")
    elif name in _HOME:
        value = getattr(importlib.import_module(_HOME[name]), name)
    elif name in _PACKAGES:
        value = importlib.import_module(f"flexor.{name}")
    else:
        raise AttributeError(f"module 'flexor' has no attribute {name!r}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*__all__, *_PACKAGES})

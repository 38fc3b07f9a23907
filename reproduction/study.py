"""Shared by the scripts: published numbers, settings, models and cached results."""

from __future__ import annotations

import json
import platform
import sys
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import flexor
from flexor.design import ParameterSet, parameter_set
from flexor.errors import InputError
from flexor.store import check_regular, write_text

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

Data = dict[str, Any]
Array = NDArray[np.float64]

HERE = Path(__file__).resolve().parent
PUBLISHED: Data = tomllib.loads((HERE / "published.toml").read_text(encoding="utf-8"))

FINGER, TWO_LINKS, ALONE = "finger", "finger-2-links", "exosuit-alone"
# Sets of constants: the default of the study, and those that it is compared with.
SURFACE, PRINTED = "surface", "printed"
CONSTANTS = (SURFACE, "calibrated", "calibrated-optimum")
SETS: tuple[str, ...] = tuple(PUBLISHED["table3"])
OBJECTIVES: tuple[str, ...] = tuple(PUBLISHED["table4"])
SYMBOLS = {
    "bending": "f_b",
    "tip-force": "f_exo",
    "bending-contact": "f_bc",
    "bending-contact-printed": "f_bc as printed",
}
# The parameter set of Table IV and Fig. 6.
LINEAR = "L+R01"
LIBRARIES = ("numpy", "scipy", "pymoo", "cma", "PyNomadBBO")


@dataclass(frozen=True)
class Effort:
    """Resolutions and budgets of the study.

    Attributes
    ----------
    grid : int
        Points along each axis of the landscape of Fig. 4.
    pattern_search : int
        Maximum number of evaluations of a pattern search configured as in the paper.
    multistage : int
        Evaluations of the search for a global optimum, per parameter (at most three are counted).
    samples, starts : int
        Sample points of the fit of constants, and the number of them that are refined.
    seeds, budget : int
        Searches per method and set in the comparison, and evaluations per search.
    elements : tuple of int
        Numbers of elements of the meshes that are compared.
    """

    grid: int = 81
    pattern_search: int = 10_000
    multistage: int = 1500
    samples: int = 512
    starts: int = 6
    seeds: int = 10
    budget: int = 300
    elements: tuple[int, ...] = (5, 10, 20, 40, 80)


# Runs every line; the numbers are not valid.
QUICK = Effort(
    grid=5, pattern_search=20, multistage=15, samples=64, starts=1, seeds=1, budget=10,
    elements=(5, 10),
)  # fmt: skip


class Study:
    """The study in a folder that caches every finished result.

    Parameters
    ----------
    folder : Path
        Created if it does not exist. Results that it contains are not computed again.
    effort : Effort
        Resolutions and budgets.
    seed : int
        Random seed.
    report_progress : callable, optional
        Called with the name of the result being computed.

    Raises
    ------
    InputError
        If the folder cannot be used, or contains results of other settings, models or versions.
    """

    def __init__(
        self,
        folder: Path,
        effort: Effort | None = None,
        seed: int = 0,
        report_progress: Callable[[str], None] | None = None,
    ) -> None:
        self.folder = folder
        self.effort = effort or Effort()
        self.seed = seed
        self.report_progress = report_progress or (lambda _: None)
        self.settings: Data = json.loads(
            json.dumps({"seed": seed, **asdict(self.effort), **provenance()})
        )
        stamp = folder / "settings.json"
        if not check_regular(stamp):
            if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
                raise InputError(f'"{folder}" is not an empty folder: choose another with --out.')
            write_json(stamp, self.settings)
        kept = read_json(stamp)
        for key, value in self.settings.items():
            if kept.get(key) != value:
                raise InputError(
                    f'the results in "{folder}" were made with {key} = {kept.get(key)}, not '
                    f"{value}: delete the folder or choose another with --out."
                )

    def cached(self, name: str, compute: Callable[[], Data]) -> Data:
        """Return the values of `compute` (JSON types), computed once and saved in the folder."""
        file = made(self.folder / "results") / f"{name}.json"
        if not check_regular(file):
            self.report_progress(name)
            began = time.perf_counter()
            values = compute()
            write_json(file, {"seconds": time.perf_counter() - began, **values})
        # Fresh results are read back, too, so that a resumed report cannot differ.
        return read_json(file)

    def subfolder(self, name: str) -> tuple[Path, bool]:
        """Return the folder of a study or landscape, and whether it exists and is to be resumed."""
        place = made(self.folder / "studies") / name
        if place.is_symlink():
            raise InputError(f'"{place}" is a link: only a folder is used in its place.')
        return place, place.exists()


def provenance() -> Data:
    """Return what determines the numbers besides the settings: models and versions."""
    found = {f"model {name}": model(name).hash for name in (FINGER, TWO_LINKS, ALONE)}
    for library in ("flexor", *LIBRARIES):
        try:
            found[library] = version(library)
        except PackageNotFoundError:
            found[library] = "not installed"
    return {**found, "Python": platform.python_version()}


@cache
def model(name: str = FINGER, constants: str = SURFACE) -> flexor.Model:
    """Return a preset with a set of constants."""
    return flexor.load(name, constants=constants)


def parameters(name: str) -> ParameterSet:
    """Return a parameter set on the finger's exosuit."""
    return parameter_set(name, model().design)


def published_design(name: str, objective: str = "bending") -> Array:
    """Return a published optimum, SI: of a set for f_b, or of L+R01 for another objective."""
    table = PUBLISHED["table3"][name] if objective == "bending" else PUBLISHED["table4"][objective]
    return np.array(table["design"]) * parameters(name).scale


def follow(
    name: str, design: Array, constants: str = SURFACE, changes: Data | None = None
) -> flexor.Path:
    """Follow a design of a parameter set from 0 N to 5 N."""
    chosen = flexor.load(FINGER, constants, changes) if changes else model(FINGER, constants)
    points = chosen.design.points
    geometry = parameter_set(name, chosen.design).geometry(np.array(design)[None, :], points)
    return chosen.equilibrium(design=geometry)


def tip_angle(path: flexor.Path, step: int = -1) -> float:
    """Return the rotation of the exosuit's tip, full turns included [rad]."""
    frames = path.frames(step)["exosuit"]
    headings = np.unwrap(-np.arctan2(frames[:, 2, 0], frames[:, 0, 0]))
    return float(headings[-1] - headings[0])


def bending(path: flexor.Path, step: int = -1) -> float:
    """Return the sum of the joint angles [rad]."""
    return float(path.joint_angles[step].sum())


def write_json(file: Path, values: Data) -> None:
    """Write JSON values atomically."""
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        write_text(file, json.dumps(values, indent=1, allow_nan=False) + "\n")
    except OSError as error:
        raise InputError(f'"{file}" cannot be written: {error.strerror}.') from error


def made(folder: Path) -> Path:
    """Make a folder if it is not there; refuse anything else in its place."""
    if folder.is_symlink() or (folder.exists() and not folder.is_dir()):
        raise InputError(f'"{folder}" is no folder: only a folder is used in its place.')
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def read_json(file: Path) -> Data:
    """Read JSON values."""
    try:
        values: Data = json.loads(file.read_text(encoding="utf-8"))
        return {**values}
    except (OSError, ValueError, TypeError):
        raise InputError(f'"{file}" is damaged: delete it to compute it again.') from None

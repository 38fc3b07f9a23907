"""Folders of comparisons: settings, finished searches, and searches that are on their way.

comparison.json          what decides the numbers
model.toml               the model, as it was
runs/SET/METHOD/SEED.json  each finished search
running/                 the record of each search that has not finished
lock                     held by the process that is at it
"""

from __future__ import annotations

import json
import os
import re
import shutil
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from flexor.errors import InputError, shortened
from flexor.optimizers import SearchResult
from flexor.survey.comparison_result import SearchRun

FORMAT = 1
SETTINGS = "comparison.json"
# These may grow when a comparison is resumed; what is there must stay.
_GROWING = ("sets", "methods", "seeds")


def create(folder: Path, settings: Mapping[str, Any], model: str) -> None:
    """Make a comparison folder, whole or not at all.

    Raises
    ------
    InputError
        If the place is taken or cannot be written.
    """
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        if (folder / SETTINGS).exists():
            raise InputError(
                f'"{folder}" holds a comparison already: resume it or choose another folder.'
            )
        raise InputError(f'"{folder}" is not an empty folder: choose another.')
    draft = None
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        draft = Path(tempfile.mkdtemp(prefix=f".{folder.name}-", dir=folder.parent))
        draft.chmod(0o755)
        (draft / "model.toml").write_text(model, encoding="utf-8")
        _write_whole(draft / SETTINGS, settings)
        if folder.is_dir():
            folder.rmdir()
        os.rename(draft, folder)
    except OSError as error:
        why = (error.strerror or str(error)).lower()
        raise InputError(f'the folder "{folder}" cannot be made: {why}.') from error
    finally:
        if draft is not None:
            shutil.rmtree(draft, ignore_errors=True)


def write(folder: Path, settings: Mapping[str, Any]) -> None:
    """Write the settings, in place of any that are there.

    Raises
    ------
    InputError
        If they cannot be written; those that are there stay.
    """
    try:
        _write_whole(folder / SETTINGS, settings)
    except OSError as error:
        why = (error.strerror or str(error)).lower()
        raise InputError(f'"{folder / SETTINGS}" cannot be written: {why}.') from error


def read(folder: Path) -> dict[str, Any]:
    """Read the settings of a comparison.

    Raises
    ------
    InputError
        If the folder is not a comparison, or one that this version cannot read.
    """
    path = folder / SETTINGS
    if not path.is_file():
        what = f"it has no {SETTINGS}" if folder.is_dir() else "there is no such folder"
        raise InputError(f'"{folder}" is not a comparison: {what}.')
    try:
        values: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
        found, complete = values["format"], set(values) >= {"model", "objective", *_GROWING}
        # JSON can escape what is no text, and could then not be written again.
        json.dumps(values, ensure_ascii=False).encode("utf-8")
    except OSError as error:
        why = (error.strerror or str(error)).lower()
        raise InputError(f'"{path}" cannot be read: {why}.') from error
    except (ValueError, KeyError, TypeError, RecursionError):
        raise InputError(f'"{path}" is damaged.') from None
    if found != FORMAT:
        raise InputError(
            f'"{path}" has format {shortened(repr(found))}; this version of Flexor reads '
            f"format {FORMAT}."
        )
    if not complete:
        raise InputError(f'"{path}" is damaged.')
    return values


def merged(folder: Path, wanted: Mapping[str, Any]) -> dict[str, Any]:
    """Return the settings of a comparison with the sets, methods and seeds that are added.

    Raises
    ------
    InputError
        If what both have is not the same.
    """
    kept = read(folder)
    for key, value in wanted.items():
        if key not in (*_GROWING, "flexor") and kept.get(key) != value:
            raise InputError(
                f'the comparison "{folder}" was made with {key} = {_shown(kept.get(key))}, not '
                f"{_shown(value)}: resume it as it was or begin another."
            )
    for key in ("sets", "methods"):
        for name, value in wanted[key].items():
            if kept[key].setdefault(name, value) != value:
                raise InputError(
                    f'the comparison "{folder}" was made with another "{name}": resume it as it '
                    "was or begin another."
                )
    kept["seeds"] = sorted({*kept["seeds"], *wanted["seeds"]})
    return kept


def keep(folder: Path, run: SearchRun) -> None:
    """Keep a finished search."""
    result = run.result
    values = {
        "seconds": run.seconds if np.isfinite(run.seconds) else None,
        "design": result.design.tolist(),
        "value": result.value if np.isfinite(result.value) else None,
        "evaluations": result.evaluations,
        "iterations": result.iterations,
        "reason": result.reason,
        "improvement_evaluations": result.improvement_evaluations.tolist(),
        "improvement_values": result.improvement_values.tolist(),
        "improvement_designs": result.improvement_designs.tolist(),
    }
    path = run_file(folder, run.parameters, run.method, run.seed)
    path.parent.mkdir(parents=True, exist_ok=True)
    _write_whole(path, values)


def kept(folder: Path, parameters: str, method: str, seed: int) -> SearchRun | None:
    """Return a finished search, or None if it has not finished.

    Raises
    ------
    InputError
        If its file is damaged.
    """
    path = run_file(folder, parameters, method, seed)
    if not path.is_file():
        return None
    try:
        values = json.loads(path.read_text(encoding="utf-8"))
        design = np.array(values["design"], dtype=np.float64)
        designs = np.array(values["improvement_designs"], dtype=np.float64)
        result = SearchResult(
            design=design,
            value=np.inf if values["value"] is None else float(values["value"]),
            evaluations=int(values["evaluations"]),
            iterations=int(values["iterations"]),
            reason=str(values["reason"]),
            improvement_evaluations=np.array(values["improvement_evaluations"], dtype=np.int64),
            improvement_values=np.array(values["improvement_values"], dtype=np.float64),
            improvement_designs=designs.reshape(-1, design.size),
        )
        seconds = np.nan if values["seconds"] is None else float(values["seconds"])
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        raise InputError(f'"{path}" is damaged: delete it to search again.') from None
    return SearchRun(parameters, method, seed, result, seconds)


def run_file(folder: Path, parameters: str, method: str, seed: int) -> Path:
    """Return where a finished search is kept."""
    return folder / "runs" / _safe(parameters) / _safe(method) / f"{seed}.json"


def record_file(folder: Path, parameters: str, method: str, seed: int) -> Path:
    """Return where the record of a running search is."""
    return folder / "running" / f"{_safe(parameters)}.{_safe(method)}.{seed}.sqlite"


def _safe(name: str) -> str:
    return re.sub(r"[^\w+-]", "_", name)


def _write_whole(path: Path, values: Mapping[str, Any]) -> None:
    draft = path.with_name(path.name + ".new")
    draft.write_text(json.dumps(values, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    os.replace(draft, path)


def _shown(value: Any) -> str:
    text = "nothing" if value is None else json.dumps(value, ensure_ascii=False)
    return text if len(text) <= 60 else f"{text[:57]}..."

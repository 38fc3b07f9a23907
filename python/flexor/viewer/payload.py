"""One design as plain values for a page: meshes, colours, plots, table, verdict."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from flexor.arrays import Array
from flexor.constraints import Constraint, excesses, worst_values
from flexor.model import Model, Path
from flexor.model.results import Paths
from flexor.model.schema import ModelFile
from flexor.observables import Observable, observables
from flexor.scene import Attached, Scene, scene
from flexor.scene.objects import Free, Object
from flexor.viewer.blobs import Blobs

# Plots along the load: title, and the observables that it shows by the first part of their name.
PLOTS = (
    ("Angles", ("bending", "angle")),
    ("Forces", ("tip-force", "strap-force", "obstacle-force")),
    ("Overlap", ("overlap",)),
    ("Contact pressure", ("contact-pressure",)),
    ("Strain", ("strain",)),
    ("Volume", ("volume",)),
)
_ACTIVE = 0.02  # of the bound
_ROUNDING = 1e-9  # of the unit for display: what is smaller is shown as zero


@dataclass(frozen=True, eq=False)
class Shown:
    """A design to show.

    Attributes
    ----------
    title : str
        What it is called, such as ``"optimum"``.
    paths : Paths
        Equilibria of this one design.
    file : ModelFile
        The model file of the design, whose sections are drawn.
    constraints : tuple of Constraint
        What it has to keep.
    parameters : sequence of (str, float, str)
        Design parameters: label, value in the unit for display, unit.
    headline : str
        The verdict of the study whose best design it is; empty of others.
    cautions : sequence of str
        How far to trust that design.
    """

    title: str
    paths: Paths
    file: ModelFile
    constraints: tuple[Constraint, ...] = ()
    parameters: Sequence[tuple[str, float, str]] = ()
    headline: str = ""
    cautions: Sequence[str] = ()

    @cached_property
    def path(self) -> Path:
        """The equilibria."""
        return self.paths[0]


def design_payload(design: Shown, blobs: Blobs) -> dict[str, Any]:
    """Return what a page shows of a design; its arrays go to `blobs`.

    Parameters
    ----------
    design
        The design.
    blobs
        The table of arrays.
    """
    path, model = design.path, design.paths.model
    assert isinstance(model, Model)
    asked = {each.name for each in design.constraints}
    every = observables(model)
    found = {name: each for name, each in every.items() if name in asked or not each.costly}
    exact = {name: each.values(design.paths)[0] for name, each in found.items()}
    values = {name: _tidy(exact[name], each) for name, each in found.items()}
    one = len(model.inputs) == 1
    return {
        "title": design.title,
        "parameters": [list(each) for each in design.parameters],
        "loads": _loads(path),
        "labels": [model.show_loads(load) for load in path.loads],
        "steps": [
            {"status": str(status), "stability": str(stability)}
            for status, stability in zip(path.status, path.stability, strict=True)
        ],
        "events": [
            {
                "kind": event.kind,
                "step": event.step,
                "at": event.force / model.load_unit()[0] if one else event.step,
                "text": f"{event.kind} at {model.show_loads(event.loads, '.4g')}",
            }
            for event in path.events
        ],
        "scene": scene_payload(scene(path, design.file), blobs),
        "plots": _plots(found, values, design.constraints),
        "table": [_row(each, values[name]) for name, each in found.items()],
        "verdict": _verdict(design, model, exact),
        "warnings": list(path.warnings),
    }


def scene_payload(shown: Scene, blobs: Blobs) -> dict[str, Any]:
    """Return meshes and colour scales of a scene; their arrays go to `blobs`."""
    low, high = shown.extent()
    return {
        "low": low.tolist(),
        "high": high.tolist(),
        "steps": len(shown.path),
        "objects": [_object(each, shown, blobs) for each in shown.objects],
        "scales": {
            name: {
                "label": scale.label,
                "unit": scale.unit[1],
                "low": scale.low / scale.unit[0],
                "high": scale.high / scale.unit[0],
                "colours": blobs.bytes(scale.colours),
            }
            for name, scale in shown.scales.items()
        },
    }


def _object(each: Object, shown: Scene, blobs: Blobs) -> dict[str, Any]:
    table: dict[str, Any] = {
        "name": each.name,
        "kind": each.kind,
        "part": each.part,
        "size": each.size,
        "faces": blobs.indices(each.faces),
        "fields": {
            name: blobs.bytes(shown.scales[name].codes(values))
            for name, values in each.fields.items()
        },
    }
    if isinstance(each, Attached):
        table["local"] = blobs.floats(each.local)
        table["frame"] = blobs.indices(each.frame)
        table["frames"] = blobs.floats(each.frames[:, :, :3, :])
        table["count"] = each.frames.shape[1]
    else:
        assert isinstance(each, Free)
        table["positions"] = blobs.floats(each.positions)
    return table


def _loads(path: Path) -> dict[str, Any]:
    """Return the loads along the path as the axis of plots: of one input, or steps of several."""
    model = path.model
    if len(model.inputs) == 1:
        size, unit = model.load_unit()
        return {"label": model.inputs[0], "unit": unit, "values": _plain(path.force / size)}
    return {"label": "load step", "unit": "", "values": list(range(len(path)))}


def _plots(
    found: Mapping[str, Observable],
    values: Mapping[str, Array],
    constraints: Iterable[Constraint],
) -> list[dict[str, Any]]:
    bounds = [each for each in constraints if each.name in found]
    plots = []
    for title, kinds in PLOTS:
        names = [name for name in found if name.split(".")[0] in kinds and "." in name]
        names = [k for k in kinds if k in found and not _members(k, found)] + names
        drawn = [name for name in names if np.isfinite(values[name]).any()]
        # Joints that slide have another unit than those that turn.
        for size, unit in dict.fromkeys(found[name].unit for name in drawn):
            percent = not unit and title == "Strain"
            size = 0.01 if percent else size
            alike = [name for name in drawn if found[name].unit[1] == unit]
            plots.append(
                {
                    "title": "Displacements" if title == "Angles" and unit == "mm" else title,
                    "unit": "%" if percent else unit,
                    "series": [
                        {"name": name, "values": _plain(values[name] / size)} for name in alike
                    ],
                    "bounds": [
                        {
                            "text": f"{each.sense} {found[each.name].shown(each.bound)}",
                            "value": each.bound / size,
                        }
                        for each in bounds
                        if each.name in alike
                    ],
                }
            )
    return plots


def _tidy(values: Array, each: Observable) -> Array:
    """Return values (s,) with zeros for what is rounding, such as 1e-14 mm."""
    return np.where(np.abs(values) < _ROUNDING * each.unit[0], 0.0, values)


def _members(kind: str, found: Mapping[str, Observable]) -> bool:
    """Whether an observable has members that say more, as tensions of straps do."""
    return kind == "strap-force" and any(name.startswith(f"{kind}.") for name in found)


def _row(each: Observable, values: Array) -> dict[str, Any]:
    finite = values[np.isfinite(values)]
    largest = finite[np.argmax(np.abs(finite))] if len(finite) else np.nan
    return {
        "name": each.name,
        "text": each.text,
        "values": [each.shown(float(v)) if math.isfinite(v) else "" for v in values],
        "largest": each.shown(float(largest)) if len(finite) else "",
    }


def _verdict(design: Shown, model: Model, values: Mapping[str, Array]) -> dict[str, Any]:
    """Return the constraints, each with its worst value along the path and the place of it."""
    path, kept = design.path, design.constraints
    worst = worst_values(kept, design.paths)
    excess = excesses(kept, worst)[0] if kept else []
    rows = [
        {
            "text": each.text(model),
            "value": each.observable(model).shown(float(value)) if math.isfinite(value) else "",
            "place": each.place(path, values.get(each.name)),
            "state": "broken" if over > 0.0 else "active" if over > -_ACTIVE else "kept",
        }
        for each, value, over in zip(kept, worst[0] if kept else [], excess, strict=True)
    ]
    failed = [str(status) for status in path.status[~path.converged]]
    stated = model.file.design
    return {
        "headline": design.headline,
        "cautions": [
            {"text": text, "warns": text.split(":")[0].isupper()} for text in design.cautions
        ],
        "unchecked": not design.headline and stated is not None and bool(stated.tolerance),
        "constraints": rows,
        "feasible": not failed and all(row["state"] != "broken" for row in rows),
        "failed": failed[0] if failed else "",
        "snaps": sum(event.kind == "snap" for event in path.events),
    }


def _plain(values: Array) -> list[float | None]:
    return [float(v) if math.isfinite(v) else None for v in np.asarray(values).tolist()]

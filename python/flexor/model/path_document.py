"""One path as plain lists, as ``flexor simulate --json`` prints it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from flexor.arrays import Array
from flexor.model.friction import described

if TYPE_CHECKING:
    from flexor.model.results import Path


def path_document(path: Path) -> dict[str, Any]:
    """Return what `Path.to_dict` describes."""
    inputs = path.model.inputs
    several = {name: _plain(path.loads[:, i]) for i, name in enumerate(inputs)}
    by_step: list[list[dict[str, Any]]] = [[] for _ in range(len(path))]
    for event in path.events:
        by_step[event.step].append(
            {
                "kind": event.kind,
                "force": event.force,
                **(_loads(event.loads, inputs) if len(inputs) > 1 else {}),
                "angles_before": _plain(event.angles_before),
                "angles_after": _plain(event.angles_after),
            }
        )
    return {
        "force": _plain(path.force),
        **({"loads": several} if len(inputs) > 1 else {}),
        "joint_angles": _plain(path.joint_angles),
        "converged": path.converged.tolist(),
        "stable": path.stable.tolist(),
        "contacts": path.touching.tolist(),
        "tip_force": _plain(path.tip_force),
        **_device_quantities(path),
        "events": by_step,
        "coordinates": path.model.engine.coordinates,
        "q": _plain(path.q),
    }


def _device_quantities(path: Path) -> dict[str, Any]:
    shown: dict[str, Any] = {}
    pressures = path.model.pressures
    if pressures and path.volume is not None:
        shown["volume"] = {name: _plain(path.volume[:, i]) for i, name in enumerate(pressures)}
    if path.model.threads:
        shown["length"] = {name: _plain(found) for name, found in path.lengths().items()}
    for name, found in path.found_loads().items():
        kind = "pressure" if name in pressures else "tension"
        shown.setdefault(kind, {})[name] = _plain(found)
    if forces := path.strap_forces():
        shown["strap_force"] = {name: _plain(force) for name, force in forces.items()}
    if path.model.tendons:
        each = (
            ("tendon_length", path.tendon_lengths()),
            ("tendon_force", path.tendon_forces()),
        )
        shown |= {key: {n: _plain(v) for n, v in found.items()} for key, found in each}
    if forces := path.obstacle_forces():
        shown["obstacle_force"] = {name: _plain(force) for name, force in forces.items()}
    if path.friction is not None:
        shown["friction"] = [described(path.model, points) for points in path.friction]
        shown["dissipated"] = _plain(path.dissipated)
    if path.model.ties and path.tie_loads is not None:
        shown["ties"] = {
            name: {
                "force": _plain(path.tie_loads[:, i, :3]),
                "moment": _plain(path.tie_loads[:, i, 3:6]),
                **({"drive": _plain(path.tie_loads[:, i, 6])} if name in path.model.inputs else {}),
            }
            for i, name in enumerate(path.model.ties)
        }
    if path.stretch is not None and path.stretch.size and not np.isnan(path.stretch).all():
        shown["max_strain"] = _plain(path.max_strain)
        shown["min_stretch"] = _plain(path.min_stretch)
    shown |= {key: _plain(getattr(path, key)) for key in path.contact_quantities}
    if hoop := path.hoop_strain():
        shown["hoop_strain"] = {name: _plain(strain) for name, strain in hoop.items()}
    if places := path.places():
        shown["places"] = places
    warnings = path.warnings
    if warnings or path.model.file.materials or path.model.file.straps or path.model.ties:
        shown["warnings"] = warnings
    return shown


def _loads(loads: Array, inputs: Sequence[str]) -> dict[str, dict[str, float]]:
    return {"loads": dict(zip(inputs, loads.tolist(), strict=True))}


def _plain(values: Array) -> list[Any]:
    if values.ndim > 1:
        return [_plain(row) for row in values]
    return [value if math.isfinite(value) else None for value in values.tolist()]

"""Whether materials, skins, straps, cables, cavities, joints and solid rods exceed their limits."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from flexor.model.accuracy import accuracy
from flexor.model.folding import least_stretches
from flexor.model.hoop import LIMIT, hoop_strains, pressed_composites
from flexor.model.schema import ModelFile, Rod
from flexor.model.schema.joint import PrismaticJoint, RevoluteJoint

if TYPE_CHECKING:
    from flexor.model.path_quantities import PathQuantities

# Widths beyond its limit up to which the law of a joint is valid.
WIDTHS = 10.0
# Of what the layers of two skins are thick in all, up to which they bear one another.
SKIN = 0.5


def materials_exceeded(path: PathQuantities) -> list[str]:
    """List the materials beyond their limits, a sentence each.

    Parameters
    ----------
    path
        Equilibria of one design.

    Returns
    -------
    list of str
        With the load at which the limit is first exceeded.
    """
    if path.stretch is None:
        return []
    found = []
    for index, (name, table) in enumerate(path.model.file.materials.items()):
        stretch = path.stretch[:, index]
        if np.isnan(stretch).all():
            continue
        material = table.material(name)
        strain = np.abs(stretch - 1.0).max(axis=1)
        with np.errstate(invalid="ignore", divide="ignore"):
            stress = np.abs(material.nominal_stress(stretch)).max(axis=1)
        checks = [
            (strain, table.strain_limit, "is strained by {:.3g}", "{:.3g}"),
            (stress / 1e3, _kilo(table.stress_limit), "sees a stress of {:.4g} kPa", "{:.4g} kPa"),
            (-stretch.min(axis=1), 0.0, "has a fibre with the stretch {:.3g}", "above 0"),
        ]
        for values, limit, sentence, allowed in checks:
            if limit is None or not (values >= limit).any():
                continue
            worst = float(np.nanmax(values)) if limit else float(np.nanmin(stretch))
            load = _first_load(path, values >= limit)
            found.append(
                f'material "{name}" {sentence.format(worst)}, from {load} on beyond its limit '
                f"of {allowed.format(limit)}"
            )
    return found


def _first_load(path: PathQuantities, exceeded: NDArray[np.bool_]) -> str:
    size, unit = path.model.load_unit()
    return f"{path.force[np.argmax(exceeded)] / size:.4g} {unit}"


def skin_depth(file: ModelFile) -> float | None:
    """Return how far bodies may overlap: half of the least thickness of two skins that touch [m].

    None where no rod has a skin.
    """
    rods: list[float] = []
    links: list[float] = []
    for body in file.bodies.values():
        if body.skin is not None:
            thickness = sum(float(layer.thickness) for layer in body.skin)
            (rods if isinstance(body, Rod) else links).append(thickness)
    return SKIN * (min(rods) + min(links, default=0.0)) if rods else None


def skins_exceeded(path: PathQuantities) -> list[str]:
    """Say whether bodies overlap by more than their skins bear; see `materials_exceeded`."""
    depth = skin_depth(path.model.file)
    overlap = path.max_overlap
    if depth is None or overlap is None or not (overlap > depth).any():
        return []
    load = _first_load(path, overlap > depth)
    return [
        f"bodies overlap by {1e3 * np.nanmax(overlap):.3g} mm, from {load} on by more than "
        f"{1e3 * depth:.3g} mm, half of what their skins are thick: it cannot be worn so"
    ]


def straps_exceeded(path: PathQuantities) -> list[str]:
    """List the straps beyond their limits, a sentence each; see `materials_exceeded`."""
    found = []
    for name, forces in path.strap_forces().items():
        limit = path.model.file.straps[name].limit
        if limit is not None and (forces > limit).any():
            load = _first_load(path, forces > limit)
            found.append(
                f'strap "{name}" pulls with {np.nanmax(forces):.4g} N, from {load} on beyond its '
                f"limit of {limit:.4g} N"
            )
    return found


def cables_pushed(path: PathQuantities) -> list[str]:
    """List the cables with a negative tension, a sentence each; see `materials_exceeded`."""
    file = path.model.file
    cables = {name: "cable" for name, each in file.actuators.items() if each.kind == "cable"}
    cables |= {name: "tendon" for name, each in file.tendons.items() if each.kind == "cable"}
    found = []
    for name, what in cables.items():
        tension = path.applied[:, path.model.input_of(name)]
        if not (tension < 0.0).any():
            continue
        pushed = tension < -accuracy(path).force
        if pushed.any():
            found.append(
                f'{what} "{name}" has a tension of {np.nanmin(tension):.4g} N, from '
                f"{_first_load(path, pushed)} on below 0: a cable can only pull"
            )
    return found


def joints_exceeded(path: PathQuantities) -> list[str]:
    """List the joints too far beyond their limits, a sentence each; see `materials_exceeded`."""
    found = []
    for name, body in path.model.file.bodies.items():
        joint = body.joint
        if not isinstance(joint, RevoluteJoint | PrismaticJoint):
            continue
        angular = isinstance(joint, RevoluteJoint)
        own = path.model.engine.coordinates.index(f"{name}.theta" if angular else f"{name}.d")
        lower = -np.inf if joint.lower is None else joint.lower
        upper = np.inf if joint.upper is None else joint.upper
        beyond = np.maximum(lower - path.q[:, own], path.q[:, own] - upper)
        meant = WIDTHS * joint.limit_width
        if (beyond > meant).any():
            load = _first_load(path, beyond > meant)
            shown = np.array([np.nanmax(beyond), meant])
            far, allowed = np.degrees(shown) if angular else 1e3 * shown
            measure = "deg" if angular else "mm"
            found.append(
                f'the joint of "{name}" is {far:.4g} {measure} beyond its limit, from {load} on '
                f"more than the {allowed:.4g} {measure} up to which its law is meant"
            )
    return found


def ballooning_cavities(path: PathQuantities) -> list[str]:
    """List the cavities that widen too much for a rod model; see `materials_exceeded`."""
    found = []
    for name, rod, along in hoop_strains(path):
        pressures = path.applied[:, path.model.input_of(name)]
        strains = pressures * along.max()
        if (strains > LIMIT).any():
            pressure = pressures[np.argmax(strains > LIMIT)]
            at = path.model.file.rod(rod).sample_points[np.argmax(along)]
            found.append(
                f'the cavity of "{name}" is not wound and widens by an estimated '
                f"{100.0 * np.nanmax(strains):.3g} % at X = {at:.3g}, from "
                f"{pressure / 1e3:.4g} kPa on beyond the {100.0 * LIMIT:g} % up to which a section "
                "keeps its shape: wind it"
            )
    for name, wound in pressed_composites(path):
        if (path.applied[:, path.model.input_of(name)] > 0.0).any():
            found.append(
                f'the cavity of "{name}" is in a composite section, whose wound walls keep hoop '
                "stretch 1 and do not thin: tube, half-round and box model that"
                if wound
                else f'the cavity of "{name}" is not wound, in a composite section, which is taken '
                "to keep its shape: how much it widens is not estimated"
            )
    return found


def folded_rods(path: PathQuantities) -> list[str]:
    """List the solid rods pressed or bent through themselves; see `materials_exceeded`."""
    found = []
    for name, stretch in least_stretches(path):
        least = stretch.min(axis=1)
        if (least <= 0.0).any():
            at = np.nanmin(stretch, axis=0).argmin()
            x = path.model.file.rod(name).sample_points[at]
            found.append(
                f'"{name}" is pressed or bent through itself at X = {x:.3g}, from '
                f"{_first_load(path, least <= 0.0)} on: the least stretch of its outline is "
                f"{np.nanmin(stretch):.3g}, which has to stay above 0"
            )
    return found


def _kilo(pressure: float | None) -> float | None:
    return None if pressure is None else pressure / 1e3


def ties_redundant(path: PathQuantities) -> list[str]:
    """Return a sentence for each tie of which some conditions follow from others."""
    if path.tie_redundancy is None or not path.model.ties:
        return []
    most = np.fmax.reduce(path.tie_redundancy, axis=0, initial=0.0)
    found = []
    for name, count in zip(path.model.ties, most.astype(int).tolist(), strict=True):
        if count:
            what = "condition follows" if count == 1 else "conditions follow"
            found.append(
                f"ties.{name} is redundant: {count} {what} from other ties or joints, and its "
                "reactions are one possible choice"
            )
            if path.model.file.ties[name].drive is not None:
                found[-1] += (
                    '; if it drives a joint, give that one\'s body the joint "free" instead, '
                    "which the tie then holds alone"
                )
    return found

"""Contact of rods with links through their skins."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise
from typing import Any

import numpy as np

from flexor.arrays import Array
from flexor.materials import Material
from flexor.materials.library import library
from flexor.model.schema.body import Link, Rod
from flexor.model.schema.body_system import BodySystem
from flexor.model.schema.contact import length_shares, round_cones
from flexor.model.schema.points import SphereGroup
from flexor.model.schema.section_geometry import half_width, roundness
from flexor.model.schema.skin import compliance

# How much higher the middle of a flat underside is than its edges, so that flat on flat touches
# smoothly [m].
CROWN = 2e-5


def skin_materials(system: BodySystem) -> dict[str, Material]:
    """Return the materials that skins may have: those of the library and those of the file."""
    return {**library(), **{name: each.material(name) for name, each in system.materials.items()}}


def touching(system: BodySystem) -> list[tuple[list[str], list[str]]]:
    """Return the names of rods with a skin and of the links that they touch.

    A rod of a part touches the links of that part, of its parts and of the models that it is a part
    of, not those of other parts beside it.

    Returns
    -------
    list of pairs of lists
        For each part that has both.
    """
    rods, links = _with_skins(system)
    of_part: dict[str, list[str]] = {}
    for name in rods:
        of_part.setdefault(part_of(name), []).append(name)
    found = [
        (own, [link for link in links if are_related(part, part_of(link))])
        for part, own in of_part.items()
    ]
    return [(own, near) for own, near in found if near]


def part_of(name: str) -> str:
    """Return the name of the part that something belongs to; ``""`` of the model itself."""
    return name.rpartition(".")[0]


def are_related(part: str, other: str) -> bool:
    """Whether one of two parts is a part of the other, or the same; the model itself is ``""``."""
    shorter, longer = sorted((part, other), key=len)
    return not shorter or longer == shorter or longer.startswith(f"{shorter}.")


def _with_skins(system: BodySystem) -> tuple[list[str], list[str]]:
    """Return the names of the rods and of the links that have a skin, parents before children."""
    with_skin = {name: body for name, body in system.bodies.items() if body.skin is not None}
    rods = [name for name, body in with_skin.items() if body.kind == "rod"]
    links: dict[str, None] = {}

    def add(name: str) -> None:
        links.setdefault(name)
        for child, body in with_skin.items():
            if body.kind == "link" and body.parent == name and child not in links:
                add(child)

    for name, body in with_skin.items():
        if body.kind == "link" and body.parent not in with_skin:
            add(name)
    return rods, list(links)


def lower_skins(system: BodySystem) -> Iterator[tuple[list[dict[str, Any]], dict[str, Any]]]:
    """Describe the contact of rods with links through their skins to the engine.

    Yields
    ------
    groups, foundation
        For each rod: two groups of spheres and the foundation between them.
    """
    materials = skin_materials(system)
    for rods, names in touching(system):
        links: dict[str, Link] = {name: system.bodies[name] for name in names}  # type: ignore[misc]
        yield from _of_links(rods, links, system, materials)


def _of_links(
    rods: list[str],
    links: dict[str, Link],
    system: BodySystem,
    materials: Mapping[str, Material],
) -> Iterator[tuple[list[dict[str, Any]], dict[str, Any]]]:
    """Describe the contact of some rods with the same links, parents before children."""
    joined = [False] + [is_joined(links[b], a) for a, b in pairwise(links)]
    soft = np.repeat([compliance(link.skin, materials) for link in links.values()], 2)
    for index in np.flatnonzero(joined):
        pair = slice(2 * index - 1, 2 * index + 1)
        soft[pair] = soft[pair].mean()
    ends = [{"body": b, "station": {"fraction": f}} for b in links for f in (0.0, 1.0)]
    cones = [{"ends": [2 * i, 2 * i + 1], "joined": bool(j)} for i, j in enumerate(joined)]
    for name in rods:
        rod = system.rod(name)
        # Ends of elements have no weight: only the pressure is reported there.
        points, shares = rod.gauss_rule
        weights, tip = np.zeros((2, rod.sample_count))
        weights[points], tip[points] = shares, _tip_shares(rod, shares)
        first = [{"body": name, "station": {"point": k}} for k in range(rod.sample_count)]
        groups = [
            {"name": f"{name}.skin", "spheres": first},
            {"name": f"{name}.skin.links", "spheres": ends},
        ]
        foundation = {
            "name": f"{name}.skin",
            "first": groups[0]["name"],
            "second": groups[1]["name"],
            "weights": weights.tolist(),
            "tip": tip.tolist(),
            **underside(rod, system),
            "crown": CROWN,
            "stiffness": (1.0 / (soft + compliance(rod.skin, materials))).tolist(),
            "cones": cones,
            "alignment": _alignment(name, links, system),
        }
        yield groups, foundation


def lower_self_contact(system: BodySystem) -> Iterator[tuple[dict[str, Any], dict[str, Any]]]:
    """Describe the self-contact of rods with a skin to the engine.

    Unless told, those do that close to a ring while their surface is strained by less than one
    half, L > 4 π S. Points nearer than π S along the rod do not touch.

    Yields
    ------
    group, contact
        For each such rod: a group of spheres and their contact, with a skin twice as soft.
    """
    materials = skin_materials(system)
    for name, rod in system.bodies.items():
        if not isinstance(rod, Rod) or rod.skin is None:
            continue
        thick, length = float(rod.surface.radius.max()), float(rod.length)
        long = length > 4.0 * np.pi * thick
        if not (long if rod.self_contact is None else rod.self_contact):
            continue
        spheres = SphereGroup(bodies=(name,))
        group = {"name": f"{name}.self", "spheres": spheres.lower(system.bodies)}
        # As many as there are at the tip, where intervals may be shorter; anywhere else a little
        # further than needed.
        intervals = int(np.ceil(np.pi * thick / length * rod.elements)) + rod.last_intervals - 1
        contact = {
            "name": f"{name}.self",
            "first": group["name"],
            "second": group["name"],
            "stiffness": thick / compliance(rod.skin, materials),
            "skip": intervals * (rod.gauss_points + 1),
            "cones": round_cones(spheres, system.bodies),
            "weights": length_shares(spheres, system.bodies),
            "per_length": True,
        }
        yield group, contact


def is_joined(link: Link, before: str) -> bool:
    """Whether a link begins where a body ends, and stays there."""
    place = link.placement
    moved = any((place.x, place.y, place.z))
    return link.parent == before and not moved and link.joint.kind not in ("prismatic", "free")


def _tip_shares(rod: Rod, weights: Array) -> Array:
    """Return the share of each Gauss point's part of the rod that belongs to the tip."""
    stop = np.cumsum(weights)
    tip = 0.1 if rod.tip is None else float(rod.tip) / float(rod.length)
    return np.clip((stop - (1.0 - tip)) / weights, 0.0, 1.0)


def underside(rod: Rod, system: BodySystem) -> dict[str, Any]:
    """Describe half-width and curvature of the underside."""
    s, x = rod.surface.radius, rod.sample_points
    width, wider = (half_width(rod, system.materials, each, x) for each in (s, 1.001 * s))
    multiple = (wider - width) / (0.001 * s)
    fixed = width - multiple * s
    # A width proportional to S has no fixed part, but for rounding, which no design can follow.
    proportional = np.abs(fixed) < 1e-9 * s
    multiple = np.where(proportional, width / s, multiple)
    return {
        "half_width": np.where(proportional, 0.0, fixed).tolist(),
        "half_width_multiple": multiple.tolist(),
        "roundness": roundness(rod, system.materials),
    }


def _alignment(name: str, links: Mapping[str, Link], system: BodySystem) -> float:
    """Return the mean of cos² φ between the axes of a rod and of links in the reference state."""
    frames = system.reference_frames
    chord = frames[name](1.0)[:3, 3] - frames[name](0.0)[:3, 3]
    chord /= max(float(np.linalg.norm(chord)), 1e-300)
    lengths = np.array([float(link.length) for link in links.values()])
    cosines = np.array([chord @ frames[link](0.5)[:3, 0] for link in links])
    return float(lengths @ cosines**2 / lengths.sum())

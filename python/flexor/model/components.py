"""Parts of a model that do nothing to one another, as models of their own.

Bodies belong together if one carries the other or if a contact, a spring, a tie or another force is
between them. A body that is fixed to the world carries nothing over, nor do shared inputs.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

Json = Mapping[str, Any]
# Lists of a description that are no forces between bodies.
_APART = ("planar", "gravity", "bodies", "spheres", "materials", "shared_inputs", "controls")


def components(description: Json) -> list[dict[str, Any]]:
    """Return the descriptions of the independent components of a model.

    Parameters
    ----------
    description
        What a model is to the engine; see `flexor.model.lowering`.

    Returns
    -------
    list of dict
        In the order of their first bodies; none if there is only one. Bodies that are fixed in the
        world are in each that refers to them, with their mass in the first of these.
    """
    if description.get("frictions"):
        return []  # what has slipped is numbered by the whole model
    if any("friction" in tendon for tendon in description.get("tendons", ())):
        return []
    fixed = _fixed(description)
    groups = {group["name"]: _carriers(group) for group in description.get("spheres", ())}
    bodies = {body["name"]: "" for body in description["bodies"]}
    # Tendons name wraps, and so the bodies that carry these.
    groups |= {each["name"]: _bodies_of(each, bodies, {}) for each in description.get("wraps", ())}
    of = _joined(description, fixed, groups)
    roots = list(dict.fromkeys(of.values()))
    if len(roots) < 2:
        return []
    heavy: set[str] = set()
    found = []
    for first, root in enumerate(roots):
        own = {name for name, other in of.items() if other == root}
        found.append(_part(description, own, fixed, groups, heavy, first == 0))
    return found


def _fixed(description: Json) -> set[str]:
    """Return the names of the bodies that never move."""
    found: set[str] = set()
    for body in description["bodies"]:
        rests = body["parent"] is None or body["parent"] in found
        if rests and body["joint"]["kind"] == "fixed" and "link" in body["shape"]:
            found.add(body["name"])
    return found


def _carriers(group: Json) -> set[str]:
    return {sphere["body"] for sphere in group["spheres"]}


def _forces(description: Json) -> Iterator[tuple[str, Json]]:
    for table, entries in description.items():
        if table not in _APART:
            yield from ((table, entry) for entry in entries)


def texts(value: Any) -> Iterator[str]:
    """Yield every text in a description or table, of which names of bodies and others are some."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, Mapping):
        for each in value.values():
            yield from texts(each)
    elif isinstance(value, (list, tuple)) and not (value and isinstance(value[0], float)):
        for each in value:
            yield from texts(each)


def _on_world(table: str, entry: Json) -> bool:
    """Whether groups that a force names touch the world only, and so not one another."""
    return table == "obstacles" and "world" in entry["at"]


def _bodies_of(entry: Json, bodies: Mapping[str, str], groups: Mapping[str, set[str]]) -> set[str]:
    """Return the bodies between which a force acts."""
    found: set[str] = set()
    for text in texts(entry):
        if text in bodies:
            found.add(text)
        found |= groups.get(text, set())
    return found


def _joined(description: Json, fixed: set[str], groups: Mapping[str, set[str]]) -> dict[str, str]:
    """Return the first body of the component of each body that moves."""
    of = {body["name"]: body["name"] for body in description["bodies"]}

    def join(names: set[str]) -> None:
        roots = {of[name] for name in names - fixed}
        if len(roots) > 1:
            first = min(roots, key=order.__getitem__)
            for name, root in of.items():
                if root in roots:
                    of[name] = first

    order = {name: index for index, name in enumerate(of)}
    for body in description["bodies"]:
        if body["parent"] is not None:
            join({body["name"], body["parent"]})
    for table, entry in _forces(description):
        if _on_world(table, entry):
            for name in entry["spheres"]:
                join(groups[name])
        else:
            join(_bodies_of(entry, of, groups))
    return {name: root for name, root in of.items() if name not in fixed}


def _part(
    description: Json,
    own: set[str],
    fixed: set[str],
    groups: Mapping[str, set[str]],
    heavy: set[str],
    takes_rest: bool,
) -> dict[str, Any]:
    """Describe one component, with forces between bodies that never move if it takes the rest."""
    by_name = {body["name"]: body for body in description["bodies"]}
    made: dict[str, Any] = {key: description[key] for key in ("planar", "gravity")}
    needed = set(own)
    forces: dict[str, list[Any]] = {}
    for table, entry in _forces(description):
        bodies = _bodies_of(entry, dict.fromkeys(by_name, ""), groups)
        if table == "wraps":
            continue
        if not (bodies & own or (takes_rest and bodies <= fixed)):
            continue
        if _on_world(table, entry):
            entry = {**entry, "spheres": [name for name in entry["spheres"] if groups[name] & own]}
            skins = [each for each in entry.pop("skins", ()) if groups[each["spheres"]] & own]
            if skins:
                entry["skins"] = skins
            pressing = [*entry["spheres"], *(each["spheres"] for each in skins)]
            bodies = {body for name in pressing for body in groups[name]}
        forces.setdefault(table, []).append(entry)
        needed |= bodies
    passed = set(texts(forces.get("tendons", ())))
    for wrap in description.get("wraps", ()):
        carriers = groups[wrap["name"]]
        if wrap["name"] in passed or carriers & own or (takes_rest and carriers <= fixed):
            forces.setdefault("wraps", []).append(wrap)
            needed |= carriers
    for name in list(needed):
        above = by_name[name]["parent"]
        while above is not None:
            needed.add(above)
            above = by_name[above]["parent"]
    if takes_rest:
        needed |= fixed
    made["bodies"] = [
        _light(body) if body["name"] in heavy else body
        for body in description["bodies"]
        if body["name"] in needed
    ]
    heavy |= needed & fixed
    named = {text for entries in forces.values() for text in texts(entries)}
    spheres = [
        {**group, "spheres": [each for each in group["spheres"] if each["body"] in needed]}
        for group in description.get("spheres", ())
        if groups[group["name"]] & own or group["name"] in named
    ]
    if spheres:
        made["spheres"] = spheres
    if "materials" in description:
        made["materials"] = description["materials"]
    made |= forces
    inputs = {entry["name"] for entries in forces.values() for entry in entries if "name" in entry}
    for key, chosen in (("shared_inputs", _shared(description, inputs)), ("controls", None)):
        found = chosen
        if found is None:
            found = [name for name in description.get(key, ()) if name in inputs]
        if found:
            made[key] = found
    return made


def _shared(description: Json, inputs: set[str]) -> list[Any]:
    drives = (
        {**each, "drives": [name for name in each["drives"] if name in inputs]}
        for each in description.get("shared_inputs", ())
    )
    return [each for each in drives if each["drives"]]


def _light(body: Json) -> dict[str, Any]:
    """Return a link without mass, whose weight counts elsewhere."""
    link = {**body["shape"]["link"], "density": 0.0}
    return {**body, "shape": {**body["shape"], "link": link}}

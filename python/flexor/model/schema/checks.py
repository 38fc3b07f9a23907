"""Consistency checks between the tables of a model file."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

from flexor.errors import unknown_name
from flexor.model.schema.body import Body, Rod
from flexor.model.validation import field_error

_NAME = re.compile(r"[A-Za-z]\w*(-\w+)*", re.ASCII)


def is_name(name: object) -> bool:
    """Whether something can be the name of an entry, without that of a part before it."""
    return isinstance(name, str) and _NAME.fullmatch(name) is not None


def check_names(tables: Mapping[str, Iterable[str]]) -> None:
    """Check that names are valid, and unique but for groups of spheres.

    The engine finds bodies and forces by name alone; a group may be called like the body it covers.
    Names of parts come before those of their entries, with dots between them.
    """
    for table, names in tables.items():
        for name in names:
            if not all(map(is_name, name.split("."))):
                rule = "names start with a letter and consist of letters, digits, _ and -"
                raise field_error(f'contains "{name}": {rule}', path=table)
    owner: dict[str, str] = {}
    for table, names in tables.items():
        if table == "spheres":
            continue
        for name in names:
            if name in owner:
                raise field_error(
                    f"has the same name as {owner[name]}.{name}", path=f"{table}.{name}"
                )
            owner[name] = table
    for name, table in owner.items():
        parts = name.split(".")
        for part in (".".join(parts[:end]) for end in range(1, len(parts))):
            if part in owner:
                tail = f'has the same name as the part "{part}", of which {table}.{name} is'
                raise field_error(f"{tail}: rename one", path=f"{owner[part]}.{part}")


def check_tree(bodies: Mapping[str, Body]) -> None:
    """Check that every parent exists and that there are no cycles."""
    for name, body in bodies.items():
        if body.parent is not None:
            check_known(body.parent, "body", bodies, f"bodies.{name}.parent")
    rooted: set[str] = set()
    for name in bodies:
        line: dict[str, None] = {}
        above: str | None = name
        while above is not None and above not in rooted:
            if above in line:
                ring = list(line)[list(line).index(above) :]
                shown = " -> ".join([*ring, above] if len(ring) < 20 else [*ring[:20], "..."])
                raise field_error(
                    f'is "{bodies[above].parent}": a body cannot be its own ancestor ({shown})',
                    path=f"bodies.{above}.parent",
                )
            line[above] = None
            above = bodies[above].parent
        rooted.update(line)


def check_known(name: str, kind: str, allowed: Mapping[str, object], path: str) -> None:
    """Check that a name is one of those allowed."""
    if name not in allowed:
        raise field_error(f"refers to the {unknown_name(kind, name, allowed)}", path=path)


def check_rod(name: str, bodies: Mapping[str, Body], path: str) -> None:
    """Check that a name is that of a rod."""
    check_known(name, "body", bodies, path)
    if not isinstance(bodies[name], Rod):
        names = [f'"{n}"' for n, body in bodies.items() if isinstance(body, Rod)]
        rods = ", " + ", ".join(names) if names else ""
        raise field_error(f'is "{name}", which is a link: expected a rod{rods}', path=path)


def check_ratio(friction: float, ratio: float | None) -> None:
    """Check that a tangential stiffness is given with friction only."""
    if ratio is not None and friction == 0.0:
        raise field_error("is given without friction", path="stiffness_ratio")

"""Any model file that is valid comes back the same from being written and read."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from flexor.model import Model, parse
from flexor.model.reading import check

Draw = Callable[[st.SearchStrategy[Any]], Any]
LENGTHS = ("m", "cm", "mm", "in", "um")
ELEMENT_BASES = {"nodal_linear": 1, "nodal_quadratic": 2, "nodal_cubic": 3, "hermite": 3}
POLYNOMIALS = ("monomial", "legendre", "chebyshev")
MODES = {"twist_x": 0, "bend_y": 1, "bend_z": 0, "extend_x": 1, "shear_y": 0, "shear_z": 1}
NUMBERS = st.floats(-1e3, 1e3, allow_nan=False)
POSITIVE = st.floats(1e-3, 1e3)


def quantities(*units: str, numbers: st.SearchStrategy[float] = POSITIVE) -> Any:
    """Quantities as people write them: in any unit, in any notation."""
    formats = st.sampled_from(["{!r}", "{:.3g}", "{:e}", "{:.6f}1", "+{:.4f}2"])
    written = st.builds(lambda form, x: form.format(abs(x)), formats, numbers)
    signed = st.builds(
        lambda x, text: f"-{text.lstrip('+')}" if x < 0.0 else text, numbers, written
    )
    text = written if numbers is POSITIVE else signed
    spaces = st.sampled_from([" ", "", "  "])
    return st.builds(lambda t, s, u: f"{t}{s}{u}", text, spaces, st.sampled_from(units))


LENGTH, OFFSET = quantities(*LENGTHS), quantities(*LENGTHS, numbers=NUMBERS)
ANGLE = quantities("deg", "rad", numbers=NUMBERS)
ANGULAR = quantities("N*m/rad", "N*mm/deg", "N*m")
STIFFNESS = quantities("N/m", "N/mm", "kN/m")
FORCE = quantities("N", "mN", "lbf", numbers=NUMBERS)
MOMENT = quantities("N*m", "N*mm", numbers=NUMBERS)
DENSITY = quantities("kg/m^3", "g/cm^3")
NAMES = st.from_regex(r"[A-Za-z][A-Za-z0-9_]{0,6}", fullmatch=True)


def maybe(table: dict[str, Any], draw: Draw, **fields: st.SearchStrategy[Any]) -> dict[str, Any]:
    """Add each field, or leave it out."""
    for name, strategy in fields.items():
        if draw(st.booleans()):
            table[name] = draw(strategy)
    return table


def vectors(strategy: Any, axes: str) -> Any:
    return st.fixed_dictionaries({}, optional=dict.fromkeys(axes, strategy))


def joint(draw: Draw, planar: bool) -> Any:
    kinds = ["fixed", "revolute", "prismatic", "free"] + (
        [] if planar else ["universal", "spherical"]
    )
    kind = draw(st.sampled_from(kinds))
    table: dict[str, Any] = {"kind": kind}
    if kind in ("revolute", "prismatic"):
        turning = kind == "revolute"
        axes: list[Any] = ["y"] if turning else ["x", "z", [0.6, 0, -0.8], [1, 0, 2]]
        axes = axes if planar else [*axes, "x", "y", "z", [1.0, 2, 3]]
        where = ANGLE if turning else OFFSET
        width = quantities("deg", "rad") if turning else LENGTH
        stiffness = ANGULAR if turning else STIFFNESS
        maybe(table, draw, axis=st.sampled_from(axes), stiffness=stiffness, rest=where)
        maybe(table, draw, limit_stiffness=stiffness, limit_width=width)
        unit = "deg" if turning else "cm"
        maybe(table, draw, lower=quantities(unit).map(lambda text: f"-{text.lstrip('+')}"))
        maybe(table, draw, upper=quantities(unit))
    elif kind != "fixed":
        count = 2 if kind == "universal" else 3
        several = st.one_of(ANGULAR, st.lists(ANGULAR, min_size=count, max_size=count))
        maybe(table, draw, stiffness=several)
        if kind == "free":
            maybe(table, draw, linear_stiffness=st.lists(STIFFNESS, min_size=3, max_size=3))
    return table


def rod(draw: Draw, planar: bool) -> dict[str, Any]:
    modes = [mode for mode, flat in MODES.items() if flat or not planar]
    strain: dict[str, Any] = {}
    needed, elements = 1, draw(st.integers(1, 4))
    for mode in draw(st.lists(st.sampled_from(modes), min_size=1, unique=True)):
        basis = draw(st.sampled_from([*ELEMENT_BASES, *POLYNOMIALS]))
        if basis in ELEMENT_BASES:
            needed = max(needed, ELEMENT_BASES[basis] + 1)
            strain[mode] = draw(st.sampled_from([basis, {"basis": basis}]))
        else:
            order = draw(st.integers(0, 5))
            needed = max(needed, -(-(order + 1) // elements))
            strain[mode] = {"basis": basis, "order": order}
    curvature = quantities(" 1/m", "deg/cm", numbers=NUMBERS)
    rest = {m: curvature for m in modes if m[:4] in ("twis", "bend")}
    rest.update({m: NUMBERS for m in modes if m.startswith("shear")}, extend_x=POSITIVE)
    sections = [
        "circular",
        {"kind": "circular"},
        {"kind": "elliptic", "ratio": 1.5},
        {"kind": "rectangular", "ratio": 2},
    ]
    radii = st.one_of(
        LENGTH,
        st.fixed_dictionaries({"base": LENGTH, "tip": LENGTH}),
        st.lists(LENGTH, min_size=2, max_size=5),
    )
    table: dict[str, Any] = {
        "kind": "rod",
        "length": draw(LENGTH),
        "radius": draw(radii),
        "young_modulus": draw(quantities("kPa", "MPa", "psi", "Pa")),
        "poisson_ratio": draw(st.floats(-0.99, 0.5)),
        "strain": strain,
        "elements": elements,
        "gauss_points": draw(st.integers(needed, needed + 2)),
    }
    maybe(table, draw, section=st.sampled_from(sections), density=DENSITY)
    maybe(table, draw, magnus_order=st.sampled_from([2, 4]))
    return maybe(table, draw, reference_strain=st.fixed_dictionaries({}, optional=rest))


def link(draw: Draw) -> dict[str, Any]:
    radii = st.one_of(LENGTH, st.fixed_dictionaries({"base": LENGTH, "tip": LENGTH}))
    table = {"kind": "link", "length": draw(LENGTH), "radius": draw(radii)}
    return maybe(table, draw, density=DENSITY)


def place(draw: Draw, bodies: Mapping[str, Any]) -> dict[str, Any]:
    """Draw a place on any body."""
    name = draw(st.sampled_from(list(bodies)))
    body = bodies[name]
    if body["kind"] == "link":
        at = draw(st.one_of(st.sampled_from(["base", "tip", "centroid"]), st.floats(0.0, 1.0)))
        return {"body": name, "at": at}
    elements = body["elements"]
    points = elements * (body["gauss_points"] + 1)
    ends = st.integers(0, elements).map(lambda end: end / elements)
    what = st.one_of(
        st.sampled_from([{"at": "base"}, {"at": "tip"}]),
        ends.map(lambda end: {"at": end}),
        st.integers(0, points).map(lambda point: {"point": point}),
    )
    return {"body": name, **draw(what)}


@st.composite
def documents(draw: Draw) -> dict[str, Any]:
    """Model files in which everything is allowed."""
    planar = draw(st.booleans())
    flat = "xz" if planar else "xyz"
    count = st.integers(1, 4)
    forms = draw(st.lists(NAMES, min_size=4, max_size=4))
    names = (f"{forms[i % 4]}{joining}{i}" for i, joining in enumerate(40 * ["", "-", "_"]))
    bodies: dict[str, Any] = {}
    for _ in range(draw(count)):
        body = rod(draw, planar) if draw(st.booleans()) else link(draw)
        placement = maybe({}, draw, **dict.fromkeys(flat, OFFSET))
        maybe(placement, draw, rotation=vectors(ANGLE, "y" if planar else "xyz"))
        if body["kind"] == "rod":
            maybe(placement, draw, reference=st.sampled_from(["axis", "underside"]))
        maybe(body, draw, placement=st.just(placement))
        if bodies:
            maybe(body, draw, parent=st.sampled_from(list(bodies)))
        if draw(st.booleans()):
            body["joint"] = joint(draw, planar)
        bodies[next(names)] = body
    if not any("joint" in b and b["joint"]["kind"] != "fixed" for b in bodies.values()):
        bodies[next(names)] = {**link(draw), "joint": {"kind": "revolute"}}  # something must move
    document: dict[str, Any] = {"name": draw(NAMES), "planar": planar, "bodies": bodies}
    maybe(document, draw, title=st.text(max_size=20))
    gravity = quantities("m/s^2", "cm/s^2", numbers=NUMBERS)
    maybe(document, draw, gravity=vectors(gravity, flat))
    rods = [name for name, body in bodies.items() if body["kind"] == "rod"]

    spheres: dict[str, Any] = {}
    for _ in range(draw(st.integers(0, 2))):
        group = {"points": [place(draw, bodies) for _ in range(draw(count))]}
        covered = st.lists(st.sampled_from(list(bodies)), min_size=1, unique=True)
        spheres[next(names)] = maybe(group, draw, bodies=covered)
    groups = st.sampled_from(list(spheres)) if spheres else st.nothing()
    contacts = {
        next(names): {"first": draw(groups), "second": draw(groups), "stiffness": draw(STIFFNESS)}
        for _ in range(draw(st.integers(0, 2)) if spheres else 0)
    }
    solid = draw(st.booleans())
    for contact in contacts.values():
        if solid:
            contact["shape"] = "round-cones"
        maybe(contact, draw, skip=st.integers(0, 9), tip_spheres=st.integers(0, 1))

    actuators: dict[str, Any] = {}
    for _ in range(draw(st.integers(0, 2)) if rods else 0):
        sampled = st.one_of(OFFSET, st.lists(OFFSET, min_size=1, max_size=3))
        paths = vectors(sampled, "z" if planar else "yz")
        if not planar:
            helix = {"radius": LENGTH, "turn": ANGLE}
            paths = st.one_of(paths, st.fixed_dictionaries(helix, optional={"start": ANGLE}))
        lever = st.one_of(NUMBERS, vectors(NUMBERS, "z" if planar else "yz"))
        actuator = {
            "kind": draw(st.sampled_from(["chamber", "cable"])),
            "rod": draw(st.sampled_from(rods)),
        }
        actuators[next(names)] = maybe(actuator, draw, path=paths, lever=lever)

    def attached() -> dict[str, Any]:
        return maybe(place(draw, bodies), draw, offset=vectors(OFFSET, flat))

    springs: dict[str, Any] = {}
    for _ in range(draw(st.integers(0, 2))):
        second = {"world": draw(vectors(OFFSET, flat))} if draw(st.booleans()) else attached()
        spring = {"first": attached(), "second": second, "stiffness": draw(STIFFNESS)}
        springs[next(names)] = maybe(spring, draw, rest_length=LENGTH, slack=st.booleans())
    wrenches: dict[str, Any] = {}
    for _ in range(draw(st.integers(0, 2))):
        wrench = attached()
        maybe(wrench, draw, force=vectors(FORCE, flat))
        maybe(wrench, draw, moment=vectors(MOMENT, "y" if planar else "xyz"))
        maybe(wrench, draw, frame=st.sampled_from(["world", "body"]), input=st.booleans())
        wrenches[next(names)] = wrench
    tables = {
        "spheres": spheres,
        "contacts": contacts,
        "actuators": actuators,
        "springs": springs,
        "wrenches": wrenches,
    }
    document.update({name: table for name, table in tables.items() if table})
    if rods:
        designed = {
            "rod": draw(st.sampled_from(rods)),
            "length_bounds": [
                "1 cm",
                draw(quantities("m").map(lambda text: f"2{text.lstrip('+')}")),
            ],
            "radius_bounds": ["4 mm", "1 m"],
            "minimum_radius": "3 mm",
        }
        maybe(document, draw, design=st.just(designed))
    judged = st.integers(1, 40).map(lambda steps: {"force": f"{steps} N", "step": "1000 mN"})
    maybe(document, draw, evaluation=judged)
    softest = draw(st.sampled_from(list(bodies)))
    sets = {
        name: {"bodies": {softest: {"length": draw(LENGTH), "density": draw(DENSITY)}}}
        for name in ("soft", "stiff")
    }
    if draw(st.booleans()):
        document.update(constants=sets, use=draw(st.sampled_from(["soft", "stiff"])))
    return document


@settings(
    deadline=None,
    max_examples=15,
    phases=[Phase.explicit, Phase.reuse, Phase.generate],  # shrinking such tables takes minutes
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)
@given(documents())
def test_any_valid_model_comes_back_from_its_file(document: dict[str, Any]) -> None:
    file = check(document)
    written = file.to_toml()
    again = parse(written)
    assert again == file
    assert again.to_toml() == written
    one, other = Model(file), Model(again)
    assert one.hash == other.hash
    assert one.dof == len(one.engine.coordinates)
    for name in file.constants:
        assert parse(written, use=name) == check(document, use=name)

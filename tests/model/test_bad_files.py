"""Invalid model files: one sentence that names the field, what was found and what is expected."""

from __future__ import annotations

import pytest

from flexor.errors import InputError
from flexor.model import parse

GOOD = """
name = "good"
planar = true

[bodies.suit]
kind = "rod"
length = "10 cm"
radius = { base = "1.2 cm", tip = "8 mm" }
young_modulus = "1 MPa"
poisson_ratio = 0.5
strain = { bend_y = "nodal_linear", extend_x = "nodal_linear" }
elements = 4
gauss_points = 2

[bodies.bone]
kind = "link"
length = "4 cm"
radius = "1 cm"
joint = { kind = "revolute", stiffness = "0.04 N*m/rad", lower = "-5 deg", upper = "90 deg" }

[bodies.nail]
kind = "link"
parent = "bone"
length = "2 cm"
radius = "8 mm"

[spheres.suit]
bodies = ["suit"]

[spheres.finger]
bodies = ["bone", "nail"]

[contacts.skin]
first = "suit"
second = "finger"
stiffness = "100 N/m"

[actuators.chamber]
kind = "chamber"
rod = "suit"
lever = 1.0

[springs.strap]
first = { body = "nail", at = "tip" }
second = { world = { x = "10 cm" } }
stiffness = "10 N/m"

[wrenches.push]
body = "nail"
at = 0.5
force = { z = "-1 N" }

[design]
rod = "suit"
length_bounds = ["6 cm", "14 cm"]
radius_bounds = ["4 mm", "12 mm"]
minimum_radius = "5 mm"

[evaluation]
force = "5 N"
"""

LENGTH = 'write a length with its unit, such as "10 cm"'
BODIES = 'expected one of "suit", "bone", "nail"'


def message(text: str) -> str:
    with pytest.raises(InputError) as caught:
        parse(text, source="good.toml")
    return str(caught.value)


def replaced(old: str, new: str) -> str:
    assert GOOD.count(old) == 1, f"{old!r} must occur exactly once in the valid file"
    return GOOD.replace(old, new)


def test_the_unmodified_file_is_valid() -> None:
    assert parse(GOOD).bodies["suit"].length == 0.1


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        # unknown keys
        (
            'name = "good"',
            'name = "good"\ngravitiy = { z = "-9.81 m/s^2" }',
            'it has an unknown key "gravitiy" (did you mean "gravity"?): expected one of "name", '
            '"title", "planar", "gravity", "bodies", "materials", "spheres", "contacts", '
            '"obstacles", "actuators", '
            '"torques", "couplings", "springs", "straps", "tendons", "wraps", "wrenches", "ties", '
            '"inputs", "design", "population", '
            '"evaluation", "start", "solver", "constants", "variants", "use", "parts".',
        ),
        (
            'length = "4 cm"',
            'lenght = "4 cm"',
            'bodies.bone has an unknown key "lenght" (did you mean "length"?): expected one of '
            '"kind", "parent", "placement", "joint", "length", "radius", "skin", "density".',
        ),
        (
            "{ bend_y",
            "{ bend_x",
            'bodies.suit.strain has an unknown key "bend_x" (did you mean "bend_z"?): '
            'expected one of "twist_x", "bend_y", "bend_z", "extend_x", "shear_y", "shear_z".',
        ),
        (
            'first = "suit"',
            'first = "suit"\ndamping = 0.3',
            'contacts.skin has an unknown key "damping": expected one of "first", "second", '
            '"shape", "stiffness", "stiffness_per_length", "skip", "tip_spheres", "friction", '
            '"stiffness_ratio".',
        ),
        (
            'first = "suit"',
            'first = "suit"\nfriction = -0.3',
            "contacts.skin.friction is -0.3: it must be at least 0.0.",
        ),
        # missing keys and tables
        ('length = "4 cm"\n', "", f"bodies.bone.length is missing: {LENGTH}."),
        ('name = "good"', "", "name is missing."),
        (
            'kind = "chamber"\n',
            "",
            'actuators.chamber.kind is missing: expected one of "chamber", "cable", "pressure".',
        ),
        (
            'stiffness = "100 N/m"',
            "",
            "contacts.skin.stiffness is missing: write a stiffness with its unit, such as "
            '"100 N/m".',
        ),
        # units
        (
            'length = "10 cm"',
            'length = "30 kg"',
            f'bodies.suit.length is "30 kg", which is not a length: {LENGTH}.',
        ),
        (
            'length = "10 cm"',
            "length = 10",
            f"bodies.suit.length is 10, a number without a unit: {LENGTH}.",
        ),
        (
            'young_modulus = "1 MPa"',
            'young_modulus = "1 Mpa"',
            'bodies.suit.young_modulus is "1 Mpa" with the unknown unit "Mpa" (did you mean '
            '"MPa"?): write an elastic modulus with its unit, such as "30 kPa".',
        ),
        (
            'stiffness = "0.04 N*m/rad"',
            'stiffness = "0.04 N/m"',
            'bodies.bone.joint.stiffness is "0.04 N/m", which is not a joint stiffness: write a '
            'joint stiffness with its unit, such as "0.04 N*m/rad".',
        ),
        (
            'radius = "1 cm"',
            "radius = 0.01",
            'bodies.bone.radius is 0.01: write "1 cm" or { base = "1.2 cm", tip = "0.8 cm" }.',
        ),
        # negative, zero, not finite
        (
            'length = "10 cm"',
            'length = "-10 cm"',
            'bodies.suit.length is "-10 cm": it must be greater than zero.',
        ),
        (
            'base = "1.2 cm"',
            'base = "0 cm"',
            'bodies.suit.radius.base is "0 cm": it must be greater than zero.',
        ),
        (
            'tip = "8 mm"',
            'tip = "-8 mm"',
            'bodies.suit.radius.tip is "-8 mm": it must be greater than zero.',
        ),
        (
            'radius = { base = "1.2 cm", tip = "8 mm" }',
            'radius = ["1 cm", "0 cm", "1 cm"]',
            'bodies.suit.radius[1] is "0 cm": it must be greater than zero.',
        ),
        (
            'radius = { base = "1.2 cm", tip = "8 mm" }',
            'radius = ["1 cm"]',
            "bodies.suit.radius has too few entries (1): expected at least 2.",
        ),
        (
            'young_modulus = "1 MPa"',
            'young_modulus = "0 MPa"',
            'bodies.suit.young_modulus is "0 MPa": it must be greater than zero.',
        ),
        (
            'stiffness = "100 N/m"',
            'stiffness = "-100 N/m"',
            'contacts.skin.stiffness is "-100 N/m": it must be greater than zero.',
        ),
        (
            'stiffness = "0.04 N*m/rad"',
            'stiffness = "-0.04 N*m/rad"',
            'bodies.bone.joint.stiffness is "-0.04 N*m/rad": it must not be negative.',
        ),
        (
            'length = "10 cm"',
            'length = "nan cm"',
            'bodies.suit.length is "nan cm": it must be a finite number.',
        ),
        (
            "lever = 1.0",
            "lever = nan",
            "actuators.chamber.lever is nan: it must be a finite number.",
        ),
        (
            "poisson_ratio = 0.5",
            "poisson_ratio = nan",
            "bodies.suit.poisson_ratio is nan: it must be a finite number.",
        ),
        (
            "poisson_ratio = 0.5",
            "poisson_ratio = 0.6",
            "bodies.suit.poisson_ratio is 0.6: it must be at most 0.5.",
        ),
        # discretisation
        (
            "gauss_points = 2",
            "gauss_points = 1",
            'bodies.suit.gauss_points is 1: the basis "nodal_linear" of bend_y needs at least 2 '
            "per element.",
        ),
        (
            'bend_y = "nodal_linear"',
            'bend_y = "hermite"',
            'bodies.suit.gauss_points is 2: the basis "hermite" of bend_y needs at least 4 per '
            "element.",
        ),
        (
            'bend_y = "nodal_linear"',
            'bend_y = { basis = "legendre", order = 8 }',
            'bodies.suit.gauss_points is 2: with 4 elements, the basis "legendre" of order 8 of '
            "bend_y needs at least 3 per element.",
        ),
        (
            'bend_y = "nodal_linear"',
            'bend_y = "legendre"',
            'bodies.suit.strain.bend_y is "legendre": give its degree, as in '
            '{ basis = "legendre", order = 3 }.',
        ),
        (
            'bend_y = "nodal_linear"',
            'bend_y = "nodal_lineer"',
            'bodies.suit.strain.bend_y has an unknown basis "nodal_lineer" (did you mean '
            '"nodal_linear"?): expected one of "nodal_linear", "nodal_quadratic", "nodal_cubic", '
            '"hermite", "monomial", "legendre", "chebyshev".',
        ),
        (
            'strain = { bend_y = "nodal_linear", extend_x = "nodal_linear" }',
            "strain = {}",
            "bodies.suit.strain has no mode: a rod needs at least one of twist_x, bend_y, bend_z, "
            "extend_x, shear_y, shear_z.",
        ),
        (
            "elements = 4",
            "elements = 0",
            "bodies.suit.elements is 0: it must be at least 1.",
        ),
        (
            "elements = 4",
            "elements = 100000000",
            "bodies.suit.elements is 100000000: it must be at most 1000.",
        ),
        (
            "elements = 4",
            "elements = 4.5",
            "bodies.suit.elements is 4.5: expected an integer.",
        ),
        # the kinematic tree
        (
            'parent = "bone"',
            'parent = "bome"',
            'bodies.nail.parent refers to the unknown body "bome" (did you mean "bone"?): '
            f"{BODIES}.",
        ),
        (
            'parent = "bone"',
            'parent = "nail"',
            'bodies.nail.parent is "nail": a body cannot be its own ancestor (nail -> nail).',
        ),
        (
            'length = "4 cm"',
            'length = "4 cm"\nparent = "nail"',
            'bodies.bone.parent is "nail": a body cannot be its own ancestor '
            "(bone -> nail -> bone).",
        ),
        (
            'kind = "rod"',
            'kind = "rodd"',
            'bodies.suit has an unknown kind "rodd" (did you mean "rod"?): expected one of "rod", '
            '"link".',
        ),
        (
            'kind = "revolute"',
            'kind = "hinge"',
            'bodies.bone.joint has an unknown kind "hinge": expected one of "fixed", "revolute", '
            '"prismatic", "universal", "spherical", "free".',
        ),
        (
            'lower = "-5 deg"',
            'lower = "95 deg"',
            'bodies.bone.joint.lower is "95 deg": it must be below the upper limit, "90 deg".',
        ),
        (
            'stiffness = "0.04 N*m/rad"',
            "axis = [0, 0, 0]",
            "bodies.bone.joint.axis is zero: it must not be.",
        ),
        (
            "[bodies.nail]",
            '[bodies."na il"]',
            'bodies contains "na il": names start with a letter and consist of letters, digits, _ '
            "and -.",
        ),
        (
            "[springs.strap]",
            "[springs.suit]",
            "springs.suit has the same name as bodies.suit.",
        ),
        # references to bodies
        (
            'bodies = ["bone", "nail"]',
            "bodies = []",
            "spheres.finger is empty: give bodies or points.",
        ),
        (
            'bodies = ["bone", "nail"]',
            'bodies = ["bone", "nale"]',
            'spheres.finger.bodies refers to the unknown body "nale" (did you mean "nail"?): '
            f"{BODIES}.",
        ),
        (
            'bodies = ["bone", "nail"]',
            'bodies = ["bone", "bone"]',
            'spheres.finger.bodies contains "bone" twice.',
        ),
        (
            'second = "finger"',
            'second = "fingr"',
            'contacts.skin.second refers to the unknown sphere group "fingr" (did you mean '
            '"finger"?): '
            'expected one of "suit", "finger".',
        ),
        (
            'second = "finger"',
            'second = "finger"\nshape = "cones"',
            'contacts.skin.shape is "cones" (did you mean "round-cones"?): expected one of '
            '"spheres", '
            '"round-cones".',
        ),
        (
            'stiffness = "100 N/m"',
            'stiffness_per_length = "1 kPa"',
            'contacts.skin.stiffness_per_length requires shape = "round-cones".',
        ),
        (
            'stiffness = "100 N/m"',
            'stiffness = "100 N/m"\nshape = "round-cones"\nstiffness_per_length = "1 kPa"',
            "contacts.skin has both stiffness and stiffness_per_length: give one.",
        ),
        (
            'stiffness = "100 N/m"',
            'shape = "round-cones"\nstiffness_per_length = "1 N/m"',
            'contacts.skin.stiffness_per_length is "1 N/m", which is not a stiffness per length: '
            'write a stiffness per length with its unit, such as "20 N/cm^2".',
        ),
        (
            'stiffness = "100 N/m"',
            'stiffness = "100 N/m"\nshape = "round-cones"\n[contacts.other]\nfirst = "finger"\n'
            'second = "suit"\nstiffness = "1 N/m"',
            'contacts.skin.second is "finger", whose spheres are used by other: define another '
            "group for round cones.",
        ),
        (
            'first = "suit"\nsecond = "finger"\nstiffness = "100 N/m"',
            'first = "finger"\nsecond = "suit"\nshape = "round-cones"\n'
            'stiffness_per_length = "1 kPa"',
            'spheres.finger.bodies is "bone", which is a link: expected a rod, "suit".',
        ),
        (
            'bodies = ["suit"]\n\n[spheres.finger]\nbodies = ["bone", "nail"]\n\n[contacts.skin]\n'
            'first = "suit"\nsecond = "finger"\nstiffness = "100 N/m"',
            'bodies = ["suit"]\npoints = [{ body = "suit", at = "tip" }]\n\n[spheres.finger]\n'
            'bodies = ["bone", "nail"]\n\n[contacts.skin]\nfirst = "suit"\nsecond = "finger"\n'
            'shape = "round-cones"\nstiffness_per_length = "1 kPa"',
            "spheres.suit has points, but skin has a stiffness per length: use rods only.",
        ),
        (
            'rod = "suit"\nlever',
            'rod = "bone"\nlever',
            'actuators.chamber.rod is "bone", which is a link: expected a rod, "suit".',
        ),
        (
            'kind = "chamber"',
            'kind = "tendon"',
            'actuators.chamber.kind is "tendon": expected one of "chamber", "cable", "pressure".',
        ),
        (
            'body = "nail"\nat = 0.5',
            'body = "nail"\nat = 1.5',
            'wrenches.push.at is 1.5: expected "base", "tip", "centroid" or a fraction from '
            "0 to 1.",
        ),
        (
            'body = "nail"\nat = 0.5',
            'body = "nail"\npoint = 3',
            'wrenches.push.point is 3: only rods have points, and "nail" is a link.',
        ),
        (
            'body = "nail"\nat = 0.5',
            'body = "suit"\npoint = 13',
            'wrenches.push.point is 13: the points of "suit" are 0 to 12.',
        ),
        (
            'body = "nail"\nat = 0.5',
            'body = "suit"\nat = 0.3',
            'wrenches.push.at is 0.3: on the rod "suit" it must be a multiple of 1/4 (an element '
            "boundary).",
        ),
        (
            'body = "nail"\nat = 0.5',
            'body = "suit"\nat = "centroid"',
            'wrenches.push.at is "centroid": only links support it, and "suit" is a rod.',
        ),
        (
            'body = "nail"\nat = 0.5',
            'body = "nail"',
            'wrenches.push needs either at (such as "tip") or point (of a rod).',
        ),
        (
            'length_bounds = ["6 cm", "14 cm"]',
            'length_bounds = ["14 cm", "6 cm"]',
            'design.length_bounds is ["14 cm", "6 cm"]: the lower bound must be below the upper '
            "one.",
        ),
        (
            'length_bounds = ["6 cm", "14 cm"]',
            'length_bounds = "6 cm"',
            'design.length_bounds is "6 cm": write two lengths, such as ["6 cm", "14 cm"].',
        ),
        # planar models
        (
            'bend_y = "nodal_linear"',
            'bend_z = "nodal_linear"',
            "bodies.suit.strain.bend_z is not planar: expected one of bend_y, extend_x, shear_z.",
        ),
        (
            'kind = "revolute", stiffness',
            'kind = "revolute", axis = "z", stiffness',
            'bodies.bone.joint.axis is "z": in a planar model it must be y.',
        ),
        (
            'stiffness = "0.04 N*m/rad", lower = "-5 deg", upper = "90 deg"',
            'axis = "y"',
            'bodies.bone.joint.axis is "y": in a planar model it must lie in the x-z plane.',
        ),
        (
            'kind = "revolute", stiffness = "0.04 N*m/rad", lower = "-5 deg", upper = "90 deg"',
            'kind = "spherical"',
            'bodies.bone.joint.kind is "spherical": planar models support fixed, revolute, '
            "prismatic and free joints.",
        ),
        (
            'length = "4 cm"',
            'length = "4 cm"\nplacement = { y = "1 cm" }',
            'bodies.bone.placement.y is "1 cm": it must be zero in a planar (x-z) model.',
        ),
        (
            "lever = 1.0",
            "lever = { y = 0.5 }",
            "actuators.chamber.lever.y is 0.5: it must be zero in a planar (x-z) model.",
        ),
        (
            "lever = 1.0",
            'path = { radius = "4 mm", turn = "2 rad" }',
            "actuators.chamber.path is a helix, which is not planar.",
        ),
        # values of the wrong type
        ('name = "good"', "name = 3", "name is 3: expected a string in quotes."),
        ("planar = true", 'planar = "yes"', 'planar is "yes": expected true or false.'),
        (
            'length = "4 cm"',
            'length = "4 cm"\nplacement = { z = "1 cm", reference = "underside" }',
            'bodies.bone.placement.reference is "underside": only rods support it.',
        ),
    ],
)
def test_one_sentence(old: str, new: str, sentence: str) -> None:
    if new == 'axis = "y"':
        text = replaced(old, new).replace('"revolute"', '"prismatic"')
    else:
        text = replaced(old, new)
    assert message(text) == f"good.toml: {sentence}"


def test_no_bodies() -> None:
    assert (
        message('name = "x"\n[bodies]')
        == "good.toml: bodies has too few entries (0): expected at least 1."
    )
    assert message('name = "x"') == "good.toml: bodies is missing."


def test_duplicate_tables_are_not_toml() -> None:
    line = 1 + len(GOOD.splitlines())
    text = message(GOOD + "[bodies.suit]\n")
    assert text.startswith(f"good.toml: not valid TOML at line {line}, column ")
    assert text.endswith("annot declare ('bodies', 'suit') twice.")


def test_broken_toml_names_line_and_column() -> None:
    text = message('name = "x"\nplanar = yes\n')
    assert text == "good.toml: not valid TOML at line 2, column 10: invalid value."

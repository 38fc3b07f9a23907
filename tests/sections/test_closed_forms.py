"""Rods with sections of fibres and pressure against closed forms."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad

from flexor.model import Model, parse

MU = 0.314e6

TUBE = """
name = "tube"
planar = true

[materials.silicone]
kind = "neo-hookean"
shear_modulus = "0.314 MPa"
winding = "hoop"

[bodies.tube]
kind = "rod"
length = "10 cm"
radius = "10 mm"
material = "silicone"
section = { kind = "tube", wall = "2 mm", winding = "outside" }
strain = { bend_y = "nodal_linear", extend_x = "nodal_linear" }
elements = 2
gauss_points = 2

[actuators.air]
kind = "pressure"
rod = "tube"
"""


def tube_pressure(stretch: float, winding: float, inner: float, outer: float) -> float:
    """Pressure [Pa] of a wound tube: −dW/dλ by the section that the winding keeps."""

    def stress(r: float) -> float:
        h = 1e-5
        return (energy(stretch + h, r) - energy(stretch - h, r)) / (2 * h) * 2 * np.pi * r

    def energy(x: float, r: float) -> float:
        hoop = (winding**2 - (winding**2 - r**2) / x) / r**2
        return 0.5 * MU * (x**2 + hoop + 1 / (x**2 * hoop) - 3)

    force, _ = quad(stress, inner, outer)
    return float(force / (np.pi * winding**2))


@pytest.mark.parametrize(
    ("winding", "radius", "pressure"), [("outside", 0.010, 76.26e3), ("inside", 0.008, 103.00e3)]
)
def test_a_wound_tube_stretches(winding: str, radius: float, pressure: float) -> None:
    assert tube_pressure(1.2, radius, 0.008, 0.010) == pytest.approx(pressure, rel=1e-4)
    model = Model(parse(TUBE.replace('"outside"', f'"{winding}"')))
    path = model.equilibrium([0.0, tube_pressure(1.2, radius, 0.008, 0.010)])
    assert path.stable.all()
    np.testing.assert_allclose(path.q[1], [0, 0, 0, 0.2, 0.2, 0.2], atol=2e-5)
    volume = np.pi * (radius**2 * 1.2 - (radius**2 - 0.008**2)) * 0.1
    np.testing.assert_allclose(path.volume[:, 0], [np.pi * 0.008**2 * 0.1, volume], rtol=1e-4)
    assert path.max_strain[1] == pytest.approx(0.2, abs=2e-5)


HALF_ROUND = """
name = "half-round"
planar = true

[materials.silicone]
kind = "neo-hookean"
shear_modulus = "0.314 MPa"
winding = "hoop"

[bodies.bender]
kind = "rod"
length = "160 mm"
radius = "6 mm"
strain = { bend_y = "nodal_linear" }
elements = 2
gauss_points = 2

[bodies.bender.section]
kind = "composite"
parts = [
    { shape = "half-ring", z = "2 mm", radius = "10 mm", wall = "2 mm", material = "silicone" },
    { shape = "rectangle", z = "1 mm", width = "20 mm", height = "2 mm", material = "silicone" },
    { shape = "half-disc", z = "2 mm", radius = "8 mm", cavity = "bore" },
]

[actuators.air]
kind = "pressure"
rod = "bender"
"""


def test_the_thin_wall_limit() -> None:
    """A bender about its inextensible lower side, hoop stretch 1 throughout."""
    kpa = [41.514, 78.197, 140.691, 192.815, 237.829]
    path = Model(parse(HALF_ROUND)).equilibrium([0.0, *(1e3 * p for p in kpa)])
    assert path.stable.all()
    np.testing.assert_allclose(
        np.degrees(path.q[1:, 0]), [45.0, 90.0, 180.0, 270.0, 360.0], rtol=1e-3
    )
    np.testing.assert_allclose(path.q, path.q[:, :1] * np.ones(3), atol=1e-9)


def composite(parts: str, load: str) -> Model:
    return Model(
        parse(f"""
name = "beam"
planar = true

[materials.soft]
kind = "linear"
young_modulus = "0.2 MPa"

[materials.stiff]
kind = "linear"
young_modulus = "3 MPa"

[bodies.beam]
kind = "rod"
length = "20 cm"
radius = "5 mm"
strain = {{ bend_y = "nodal_linear", extend_x = "nodal_linear" }}
elements = 3
gauss_points = 2
section = {{ kind = "composite", parts = [{parts}] }}

{load}
""")
    )


def test_a_bimetal_bends_as_timoshenko_has_it() -> None:
    strain = 1e-6
    model = composite(
        'rows, { shape = "rectangle", z = "-1.5 mm", width = "9 mm", height = "1 mm", '
        f'material = "stiff", stretch = {1.0 + strain!r} }}'.replace(
            "rows",
            '{ shape = "rectangle", z = "1 mm", width = "9 mm", height = "4 mm", '
            'material = "soft" }',
        ),
        "",
    )
    path = model.equilibrium()
    m, n, h = 1.0 / 4.0, 3.0 / 0.2, 0.005
    shape = 3 * (1 + m) ** 2 + (1 + m * n) * (m**2 + 1 / (m * n))
    curvature = 6 * strain * (1 + m) ** 2 / (h * shape)
    # The lower layer contracts: it bends the beam down, in the sense of positive rotation about y.
    np.testing.assert_allclose(path.q[0, :4], curvature * 0.2, rtol=1e-5)


def test_an_eccentric_composite_under_a_moment() -> None:
    moment = 2e-3
    parts = """
{ shape = "rectangle", z = "3 mm", width = "9 mm", height = "2 mm", material = "stiff" },
{ shape = "rectangle", z = "0.5 mm", width = "6 mm", height = "3 mm", material = "soft" }"""
    load = f"""
[wrenches.turn]
body = "beam"
at = "tip"
moment = {{ y = "{moment} N*m" }}
"""
    path = composite(parts, load).equilibrium()
    areas = [(3e6, 3e-3, 9e-3, 2e-3), (2e5, 0.5e-3, 6e-3, 3e-3)]
    matrix = np.zeros((2, 2))
    for modulus, z, width, height in areas:
        area = width * height
        first, second = area * z, width * height**3 / 12 + area * z**2
        matrix += modulus * np.array([[area, first], [first, second]])
    strain, curvature = np.linalg.solve(matrix, [0.0, moment])
    np.testing.assert_allclose(path.q[0, :4], curvature * 0.2, rtol=1e-9)
    np.testing.assert_allclose(path.q[0, 4:], strain, rtol=1e-9)


def test_given_stiffness_is_that_of_the_parts() -> None:
    moment = 2e-3
    load = f"""
[wrenches.turn]
body = "beam"
at = "tip"
moment = {{ y = "{moment} N*m" }}
"""
    part = (
        '{ shape = "rectangle", z = "3 mm", width = "9 mm", height = "2 mm", material = "stiff" }'
    )
    wanted = composite(part, load).equilibrium()
    area = 18e-6
    second = 9e-3 * (2e-3) ** 3 / 12 + area * 9e-6
    text = (
        f'{{ kind = "stiffness", EA = "{3e6 * area!r} N", ES_y = "{3e6 * area * 3e-3!r} N*m", '
        f'EI_yy = "{3e6 * second!r} N*m^2" }}'
    )
    given = composite(part, load).file.to_toml()
    document = parse(given).to_document()
    import tomllib

    document["bodies"]["beam"]["section"] = tomllib.loads(f"section = {text}")["section"]
    import tomli_w

    path = Model(parse(tomli_w.dumps(document))).equilibrium()
    np.testing.assert_allclose(path.q, wanted.q, rtol=1e-9)


SNAKE: dict[str, Any] = {
    "name": "snake",
    "materials": {"rubber": {"kind": "neo-hookean", "shear_modulus": "0.1 MPa"}},
    "bodies": {
        "snake": {
            "kind": "rod",
            "length": "20 cm",
            "radius": {"base": "12 mm", "tip": "8 mm"},
            "material": "rubber",
            "section": {
                "kind": "composite",
                "torsion_stiffness": "1e-3 N*m^2",
                "parts": [
                    {"shape": "rectangle", "z": -0.6, "width": 2.0, "height": 0.4},
                    {"shape": "disc", "y": 0.3, "z": "4 mm", "radius": 0.35, "cavity": "bore"},
                    {"shape": "rectangle", "z": 1.2, "width": 3.0, "height": 0.2},
                ],
            },
            "strain": {
                "twist_x": {"basis": "legendre", "order": 1},
                "bend_y": {"basis": "legendre", "order": 1},
                "bend_z": {"basis": "legendre", "order": 1},
                "extend_x": {"basis": "legendre", "order": 1},
            },
            "elements": 80,
            "gauss_points": 2,
        }
    },
    "actuators": {"air": {"kind": "pressure", "rod": "snake", "span": [0.1, 0.85]}},
}


def test_volume_is_that_of_the_swept_solid() -> None:
    """The volume inside a fine mesh of the cavity's surface in space."""
    import tomli_w

    model = Model(parse(tomli_w.dumps(SNAKE)))
    q = np.array([0.9, -0.4, 2.0, 0.5, -1.1, 0.3, 0.12, -0.05])
    frames = model.engine.frames(model.parameters, q)
    start, stop = model.body_frames["snake"]
    x = np.array(model.file.rod("snake").sample_points)
    inside = (x > 0.1 - 1e-9) & (x < 0.85 + 1e-9)
    assert inside[np.isclose(x, 0.1)].any() and inside[np.isclose(x, 0.85)].any()
    angle = np.linspace(0.0, 2.0 * np.pi, 720, endpoint=False)
    rings = []
    for frame, at in zip(frames[start:stop][inside], x[inside], strict=True):
        s = 0.012 - 0.004 * at
        y, z = 0.3 * s + 0.35 * s * np.cos(angle), 0.004 + 0.35 * s * np.sin(angle)
        local = np.stack([np.zeros_like(y), y, z], axis=1)
        rings.append(local @ frame[:3, :3].T + frame[:3, 3])
    ring = np.array(rings)
    a, b = ring[:-1], ring[1:]
    c, d = np.roll(a, -1, axis=1), np.roll(b, -1, axis=1)

    def volume(p: Any, q: Any, r: Any) -> float:
        return float(np.einsum("...i,...i->...", p, np.cross(q, r)).sum() / 6.0)

    total = volume(a, c, d) + volume(a, d, b)
    for end, sign in ((ring[0], -1.0), (ring[-1], 1.0)):
        centre = np.broadcast_to(end.mean(axis=0), end.shape)
        total += sign * volume(centre, end, np.roll(end, -1, axis=0))
    (found,) = model.engine.volumes(model.parameters, q)
    assert found == pytest.approx(abs(total), rel=1e-4)

"""Thick wound walls against closed forms, and as variables of a design."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import tomli_w
from scipy.integrate import quad
from scipy.optimize import brentq

from flexor.design import variables
from flexor.model import Model, parse
from flexor.sections import points_across

RADIUS = 0.010
LAWS: dict[str, tuple[dict[str, Any], Any]] = {
    "neo-hookean": (
        {"shear_modulus": "100 kPa"},
        lambda a, b, c: 0.5e5 * (a**2 + b**2 + c**2 - 3.0),
    ),
    "mooney-rivlin": (
        {"c10": "30 kPa", "c01": "20 kPa"},
        lambda a, b, c: 3e4 * (a**2 + b**2 + c**2 - 3.0) + 2e4 * (a**-2 + b**-2 + c**-2 - 3.0),
    ),
    "ogden": (
        {"mu": ["100 kPa", "-20 kPa"], "alpha": [3.0, -2.0]},
        lambda a, b, c: (
            1e5 / 3.0 * (a**3 + b**3 + c**3 - 3.0) + 1e4 * (a**-2 + b**-2 + c**-2 - 3.0)
        ),
    ),
}


def tube(
    wall: Any, winding: str = "outside", law: str = "neo-hookean", radius: Any = "1 cm"
) -> Model:
    document = {
        "name": "tube",
        "planar": True,
        "materials": {"rubber": {"kind": law, **LAWS[law][0], "winding": "hoop"}},
        "bodies": {
            "tube": {
                "kind": "rod",
                "length": "10 cm",
                "radius": radius,
                "material": "rubber",
                "section": {"kind": "tube", "wall": wall, "winding": winding},
                "strain": {"bend_y": "nodal_linear", "extend_x": "nodal_linear"},
                "elements": 2,
                "gauss_points": 2,
            }
        },
        "actuators": {"air": {"kind": "pressure", "rod": "tube"}},
    }
    return Model(parse(tomli_w.dumps(document)))


def stretch(wall: float, winding: str, law: str, pressure: float) -> float:
    """Stretch of a wound tube under pressure, where its energy is least."""
    inner, energy = RADIUS - wall, LAWS[law][1]
    kept = RADIUS if winding == "outside" else inner

    def whole(x: float) -> float:
        def at(r: float) -> float:
            hoop = np.sqrt(kept**2 - (kept**2 - r**2) / x) / r
            return float(energy(x, hoop, 1.0 / (x * hoop)) * 2.0 * np.pi * r)

        return float(quad(at, inner, RADIUS, epsabs=1e-14, epsrel=1e-12)[0])

    def slope(x: float) -> float:
        return (whole(x + 1e-5) - whole(x - 1e-5)) / 2e-5

    return float(brentq(lambda x: slope(x) - pressure * np.pi * kept**2, 1.0 + 1e-7, 10.0))


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("winding", ["outside", "inside"])
@pytest.mark.parametrize("wall", [2.0, 3.3, 3.5, 5.0, 7.0, 8.5, 9.3])
def test_elongation_is_right_to_a_thousandth(wall: float, winding: str, law: str) -> None:
    pressures = np.array([0.0, 20e3, 60e3])
    path = tube(f"{wall} mm", winding, law).equilibrium(pressures)
    assert path.stable.all()
    expected = [stretch(1e-3 * wall, winding, law, p) - 1.0 for p in pressures[1:]]
    np.testing.assert_allclose(path.q[1:, -1], expected, rtol=1e-3)


def test_ordinary_walls_have_two_points() -> None:
    assert [points_across(wall, True) for wall in (0.01, 0.33, 0.34, 0.7)] == [2, 2, 3, 5]
    assert [points_across(wall, False) for wall in (0.01, 0.45, 0.5)] == [2, 2, 3]


@pytest.mark.parametrize("wall", ["2 mm", "6 mm", {"spline": ["2 mm", "6 mm"]}])
def test_a_wall_may_be_varied_from_thin_to_thick(wall: Any) -> None:
    """Its designs have the points of the file, and exact derivatives."""
    model = tube(wall, radius={"base": "1 cm", "tip": "9 mm"})
    field = "tube.section.wall"
    names = [f"{field}.spline.{i}" for i in (0, 1)] if isinstance(wall, dict) else [field]
    chosen = variables(dict.fromkeys(names, ("1 mm", "7 mm")), model)
    step = 1e-6
    for thickness in (1.5e-3, 6.5e-3):
        middle = np.full(len(names), thickness)
        jacobian = chosen.slot_jacobian(middle[None], model)[0]
        for i in range(len(names)):
            moved = middle + step * np.array([[-1.0], [1.0]]) * (np.arange(len(names)) == i)
            found, valid = chosen.designs(moved, model)
            assert valid.all()
            slope = (found.values[1] - found.values[0]) / (2.0 * step)
            scale = np.abs(slope).max()
            np.testing.assert_allclose(jacobian[:, i], slope, rtol=1e-6, atol=1e-7 * scale)


def test_a_design_is_the_file_with_its_wall() -> None:
    """To the accuracy of the points of the file that is varied: three are enough for 5.5 mm."""
    model, pressure = tube("5 mm"), 40e3
    chosen = variables({"tube.section.wall": ("1 mm", "5.5 mm")}, model)
    for wall, thickness in (("1 mm", 1e-3), ("5.5 mm", 5.5e-3)):
        values, _ = chosen.designs(np.array([[thickness]]), model)
        design = model.equilibrium([0.0, pressure], values)
        own = tube(wall).equilibrium([0.0, pressure])
        np.testing.assert_allclose(design.q[1, -1], own.q[1, -1], rtol=1.5e-3)


def test_a_copy_with_the_text_of_another_file_has_a_map_of_its_own() -> None:
    """A copy keeps the points across its wall, of which the file with its text has more."""
    thick, rod = tube("5 mm"), tube("2 mm").file.rod("tube")
    rod = rod.model_copy(update={"section": thick.file.rod("tube").section})
    bodies = {**thick.file.bodies, "tube": rod}
    copy = Model(thick.file.model_copy(update={"bodies": bodies}))
    assert copy.file.to_toml() == thick.file.to_toml()
    assert copy.parameters.size < thick.parameters.size
    for model in (thick, copy):
        chosen = variables({"tube.section.wall": ("4.5 mm", "5.5 mm")}, model)
        values, _ = chosen.designs(chosen.start[None], model)
        own = model.parameters[values.indices]
        np.testing.assert_allclose(
            values.values[0], own, rtol=1e-12, atol=1e-12 * np.abs(own).max()
        )

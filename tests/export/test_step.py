"""STEP files hold the same solids, read back by Open CASCADE."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from flexor.export import BodyOptions, body, write_solid
from tests.export.rods import HALF, TUBE, air, device


@pytest.mark.parametrize(
    ("section", "pressures"),
    [(TUBE, {"air": air()}), (HALF, {}), (HALF, {"near": air(0.0, 0.4), "far": air(0.4, 0.8)})],
)
def test_a_body_has_the_same_volume(section: dict, pressures: dict, tmp_path: Path) -> None:
    pytest.importorskip("OCP", reason="the extra step is not installed")
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps
    from OCP.STEPControl import STEPControl_Reader
    from OCP.TopAbs import TopAbs_ShapeEnum

    made = body(device(section, actuators=pressures), BodyOptions(cap=4e-3, inlet=2e-3))
    write_solid(made.solid, tmp_path / "body.step")
    reader = STEPControl_Reader()
    reader.ReadFile(str(tmp_path / "body.step"))
    reader.TransferRoots()
    shape, found = reader.OneShape(), GProp_GProps()
    assert shape.ShapeType() == TopAbs_ShapeEnum.TopAbs_SOLID
    BRepGProp.VolumeProperties_s(shape, found)
    assert found.Mass() == pytest.approx(made.solid.volume(), rel=1e-6)


def test_without_the_extra_its_command_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, flexor_in, capsys
) -> None:
    monkeypatch.setitem(sys.modules, "OCP", None)
    assert flexor_in(tmp_path, "export", "half-round-actuator", "--body", "body.step") == 2
    assert "STEP files need the package OCP" in (said := capsys.readouterr().err)
    assert "flexor[step]" in said

"""Labelled arrays of paths, studies and landscapes, and their files."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

import flexor
from flexor.errors import InputError
from flexor.model import Model

xarray = pytest.importorskip("xarray")
pytest.importorskip("h5netcdf")
VARIED = {"exosuit.section.wall": ("1.5 mm", "3 mm"), "exosuit.radius.base": ("6 mm", "10 mm")}


@pytest.fixture(scope="module")
def model() -> Model:
    """Return the pneumatic finger."""
    return flexor.load("pneumatic-finger")


def saved(found: object, folder: Path) -> object:
    """Write a dataset and read it again."""
    found.to_netcdf(folder / "saved.nc", engine="h5netcdf")  # type: ignore[attr-defined]
    return xarray.load_dataset(folder / "saved.nc", engine="h5netcdf")


def test_a_path_comes_back_from_its_file(model: Model, tmp_path: Path) -> None:
    """With names of joints and units."""
    path = model.equilibrium([0.0, 30e3, 60e3])
    found = saved(path.to_xarray(), tmp_path)
    angle = found["joint_angles"].sel(joint=model.joints[1])  # type: ignore[index]
    np.testing.assert_array_equal(angle, path.joint_angles[:, 1])
    assert angle.dims == ("step",)
    assert angle.attrs["units"] == "rad"
    np.testing.assert_array_equal(found["loads"].sel(input="chamber"), path.loads[:, 0])  # type: ignore[index]
    np.testing.assert_array_equal(
        found["stretch"].sel(material="fabric", extreme="greatest"),  # type: ignore[index]
        path.stretch[:, 1, 1],
    )
    several = model.evaluate(model.own_design).to_xarray()
    assert several["joint_angles"].dims == ("design", "step", "joint")


def test_a_study_comes_back_from_its_file(model: Model, tmp_path: Path) -> None:
    """Parameters, objectives and constraints, ready for pandas."""
    aims = ["maximise range-of-motion", "minimise mass"]
    study = flexor.optimize(model, VARIED, aims, budget=12, method_options={"population": 4})
    found = saved(study.to_xarray(), tmp_path)
    mass = found["objective_values"].sel(objective="minimise mass")  # type: ignore[index]
    np.testing.assert_array_equal(mass, study.record.outcomes().objective_values[:, 1])
    overlap = found["constraint_values"].sel(constraint="strain-use <= 1")  # type: ignore[index]
    assert overlap.shape == (12,)
    frame = found[["value", *VARIED]].to_dataframe()  # type: ignore[index]
    np.testing.assert_array_equal(frame["exosuit.section.wall"], study.record.designs()[:, 0])
    assert found["exosuit.section.wall"].attrs["units"] == "m"  # type: ignore[index]


def test_a_landscape_has_its_axes(model: Model, tmp_path: Path) -> None:
    """And the parameters that are fixed."""
    land = flexor.landscape(
        model, VARIED, "maximise bending", grid=3, axes=["exosuit.section.wall"]
    )
    found = saved(land.to_xarray(), tmp_path)
    assert found["value"].dims == ("exosuit.section.wall",)  # type: ignore[index]
    np.testing.assert_array_equal(found["exosuit.section.wall"], land.axes[0])  # type: ignore[index]
    assert float(found["exosuit.radius.base"]) == 0.008  # type: ignore[index]


def test_the_missing_package_is_named(model: Model, monkeypatch: pytest.MonkeyPatch) -> None:
    """With the command that installs it."""
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(InputError, match=r"need the package xarray.*flexor\[xarray\]"):
        model.equilibrium([0.0]).to_xarray()

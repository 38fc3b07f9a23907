"""Reading a limb from a file."""

from __future__ import annotations

import os
import pathlib

from flexor.errors import InputError
from flexor.exchange.limb import Limb
from flexor.exchange.mjcf import read_mjcf
from flexor.exchange.urdf import read_urdf
from flexor.exchange.xml import read_xml


def read_limb(file: str | os.PathLike[str], *, skip_meshes: bool = False) -> Limb:
    """Read a limb from an MJCF or URDF file.

    Parameters
    ----------
    file
        The file; files that an MJCF includes are read, too.
    skip_meshes
        Whether meshes that would touch are left out; otherwise they are refused.

    Returns
    -------
    Limb
        Its ``left_out`` counts what was not carried over.

    Raises
    ------
    InputError
        If the file cannot be read, or has an element that is not known, named with its line.
    """
    path = pathlib.Path(file)
    root = read_xml(path)
    if root.tag in ("mujoco", "mujocoinclude"):
        limb = read_mjcf(path, root, skip_meshes)
    elif root.tag == "robot":
        limb = read_urdf(root, skip_meshes)
    elif root.tag == "OpenSimDocument":
        raise InputError(
            f"{path}: is a model of OpenSim, which is not read: convert it to MJCF with "
            "MyoConverter (github.com/MyoHub/myoconverter) and import that."
        )
    else:
        raise InputError(
            f"{path}: begins with <{root.tag}>, which is neither <mujoco> (MJCF) nor <robot> "
            "(URDF)."
        )
    if not limb.bodies:
        raise InputError(f"{path}: has no bodies.")
    return limb

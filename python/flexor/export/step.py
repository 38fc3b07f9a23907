"""Solids as STEP files, by Open CASCADE (the package OCP of the extra `step`)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from flexor.arrays import Array
from flexor.errors import InputError
from flexor.export.extra import STEP, required

ENDINGS = (".step", ".stp")
# Faces that differ by less lie in one plane [mm, rad].
_PLANE = 1e-4
_GAP = 1e-6  # [mm]


def write_step(points: Array, triangles: Any, path: Path) -> None:
    """Write a closed surface as a solid body, whose triangles in one plane are one face.

    Parameters
    ----------
    points : (n, 3) array
        Corners [mm].
    triangles : (t, 3) array of int
        Counter-clockwise seen from outside.
    path
        The file.

    Raises
    ------
    InputError
        If OCP is not installed, or the surface bounds no solid.
    OSError
        If the file cannot be written.
    """
    solid = _solid(points, triangles)
    control = _ocp("STEPControl")
    messages = _ocp("Message")
    messages.Message.DefaultMessenger_s().RemovePrinters(
        messages.Message_PrinterOStream.get_type_descriptor_s()
    )
    writer = control.STEPControl_Writer()
    writer.Transfer(solid, control.STEPControl_AsIs)
    if writer.Write(str(path)) != _ocp("IFSelect").IFSelect_RetDone:
        raise OSError("the STEP writer failed")


def _ocp(module: str) -> Any:
    return required(f"OCP.{module}", STEP)


def _solid(points: Array, triangles: Any) -> Any:
    """Return the body within a surface, a TopoDS_Solid."""
    build = _ocp("BRepBuilderAPI")
    upgrade = _ocp("ShapeUpgrade")
    surface = build.BRepBuilderAPI_MakeShapeOnMesh(_mesh(points, triangles))
    surface.Build()
    sewn = build.BRepBuilderAPI_Sewing(_GAP)
    sewn.Add(surface.Shape())
    sewn.Perform()
    merged = upgrade.ShapeUpgrade_UnifySameDomain(sewn.SewedShape(), True, True, False)
    merged.SetLinearTolerance(_PLANE)
    merged.SetAngularTolerance(_PLANE)
    merged.Build()
    body = build.BRepBuilderAPI_MakeSolid()
    for shell in _shells(merged.Shape()):
        body.Add(shell)
    solid = body.Solid()
    if not _ocp("BRepCheck").BRepCheck_Analyzer(solid).IsValid():
        raise InputError("the solid cannot be written as STEP: write it as STL or 3MF.")
    return solid


def _mesh(points: Array, triangles: Any) -> Any:
    """Return a Poly_Triangulation, whose indices begin at one."""
    poly, place = _ocp("Poly"), _ocp("gp")
    mesh = poly.Poly_Triangulation(len(points), len(triangles), False)
    for i, point in enumerate(points.tolist(), start=1):
        mesh.SetNode(i, place.gp_Pnt(*point))
    for i, corners in enumerate(triangles.tolist(), start=1):
        mesh.SetTriangle(i, poly.Poly_Triangle(*(corner + 1 for corner in corners)))
    return mesh


def _shells(shape: Any) -> list[Any]:
    """Return the closed surfaces of a shape: the outside and those of hollows."""
    kinds, explore = _ocp("TopAbs"), _ocp("TopExp")
    cast = _ocp("TopoDS").TopoDS
    explorer, found = explore.TopExp_Explorer(shape, kinds.TopAbs_SHELL), []
    while explorer.More():
        found.append(cast.Shell(explorer.Current()))
        explorer.Next()
    return found

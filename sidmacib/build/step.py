"""Solids as STEP, with plane faces, by OpenCASCADE: the package cadquery-ocp, which is optional."""

import importlib
import re
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from sidmacib.build.formats import UNITS, label
from sidmacib.build.solids import Solid

SEWN = 1e-4  # mm: edges of triangles nearer than this are one
TIME = re.compile(rb"(FILE_NAME\([^,]*,)'[^']*'")


def step(solids: Sequence[Solid], unit: str) -> bytes:
    """All solids where they are, each by its name, as a file of STEP (AP214).

    Triangles in one plane are one face. `ImportError` with what to install if OpenCASCADE is not.
    """
    _ocp("Message").Message.DefaultMessenger_s().ChangePrinters().Clear()  # it prints its progress
    document = _ocp("TDocStd").TDocStd_Document(_ocp("TCollection").TCollection_ExtendedString(""))
    tools = _ocp("XCAFDoc").XCAFDoc_DocumentTool
    tools.SetLengthUnit_s(document, 1e-3)  # of the shapes, m
    shapes, names = tools.ShapeTool_s(document.Main()), _ocp("TDataStd").TDataStd_Name
    for solid in solids:
        text = _ocp("TCollection").TCollection_ExtendedString(label(solid, len(solids)), True)
        names.Set_s(shapes.AddShape(_shape(solid), False), text)
    writer = _ocp("STEPCAFControl").STEPCAFControl_Writer()
    _ocp("Interface").Interface_Static.SetCVal_s("write.step.unit", unit.upper())
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "blocks.step")
        writer.Transfer(document)
        writer.Write(str(path))
        return TIME.sub(rb"\1''", path.read_bytes())  # the same file at any time


def _shape(solid: Solid) -> Any:
    """A solid of OpenCASCADE, in mm."""
    build, point = _ocp("BRepBuilderAPI"), _ocp("gp").gp_Pnt
    corners = [point(*place) for place in (UNITS["mm"] * solid.places).tolist()]
    sewing = build.BRepBuilderAPI_Sewing(SEWN)
    for triangle in solid.triangles.tolist():
        outline = build.BRepBuilderAPI_MakePolygon(*(corners[k] for k in triangle), True)
        sewing.Add(build.BRepBuilderAPI_MakeFace(outline.Wire(), True).Face())
    sewing.Perform()
    shell = _ocp("TopoDS").TopoDS.Shell(sewing.SewedShape())
    closed = build.BRepBuilderAPI_MakeSolid(shell).Solid()
    planes = _ocp("ShapeUpgrade").ShapeUpgrade_UnifySameDomain(closed, True, True, False)
    planes.Build()
    return planes.Shape()


def _ocp(module: str) -> Any:
    try:
        return importlib.import_module(f"OCP.{module}")
    except ImportError:
        words = "needs the package cadquery-ocp-novtk: pip install multilock[step]"
        raise ImportError(words) from None

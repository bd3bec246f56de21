"""Files of solids: STL for each, 3MF, OBJ and STEP for all.

STEP is written by OpenCASCADE: the package cadquery-ocp, which is optional.
"""

import importlib
import io
import re
import tempfile
import zipfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from urllib.parse import quote
from xml.sax.saxutils import quoteattr

import trimesh

from sidmacib.build import Solid, laid, own_axes
from sidmacib.errors import lacks

UNITS = {"mm": 1e3, "m": 1.0}  # of a metre
DIGITS = {"mm": 7, "m": 10}  # behind the decimal point
_WORDS = {"mm": "millimeter", "m": "meter"}
_CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
_PACKAGE = "http://schemas.openxmlformats.org/package/2006"
_TYPES = (
    f'<Types xmlns="{_PACKAGE}/content-types"><Default Extension="rels" ContentType='
    '"application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" '
    'ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>'
)
_LINKS = (
    f'<Relationships xmlns="{_PACKAGE}/relationships"><Relationship Target="/3D/3dmodel.model" '
    'Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>'
)
_HEAD = '<?xml version="1.0" encoding="UTF-8"?>\n'
SEWN = 1e-4  # mm: edges of triangles nearer than this are one
TIME = re.compile(rb"(FILE_NAME\([^,]*,)'[^']*'")


def label(solid: Solid, count: int) -> str:
    """The number and the name of a solid, which is one of ``count``."""
    return f"{solid.number:0{len(str(count))}d} {solid.name}"


def file_name(solid: Solid, count: int) -> str:
    """`label` as a name of a file, without its ending."""
    return quote(label(solid, count).replace(" ", "-", 1), safe=" ()")


def stl(solid: Solid, unit: str) -> bytes:
    """A solid by itself, along its own axes and from 0 on: 32-bit numbers have few digits."""
    alone = laid(solid, own_axes(solid))
    mesh = trimesh.Trimesh(UNITS[unit] * alone.places, alone.triangles, process=False)
    return bytes(trimesh.exchange.stl.export_stl(mesh))


def obj_text(solids: Sequence[Solid], unit: str) -> str:
    """All solids where they are, an object each."""
    lines, before = [f"# multilock, in {unit}"], 1
    for solid in solids:
        lines.append(f"o {label(solid, len(solids)).replace(' ', '_')}")
        lines += [f"v {x} {y} {z}" for x, y, z in _texts(solid, unit)]
        lines += [f"f {a} {b} {c}" for a, b, c in (solid.triangles + before).tolist()]
        before += len(solid.places)
    return "\n".join(lines) + "\n"


def _texts(solid: Solid, unit: str) -> list[list[str]]:
    """The coordinates of a solid's corners."""
    return [
        [f"{UNITS[unit] * x:.{DIGITS[unit]}f}".rstrip("0").rstrip(".") for x in place]
        for place in solid.places.tolist()
    ]


def threemf(solids: Sequence[Solid], unit: str) -> bytes:
    """All solids where they are, an object each, as a package of 3MF (core specification 1.3).

    Written here, as the writer of trimesh puts the time into the file and leaves out the unit.
    """
    objects, items = [], []
    for solid in solids:
        corners = "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in _texts(solid, unit))
        sides = "".join(
            f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in solid.triangles.tolist()
        )
        name = quoteattr(label(solid, len(solids)))
        objects.append(
            f'<object id="{solid.number}" type="model" name={name}><mesh><vertices>{corners}'
            f"</vertices><triangles>{sides}</triangles></mesh></object>\n"
        )
        items.append(f'<item objectid="{solid.number}"/>')
    model = (
        f'{_HEAD}<model unit="{_WORDS[unit]}" xml:lang="en" xmlns="{_CORE}"><resources>\n'
        f"{''.join(objects)}</resources><build>{''.join(items)}</build></model>\n"
    )
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as package:
        for name, text in (
            ("[Content_Types].xml", _HEAD + _TYPES),
            ("_rels/.rels", _HEAD + _LINKS),
            ("3D/3dmodel.model", model),
        ):
            entry = zipfile.ZipInfo(name)  # its time is always the same
            entry.compress_type = zipfile.ZIP_DEFLATED
            package.writestr(entry, text)
    return stream.getvalue()


def step(solids: Sequence[Solid], unit: str) -> bytes:
    """All solids where they are, each by its name, as a file of STEP (AP214).

    Triangles in one plane are one face. ValueError with what to install if OpenCASCADE is not.
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
        raise lacks("cadquery-ocp-novtk", "step") from None

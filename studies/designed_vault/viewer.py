"""A model of compas_dem and its results in COMPAS's viewer, or a picture of them.

``python -m studies.designed_vault.viewer vault.json results.json`` needs compas_dem and
compas_viewer (``requirements/peers.txt``). Without a screen: ``QT_QPA_PLATFORM=offscreen``.
"""

import argparse
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

DRAWN = 3000  # ms until the viewer has drawn everything
FORCES = 3.0  # scale of the forces
FROM = (-0.5, -1.1, 0.45)  # where the model is seen from, over its size


def viewer_of(model: Path, results: Path) -> Any:
    """The viewer of compas_dem with the blocks, their mechanism and the forces between them."""
    compas = import_module("compas")
    _mend()
    viewer = import_module("compas_dem.viewer").DEMViewer(compas.json_load(model))
    viewer.setup()
    viewer.groups["model"].show = False  # else the blocks hide how they move
    viewer.add_solution(compas.json_load(results), scale=FORCES)
    corners = [
        block.modelgeometry.vertex_coordinates(vertex)
        for block in viewer.model.elements()
        for vertex in block.modelgeometry.vertices()
    ]
    low, high = np.min(corners, axis=0), np.max(corners, axis=0)
    camera, middle = viewer.renderer.camera, (low + high) / 2
    camera.target.set(*middle.tolist())
    camera.position.set(*(middle + np.linalg.norm(high - low) * np.array(FROM)).tolist())
    return viewer


def _mend() -> None:
    """Repair compas_dem 0.6.0, which lacks attributes that its own viewer reads.

    `Block.point` is a list where the viewer asks for a point, and polygons become shapes only with
    compas_occ, which PyPI does not have.
    """
    geometry, meshes = import_module("compas.geometry"), import_module("compas.datastructures")
    block = import_module("compas_dem.elements").Block
    block.point = property(lambda self: geometry.Point(*self.modelgeometry.centroid()))
    geometry.Polygon.to_brep = lambda self: meshes.Mesh.from_polygons([self])


def shown(model: Path, results: Path, picture: Path | None) -> None:
    """Open the viewer; with ``picture`` draw into that file and end."""
    viewer = viewer_of(model, results)
    if picture:
        timer = import_module("PySide6.QtCore").QTimer

        def draw() -> None:
            viewer.renderer.grabFramebuffer().save(str(picture))
            viewer.app.quit()

        timer.singleShot(DRAWN, draw)
    viewer.show()


def main() -> None:
    """Command line: the files of a model and its results."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("model", type=Path)
    parser.add_argument("results", type=Path)
    parser.add_argument("--picture", type=Path, help="draw into this file and end")
    arguments = parser.parse_args()
    shown(arguments.model, arguments.results, arguments.picture)


if __name__ == "__main__":
    main()

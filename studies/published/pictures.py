"""A picture of the README: the blocks of a joint of five locks, apart and together.

``python -m studies.published.pictures docs/images`` draws it.
"""

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from PIL import Image

from sidmacib.build import Solid, joint_blocks, solids
from sidmacib.build.clearance import Clearance
from sidmacib.build.views import view
from sidmacib.drawing import BLACK, BLUE, ORANGE
from sidmacib.joint import Joint
from sidmacib.mechanics.assembly import Floats

JOINT = Joint(5, a=0.08, h=0.02, H=0.05)  # m
CLEARANCE = Clearance(5e-4)
LIGHT = np.array([0.5, -0.2, 0.84])  # of length 1
LIFTED = 0.075  # m
BLOCKS_COLOURS = 24
FINE = 0.01  # m: sides of triangles, so that their order from the back is right
# To the right, up, and towards the viewer.
AXES = np.array([[-0.6, 0.8, 0.0], [-0.28, -0.21, 0.9367497], [0.7493998, 0.5620498, 0.35]])


def scene(parts: Sequence[tuple[Solid, float]]) -> Solid:
    """Blocks, each lifted by some m, as one surface."""
    places, triangles, before = [], [], 0
    for solid, lift in parts:
        places.append(solid.places + np.array([0.0, 0.0, lift]))
        triangles.append(solid.triangles + before)
        before += len(solid.places)
    return replace(parts[0][0], places=np.concatenate(places), triangles=np.concatenate(triangles))


def faces(parts: Sequence[tuple[Solid, float]]) -> Iterator[tuple[float, Floats, Floats]]:
    """Depth, outline (m) and colour of small triangles that face the viewer."""
    for (solid, lift), colour in zip(parts, (ORANGE, BLUE), strict=True):
        mesh = solid.manifold.refine_to_length(FINE).to_mesh64()
        places = np.asarray(mesh.vert_properties)[:, :3] + np.array([0.0, 0.0, lift])
        for corners in places[np.asarray(mesh.tri_verts).astype(np.int64)]:
            normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
            normal /= np.linalg.norm(normal)
            if normal @ AXES[2] > 0.0:
                light = 0.55 + 0.45 * max(float(normal @ LIGHT), 0.0)
                seen = corners @ AXES.T
                yield seen[:, 2].mean(), seen[:, :2], light * np.array(to_rgb(colour))


def draw_blocks(path: Path) -> None:
    """Draw the lower block, the upper one above it, and both together."""
    lower, upper = solids(*joint_blocks(JOINT)[:2], CLEARANCE)
    figure = Figure(figsize=(8.4, 2.6))
    for number, lift in enumerate((LIFTED, 0.0)):
        parts = ((lower, 0.0), (upper, lift))
        axes = figure.add_axes((0.5 * number, 0.0, 0.5, 1.0))
        drawn = sorted(faces(parts), key=lambda face: face[0])
        paint = [face[2] for face in drawn]
        outlines = [face[1] for face in drawn]
        axes.add_collection(PolyCollection(outlines, facecolors=paint, edgecolors=paint, lw=0.4))
        edges = view(scene(parts), AXES).visible
        axes.add_collection(LineCollection(edges, colors=BLACK, lw=0.8, capstyle="round"))
        axes.autoscale_view()
        axes.set_aspect("equal")
        axes.set_axis_off()
    figure.savefig(path, dpi=110)
    with Image.open(path) as read:
        few = read.convert("RGB").quantize(BLOCKS_COLOURS, dither=Image.Dither.NONE)
    few.save(path, optimize=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    folder = parser.parse_args().folder
    draw_blocks(folder / "blocks.png")

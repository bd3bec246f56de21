"""Pictures of the README: a joint that is loaded, and the blocks of a joint, apart and together.

``python -m studies.published.pictures docs/images`` draws both. The moving one shows what fails
first, and what is left: the static model of a sample of ``config.yaml``, so that it changes only if
the model does. Blocks are those of a joint of five locks.
"""

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path

import numpy as np
from matplotlib.animation import PillowWriter
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from PIL import Image, ImageSequence

from analysis.drawing import MM
from analysis.paths import displacements
from sidmacib.build import Clearance, Solid, joint_blocks, solids
from sidmacib.build.views import view
from sidmacib.drawing import BLACK, BLUE, GREY, ORANGE, VERMILION
from sidmacib.joint import Direction, Joint
from sidmacib.joint.loading import Loading, posed
from sidmacib.joint.pieces import lock_faces, upper_block
from sidmacib.mechanics.assembly import Assembly, Floats
from sidmacib.mechanics.solution import Equilibrium
from sidmacib.mechanics.static import static_peak
from sidmacib.mechanics.static.peaks import after_peak
from workflow.configuration import read_study_file

CHECKOUT = Path(__file__).parents[2]
SAMPLE, RATIO, MESH = "n5_fits", 0.5, 0.01  # e / a; m
RISING, BEHIND = 14, 22  # frames, at most
STILL = 7  # frames in which nothing moves: at the first failure, the peak and the end
RATE = 6  # frames a second
WIDEST = 0.22  # of a lock's width: the largest displacement that is drawn
FILM_COLOURS = 96
PLACES = ((0.0, 0.1, 0.66, 0.78), (0.735, 0.17, 0.25, 0.7))  # of map and curve in the figure
JOINT = Joint(5, a=0.08, h=0.02, H=0.05)  # m
CLEARANCE = Clearance(5e-4)
LIGHT = np.array([0.5, -0.2, 0.84])  # of length 1
LIFTED = 0.075  # m
BLOCKS_COLOURS = 24
FINE = 0.01  # m: sides of triangles, so that their order from the back is right
# To the right, up, and towards the viewer.
AXES = np.array([[-0.6, 0.8, 0.0], [-0.28, -0.21, 0.9367497], [0.7493998, 0.5620498, 0.35]])


@dataclass(frozen=True)
class Film:
    """The equilibria that are shown, with what is said of each, and the joint that they are of."""

    joint: Joint
    assembly: Assembly
    path: Sequence[Equilibrium]
    behind: Sequence[Equilibrium]
    first: float

    def frames(self) -> Iterator[tuple[Equilibrium, str]]:
        """Each frame, some of them several times."""
        peak, share = self.path[-1], 1.0 / np.hypot(1.0, RATIO)
        whole = [point for point in self.path if point.load < self.first * (1.0 - 1e-6)]
        broken = [point for point in self.path if point.load >= self.first * (1.0 - 1e-6)]
        lock = self.first_lock(broken[-1] if len(broken) > 1 else self.behind[0])
        for point in whole[:: -(-len(whole) // RISING)]:
            yield point, "The load rises: all bonds are whole"
        for _ in range(STILL):
            yield broken[0], f"V = {share * self.first:.0f} N: lock {lock} is the first to fail"
        for point in broken[1:-1][:: -(-len(broken) // RISING)]:
            yield point, "More of its nodes fail, and the load still rises"
        for _ in range(STILL):
            yield peak, f"V = {share * peak.load:.0f} N: the peak"
        for point in self.behind[:: -(-len(self.behind) // BEHIND)]:
            yield point, "Behind the peak: the load is let down as bonds fail"
        for _ in range(STILL):
            yield self.behind[-1], "Behind the peak: the load is let down as bonds fail"

    def first_lock(self, point: Equilibrium) -> int:
        """The lock that has most failed nodes at ``point``."""
        nodes, numbers = self.assembly.nodes, lock_faces(self.joint)
        failed = {
            numbers[face.name]: int((~point.state.bonded[nodes.face == index]).sum())
            for index, face in enumerate(self.assembly.faces)
            if face.name in numbers
        }
        return max(failed, key=lambda lock: failed[lock])


def film() -> Film:
    """The static model's path of the sample, and what is left behind its peak."""
    study = read_study_file(CHECKOUT / "config.yaml")
    joint = study.joint(SAMPLE)
    problem = posed(joint, Loading(Direction(RATIO)), MESH, study.nodes)
    solution = static_peak(*problem)
    behind = list(islice(after_peak(*problem, solution.peak), 200))
    return Film(joint, problem.assembly, solution.path, behind, solution.first_failure_load)


def moved(points: Floats, centre: Floats, move: Floats, scale: float) -> Floats:
    """``points`` (N, 2), x and y in m, of a piece that moves and turns about its ``centre``."""
    off = points - centre
    turned = np.column_stack([-off[:, 1], off[:, 0]])
    return np.asarray(points + scale * (move[:2] + move[5] * turned))


def draw(axes: Axes, film: Film, point: Equilibrium, scale: float) -> None:
    """The locks from below, moved, with the shear over the cohesion at the nodes of their faces."""
    joint, assembly = film.joint, film.assembly
    moves = displacements(assembly, point)
    upper = set(upper_block(joint))
    numbers = lock_faces(joint)
    shear = np.hypot(point.force[:, 1], point.force[:, 2]) / assembly.nodes.area
    for index, face in enumerate(assembly.faces):
        if face.name not in numbers:
            continue
        lock = numbers[face.name]
        place = next(k for k, each in enumerate(assembly.pieces) if each.name == f"lock{lock}")
        piece = assembly.cuboids[place]
        low, high = np.array(piece.low[:2]), np.array(piece.high[:2])
        corners = np.array([low, (high[0], low[1]), high, (low[0], high[1])])
        on_face = assembly.nodes.face == index
        outline, nodes = (
            MM * moved(points, (low + high) / 2.0, moves[place], scale)[:, ::-1]
            for points in (corners, assembly.nodes.position[on_face, :2])
        )
        colour, alpha = (BLUE, 0.3) if piece.name in upper else (GREY, 0.6)
        axes.add_patch(Polygon(outline, facecolor=colour, alpha=alpha, edgecolor=BLACK, lw=0.8))
        bonded = point.state.bonded[on_face]
        used = shear[on_face] / face.material.cohesion
        look = {"marker": "s", "s": 26, "cmap": "viridis", "vmin": 0.0, "vmax": 1.0}
        axes.scatter(*nodes[bonded].T, c=used[bonded], linewidths=0, **look)
        axes.scatter(*nodes[~bonded].T, marker="x", s=24, color=VERMILION, lw=1.5)
        y = MM * joint.lock_centre_y(lock)
        axes.text(y, 0.78 * MM * joint.a, f"lock {lock}", ha="center", fontsize=9)


def draw_film(film: Film, path: Path) -> None:
    """Write the film as a GIF that is played three times."""
    joint, share = film.joint, 1.0 / np.hypot(1.0, RATIO)
    every = [*film.path, *film.behind]
    moves = [displacements(film.assembly, point)[:, :2] for point in film.path]
    farthest = max(float(np.abs(move).max()) for move in moves)
    scale = WIDEST * joint.b / farthest
    figure = Figure(figsize=(8.4, 3.1), dpi=100)
    map_axes, line_axes = (figure.add_axes(place) for place in PLACES)
    rising, loads = len(film.path), np.array([share * point.load for point in every])
    places = np.array([1e6 * point.displacement for point in every])
    note = (
        "Locks from below. Colour: shear stress over cohesion, from 0 (dark) to 1 (yellow);\n"
        f"crosses: failed. Displacements \N{MULTIPLICATION SIGN} {scale:.0f}. Static model."
    )
    writer = PillowWriter(fps=RATE)
    with writer.saving(figure, str(path), 100):
        for point, words in film.frames():
            map_axes.clear()
            line_axes.clear()
            draw(map_axes, film, point, scale)
            _load(map_axes, joint, share * point.load, loads.max())
            line_axes.plot(places[:rising], loads[:rising], color=BLUE, lw=1.6)
            line_axes.plot(places[rising - 1 :], loads[rising - 1 :], ":", color=BLUE, lw=1.0)
            here = 1e6 * point.displacement, share * point.load
            line_axes.plot(*here, "o", color=VERMILION, ms=7)
            line_axes.set_xlim(0.0, 1.08 * places.max())
            line_axes.set_ylim(0.0, 1.1 * loads.max())
            line_axes.set_xlabel("displacement (µm)")
            line_axes.set_ylabel("V (N)")
            map_axes.set_title(words, loc="left", fontsize=12, x=0.03)
            map_axes.text(0.03, 0.0, note, transform=map_axes.transAxes, fontsize=8, va="top")
            writer.grab_frame()
    _fewer_colours(path)


def _load(axes: Axes, joint: Joint, shear: float, largest: float) -> None:
    """V as an arrow at its eccentricity."""
    width, e = MM * joint.total_width, MM * RATIO * joint.a
    length = 0.25 * width * shear / largest
    look = {"arrowstyle": "-|>", "color": BLACK, "lw": 2.0, "shrinkA": 0, "shrinkB": 0}
    if shear > 0.0:
        axes.annotate("", (-6.0, e), (-6.0 - length, e), arrowprops=look)
    axes.text(-8.0, e + 4.0, f"V = {shear:.0f} N", ha="right", fontsize=9)
    axes.plot((-0.12 * width, width), (0.0, 0.0), color=BLACK, lw=0.6, ls="-.", zorder=0)
    axes.annotate(
        "", (-0.1 * width, 0), (-0.1 * width, e), arrowprops={"arrowstyle": "<->", "lw": 0.8}
    )
    axes.text(-0.12 * width, e / 2.0, "e", ha="right", va="center", fontsize=9)
    axes.set_xlim(-0.36 * width, 1.1 * width)
    axes.set_ylim(-0.95 * MM * joint.a, 0.95 * MM * joint.a)
    axes.set_aspect("equal")
    axes.set_axis_off()


def _fewer_colours(path: Path) -> None:
    """Make the GIF smaller: `FILM_COLOURS` for all frames, and three times in all."""
    with Image.open(path) as gif:
        frames = [each.convert("RGB") for each in ImageSequence.Iterator(gif)]
        times = [each.info.get("duration", 1000 // RATE) for each in ImageSequence.Iterator(gif)]
    shown = [frames[0], frames[len(frames) // 3], frames[len(frames) // 2], frames[-1]]
    strip = Image.new("RGB", (frames[0].width, frames[0].height * len(shown)))
    for place, frame in enumerate(shown):
        strip.paste(frame, (0, place * frame.height))
    palette = strip.quantize(FILM_COLOURS, method=Image.Quantize.MAXCOVERAGE)
    drawn = [each.quantize(palette=palette, dither=Image.Dither.NONE) for each in frames]
    drawn[0].save(
        path, save_all=True, append_images=drawn[1:], duration=times, loop=2, optimize=True
    )


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
    draw_film(film(), folder / "first_failure.gif")
    draw_blocks(folder / "blocks.png")

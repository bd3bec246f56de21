"""The joint itself: its pieces from the side and from below, with sizes, and where V and M act."""

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from analysis.drawing.boxes import MM, boxes
from analysis.figures import style
from analysis.figures.material import FigureData
from sidmacib.drawing import BLACK, BLUE, GREY, VERMILION
from sidmacib.joint.joint import Joint
from sidmacib.joint.loading import Push

X, Y, Z = range(3)


def joint(material: FigureData) -> Figure:
    """A sample's joint from the side and from below, as stress maps show it."""
    drawn, push = material.study.joint(material.sample), material.study.assembly.push
    figure = Figure(figsize=(8.6, 4.8), layout="constrained")
    side, below = figure.subplots(2, 1)
    _draw(side, drawn, (Y, Z))
    _draw(below, drawn, (Y, X))
    width, bottom, top = MM * drawn.total_width, -MM * drawn.H, MM * (drawn.h + drawn.H)
    sign, start = (1.0, 0.0) if push is Push.PLUS_Y else (-1.0, width)
    beside = sign * 0.3 * MM * drawn.a
    for axes, height, words in ((side, top / 2.0, "V"), (below, beside, "V")):
        axes.annotate(
            words,
            (start, height),
            (start - sign * 0.22 * width, height),
            arrowprops={"arrowstyle": "-|>", "color": BLACK, "lw": 1.5},
            ha="center",
            va="center",
            fontsize=9,
        )
        axes.set_xlim(-0.4 * width, 1.4 * width)
        axes.set_aspect("equal")
        axes.set_axis_off()
    below.plot((-0.16 * width, 1.02 * width), (0.0, 0.0), color=BLACK, lw=0.6, ls="-.", zorder=1.5)
    below.text(1.03 * width, 0.0, "middle", va="center", fontsize=8)
    _torque(below, (width / 2.0, 0.0), 0.36 * MM * drawn.a)
    side.set_title("from the side", loc="left", fontsize=10)
    below.set_title("locks from below", loc="left", fontsize=10)
    right, centre = 1.16 * width, MM * drawn.b
    _size(side, (right, MM * drawn.h, top), f"H = {MM * drawn.H:g}")
    _size(side, (right, 0.0, MM * drawn.h), f"h = {MM * drawn.h:g}")
    _size(below, (right, -MM * drawn.a / 2.0, MM * drawn.a / 2.0), f"a = {MM * drawn.a:g}")
    _size(below, (start - sign * 0.07 * width, min(0.0, beside), max(0.0, beside)), "e")
    _name(
        side,
        "inner face of lock 1: bonded",
        (0.5 * centre, MM * drawn.h),
        (0.5 * centre, 1.5 * top),
    )
    _name(side, "inner face of lock 2: bonded", (1.5 * centre, 0.0), (1.5 * centre, 1.6 * bottom))
    _name(side, "dry face", (2.0 * centre, MM * drawn.h / 2.0), (2.6 * centre, 1.5 * top))
    style.caption(
        figure,
        f"{drawn.locks} numbered locks, b = {MM * drawn.b:g} mm each; sizes in mm. Blue: upper "
        "block, loaded by V at the eccentricity e, so by the torque M = V e. Grey: lower block, "
        "held. Each lock is bonded to its own block by its inner face; all its other faces are "
        f"dry. Strength of a lock: T0 = cohesion times a b = {drawn.T0:.4g} N. "
        f"{material.assumed_geometry}",
        height=0.2,
    )
    return figure


def _torque(axes: Axes, middle: tuple[float, float], radius: float) -> None:
    """M as an arrow that turns about the ``middle``."""
    ends = [(middle[0] + radius * sign, middle[1] - 0.6 * radius) for sign in (-1.0, 1.0)]
    look = {"arrowstyle": "-|>", "connectionstyle": "arc3,rad=-0.5", "color": VERMILION, "lw": 1.5}
    axes.annotate("", ends[0], ends[1], arrowprops={**look, "shrinkA": 0, "shrinkB": 0})
    axes.text(ends[1][0], ends[1][1], "  M = V e", color=VERMILION, fontsize=9, va="center")


def _name(axes: Axes, words: str, face: tuple[float, float], place: tuple[float, float]) -> None:
    """A name at ``place`` with a line to the ``face`` that it is of."""
    axes.annotate(
        words,
        face,
        place,
        arrowprops={"arrowstyle": "-", "lw": 0.8, "shrinkB": 0},
        ha="center",
        va="center",
        fontsize=8,
    )


def _draw(axes: Axes, joint: Joint, plane: tuple[int, int]) -> None:
    """The pieces, projected on two axes; from below only the locks."""
    across, along = plane
    for piece in boxes(joint):
        if along == X and piece.lock is None:
            continue
        corner = piece.low[across], piece.low[along]
        size = piece.high[across] - corner[0], piece.high[along] - corner[1]
        look = {"facecolor": BLUE if piece.upper else GREY, "edgecolor": BLACK, "lw": 0.6}
        axes.add_patch(Rectangle(corner, *size, **look, alpha=0.3 if piece.lock is None else 0.8))
        if piece.lock is not None:
            axes.text(
                corner[0] + size[0] / 2,
                corner[1] + size[1] / 2,
                f"{piece.lock}",
                ha="center",
                va="center",
                fontsize=8,
                bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.0, "alpha": 0.8},
            )
    axes.autoscale_view()


def _size(axes: Axes, place: tuple[float, float, float], words: str) -> None:
    """An arrow with a size beside it, upright."""
    x, low, high = place
    look = {"arrowstyle": "|-|,widthA=0.2,widthB=0.2", "lw": 0.8, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", (x, low), (x, high), arrowprops=look)
    axes.text(x, (low + high) / 2, f"  {words}", va="center", fontsize=8)

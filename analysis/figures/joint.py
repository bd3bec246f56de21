"""The joint itself: its pieces from the side and from below, with sizes, and where V and M act."""

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from analysis.figures import style
from analysis.figures.material import Material
from analysis.outlines import MM, outlines
from sidmacib.joint import Joint
from sidmacib.loading import Push
from workflow.colours import BLACK, BLUE, GREY

X, Y, Z = range(3)


def joint(material: Material) -> Figure:
    """A sample's joint from the side and from below, as stress maps show it."""
    own, push = material.study.joint(material.sample), material.study.assembly.push
    figure = Figure(figsize=(8.6, 4.6), layout="constrained")
    side, below = figure.subplots(2, 1)
    _draw(side, own, (Y, Z))
    _draw(below, own, (Y, X))
    width, top = MM * own.total_width, MM * (own.h + own.H)
    sign, start = (1.0, 0.0) if push is Push.PLUS_Y else (-1.0, width)
    for axes, height, words in (
        (side, top / 2.0, "V"),
        (below, sign * 0.3 * MM * own.a, "V at e:\nM = V e"),
    ):
        axes.annotate(
            words,
            (start, height),
            (start - sign * 0.22 * width, height),
            arrowprops={"arrowstyle": "-|>", "color": BLACK, "lw": 1.5},
            ha="center",
            va="center",
            fontsize=8,
        )
        axes.set_xlim(-0.35 * width, 1.35 * width)
        axes.set_aspect("equal")
        axes.grid(visible=False)
        axes.set_xlabel("y (mm)")
    below.plot((0.0, width), (0.0, 0.0), color=BLACK, lw=0.6, ls="-.")
    side.set_ylabel("z (mm)")
    below.set_ylabel("x (mm)")
    side.set_title("from the side", loc="left", fontsize=10)
    below.set_title("locks from below", loc="left", fontsize=10)
    _size(side, (1.08 * width, MM * own.h, top), f"H = {MM * own.H:g}")
    _size(side, (1.08 * width, 0.0, MM * own.h), f"h = {MM * own.h:g}")
    _size(below, (1.08 * width, -MM * own.a / 2.0, MM * own.a / 2.0), f"a = {MM * own.a:g}")
    style.caption(
        figure,
        f"{own.locks} locks, b = {MM * own.b:g} mm each. Blue: upper block, which is pushed; grey: "
        "lower block. A lock meets its own block across its inner face, at z = h or z = 0; all "
        "other faces of it are dry. T0, the strength of a lock, is cohesion times a b = "
        f"{own.T0:.4g} N. {material.assumed_geometry}",
        height=0.2,
    )
    return figure


def _draw(axes: Axes, own: Joint, plane: tuple[int, int]) -> None:
    """The pieces, projected on two axes; from below only the locks."""
    across, along = plane
    for piece in outlines(own):
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
            )
    axes.autoscale_view()


def _size(axes: Axes, place: tuple[float, float, float], words: str) -> None:
    """An arrow with a size beside it, upright."""
    x, low, high = place
    axes.annotate("", (x, low), (x, high), arrowprops={"arrowstyle": "<->", "lw": 0.8})
    axes.text(x, (low + high) / 2, f" {words}", va="center", fontsize=8)

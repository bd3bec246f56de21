"""Colours, and V-M curves in print: for the command's pictures and the figures of studies."""

import importlib
import math
from collections.abc import Iterable
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

if TYPE_CHECKING:  # it takes longer to load than most answers to compute
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Colours that people with any kind of colour vision tell apart (Okabe and Ito, 2008).
BLUE, VERMILION, GREEN, PURPLE, SKY, ORANGE, OCHRE, BLACK, GREY = (
    *("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#8a6d00", "#000000"),
    "#9aa0aa",
)
# Of a V-M curve, e / a: straight lines between these are at most 1 % above the safe rule.
VM_RATIOS = (0.0, 0.05, 0.1, 0.2, 0.35, 0.5, 1.0, 2.0, math.inf)


def write_figure(figure: "Figure", to: Path | IO[str], **how: Any) -> None:
    """Write ``figure`` into a .svg, .pdf or .png file, or as SVG into a stream; always the same.

    ``how``: as `matplotlib.figure.Figure.savefig` takes it.
    """
    form = to.suffix[1:].lower() if isinstance(to, Path) else "svg"
    dates = {"svg": {"Date": None}, "pdf": {"CreationDate": None}, "png": {"Software": None}}
    with importlib.import_module("matplotlib").rc_context({"svg.hashsalt": "multilock"}):
        figure.savefig(to, format=form, metadata=dates[form], **how)


def vm_axes(axes: "Axes", title: str) -> None:
    """Label ``axes`` for V-M curves, starting from zero load."""
    axes.set_xlabel("shear V (N)")
    axes.set_ylabel("torque M (N m)")
    axes.set_title(title, loc="left", fontsize=10)
    axes.set_xlim(left=0)
    axes.set_ylim(bottom=0)


def vm_curve(
    axes: "Axes", shear: Iterable[float], torque: Iterable[float], label: str, **style: Any
) -> None:
    """Draw a curve or points of ``shear`` (N) and ``torque`` (N m); not at all if there are none.

    ``style``: as `matplotlib.axes.Axes.plot` takes it.
    """
    shear, torque = list(shear), list(torque)
    if shear:
        axes.plot(shear, torque, **{"label": label, **style})

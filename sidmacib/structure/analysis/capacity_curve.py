"""The capacity curve of a structure: the load that it carries as it moves, down to zero.

From the mechanism of limit analysis on, the blocks are followed as they move, see
`sidmacib.structure.analysis.kinematics`. Joints are rigid and dry.
"""

from dataclasses import dataclass

import numpy as np

from sidmacib.mechanics.assembly import Assembly, Floats, Loads
from sidmacib.structure.analysis.kinematics import FALL, REACHED, WEDGE, Kinematics, Path, Position
from sidmacib.structure.loads import SupportMotion


@dataclass(frozen=True, eq=False)
class CapacityCurve:
    """The load (N) over the ``displacement`` along it (m), both (K,).

    The displacement is that on which the load does work: of the point where a force acts; the mean
    by mass under an acceleration. ``rotation``: the largest of a block, in degrees, (K,). ``path``:
    the positions, whose last carries less than nothing if the load falls to 0; the last point of
    the curve is at 0 then. ``hinges``, ``slides``: names of interfaces at the start.
    """

    displacement: Floats
    load: Floats
    rotation: Floats
    path: Path
    hinges: tuple[str, ...]
    slides: tuple[str, ...]

    @property
    def end(self) -> str:
        """What happens at the last displacement, in words."""
        last = f"{self.displacement[-1]:.4g} m"
        if self.path.end == REACHED:
            return f"the load falls to 0 at {last}"
        if self.path.end == FALL:
            return f"the blocks fall at {last}, whatever the load"
        if self.path.end == WEDGE:
            return f"the blocks wedge at {last}: the load grows without limit"
        if self.path.met:
            return f"{' and '.join(self.path.met)} meet at {last}, where the curve ends"
        return f"followed to {last}"


def capacity_curve(assembly: Assembly, loads: Loads) -> CapacityCurve:
    """Follow the mechanism of ``assembly`` under the variable ``loads`` until they fall to 0.

    `sidmacib.errors.CapacityError` where gravity turns, for interfaces that are not dry, and
    without a limit load. ValueError where a support moves.
    """
    if isinstance(loads, SupportMotion):
        loads.require_proportional()
    kinematics = Kinematics.of(assembly, loads)
    path = kinematics.path(lambda position: position.load <= 0.0)
    found = path.positions
    load, moved = np.array([(each.load, each.moved) for each in found]).T
    turned = np.array([_largest_rotation(each) for each in found])
    if path.end == REACHED and len(load) > 1:
        part = load[-2] / (load[-2] - load[-1])
        for each in (moved, turned, load):
            each[-1] = each[-2] + part * (each[-1] - each[-2])
    return CapacityCurve(moved, load, turned, path, *kinematics.moving(found[0]))


def _largest_rotation(position: Position) -> float:
    """In degrees, of any block."""
    cosine = (np.trace(position.placed.turn, axis1=1, axis2=2) - 1.0) / 2.0
    return float(np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))).max())

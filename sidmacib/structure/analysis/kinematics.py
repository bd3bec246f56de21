r"""Finite motion of a structure of rigid blocks, by limit analysis on the displaced geometry.

The movement of a load or a support is given, step by step. In a step of h the blocks move by
:math:`\Delta u` so that their potential energy rises least while no contact closes beyond its gap
g. The dual of that is limit analysis of the displaced structure, in which a force may act across a
gap that the step can close, at a cost:

.. math::

    \max_{\lambda, s} \quad \lambda - \tfrac{1}{h} g^T s_n
    \quad \text{subject to} \quad
    M s + p + \lambda q = 0, \quad |s_t| \le \mu s_n

M has the contacts where they are now, see `sidmacib.structure.analysis.contacts`. The multipliers
of equilibrium are :math:`\Delta u / h`, normalised by :math:`q^T \Delta u = h`. Associated friction
opens a joint that slides by at most :math:`\mu h`, once: the gap is there in the next step. So
sliding does not dilate as steps become small (Anitescu, Mathematical Programming 105, 2006,
113-143, doi:10.1007/s10107-005-0590-7).
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Protocol

import cvxpy as cp
import numpy as np
from scipy.sparse import csr_array

from sidmacib.errors import CapacityError, InfeasibleError, UnboundedError
from sidmacib.mechanics.assembly import Assembly, Floats
from sidmacib.mechanics.contact_law import Flags
from sidmacib.mechanics.optimisation import solve
from sidmacib.structure.analysis.contacts import OVER, Contacts, Placement

STEP = 0.01  # largest motion of a point in a step, over the length of the assembly
FAR = 300.0  # steps: contacts that are further open are left out
ACCURACIES = 1e-9, 1e-7, 1e-5
MOTION_DIGITS = 9
WHAT = "finite displacements"


@dataclass(frozen=True, eq=False)
class Freedoms:
    """What can move, and the forces along it.

    ``directions``: of the pieces (m and rad about their centroids) per unit of each freedom,
    (R, 6 P). ``units``: of the forces along them, in N or N m; ``permanent``: these forces;
    ``driving``: per unit of the driving one; all (R,). ``unit``: of the driving force.
    """

    directions: csr_array
    units: Floats
    permanent: Floats
    driving: Floats
    unit: float


class Drive(Protocol):
    """A load or a support whose movement is given, in m or rad."""

    def freedoms(self, assembly: Assembly, placed: Placement) -> Freedoms:
        """What can move where the pieces are ``placed``."""


@dataclass(frozen=True, eq=False)
class Position:
    """A position of the blocks, and limit analysis there.

    ``load``: the driving force that balances all others, N or N m. ``motion``: how the pieces go on
    to move per m or rad of the driving movement, (P, 6). ``force``: of the contacts, (K, 3) in N.
    ``gap``: of the contacts, in m, (K,).
    """

    placed: Placement
    load: float
    motion: Floats
    force: Floats
    gap: Floats


@dataclass(frozen=True, eq=False)
class Kinematics:
    """The blocks of ``assembly`` and their contacts, driven by a ``drive``."""

    assembly: Assembly
    contacts: Contacts
    drive: Drive

    @classmethod
    def of(cls, assembly: Assembly, drive: Drive) -> "Kinematics":
        """`CapacityError` unless all interfaces are dry."""
        return cls(assembly, Contacts.of(assembly), drive)

    def path(self, most: float = np.inf) -> Iterator[Position]:
        """Positions one after the other, each after a step, until the movement is ``most``.

        Errors of `position`: `InfeasibleError` where the blocks fall.
        """
        here = self.position(Placement.of(self.assembly), 1.0)
        moved = 0.0
        while True:
            yield here
            step = min(self.step(here.motion), most - moved)
            if not step > 0.0:
                return
            here = self.after(here, step)
            moved += step

    def after(self, here: Position, step: float) -> Position:
        """The position after a ``step`` (m or rad) of the driving movement, by the midpoint rule."""
        middle = self.position(here.placed.moved(step / 2 * here.motion), step)
        return self.position(here.placed.moved(step * middle.motion), step)

    def step(self, motion: Floats) -> float:
        """The driving movement by which a point moves by `STEP` of the assembly's length."""
        size = motion.reshape(-1, 2, 3) * np.array([1.0, self.assembly.length])[:, None]
        return STEP * self.assembly.length / float(np.linalg.norm(size, axis=2).max())

    def position(self, placed: Placement, step: float) -> Position:
        """Limit analysis where the pieces are ``placed``, over a ``step`` of the driving movement.

        `InfeasibleError` if no forces balance the permanent loads, `UnboundedError` if the driving
        force has no limit, as blocks wedge.
        """
        free = self.drive.freedoms(self.assembly, placed)
        scale, length = float(free.units.min()), self.assembly.length
        place, frames, local = self.contacts.seen(placed)
        gap = local[:, 0]
        closes = step * free.unit / scale  # m of a contact, of the order of the step
        near = self.contacts.over(local[:, 1:], OVER * length) & (gap <= FAR * closes)
        matrix = (free.directions @ self.contacts.matrix(placed, place, frames)).tocsc()
        used = np.flatnonzero(near)
        columns = (3 * used[:, None] + np.arange(3)).ravel()
        rows = matrix[:, columns].tocsr() * (scale / free.units)[:, None]
        load, s = cp.Variable(), cp.Variable((len(used), 3))
        balance = (
            rows @ cp.vec(s, order="C")
            + free.permanent / free.units
            + load * (free.driving * free.unit / free.units)
            == 0.0
        )
        friction = self.contacts.friction[used]
        limits = [cp.norm(s[:, 1:], 2, axis=1) <= cp.multiply(friction, s[:, 0])]
        cost = (gap[used] / closes) @ s[:, 0]
        solve(cp.Problem(cp.Maximize(load - cost), [balance, *limits]), WHAT, *ACCURACIES)
        multipliers = balance.dual_value / free.units
        motion = free.directions.T @ (multipliers / float(multipliers @ free.driving))
        force = np.zeros((len(gap), 3))
        force[used] = scale * s.value
        return Position(
            placed,
            float(load.value) * free.unit,
            np.round(motion.reshape(-1, 6), MOTION_DIGITS) + 0.0,
            force,
            gap,
        )

"""The first failure of the chain: the load at which a face reaches its strength."""

from dataclasses import dataclass

import numpy as np

from sidmacib.chain.equilibrium import equilibrium
from sidmacib.chain.model import ChainModel
from sidmacib.chain.pairs import bearing_pairs
from sidmacib.errors import CapacityError
from sidmacib.joint import Joint, UpperBody
from sidmacib.loading import Loading
from sidmacib.mechanics.assembly import Floats

MOST_LOADS = 40  # until the load is that of the first failure
NARROW = 0.02  # part of the interval that is left between a load to try and its ends
EXACT = 1e-6  # distance of the first failure from a use of 1
CLOSE = 1e-5  # of two loads between which friction lets the use jump
HELD = 1e-3  # force over the load: where as much hangs on what nothing holds, nothing carries it


@dataclass(frozen=True)
class ChainState:
    """What the roots carry at the first failure, lock by lock from the side that is pushed.

    ``load``: along the direction of loading, N. ``force_x``, ``force_y`` in N and ``torque`` in
    N m, on what is below each root, shape (n,). ``used``: largest stress over strength at each
    root, shape (n,). ``cut_used``: the same of the cuts; where it is 1 a cut fails first.
    """

    load: float
    force_x: Floats
    force_y: Floats
    torque: Floats
    used: Floats
    cut_used: float

    @property
    def cut_fails(self) -> bool:
        """Whether it is a cut between columns that fails first."""
        return self.cut_used > self.used.max()


def first_failure(joint: Joint, loading: Loading, standing: bool = True) -> ChainState:
    """The state in which the first face of ``joint`` reaches its strength.

    Up to there it makes no difference how bonds fail.

    ``standing``: whether there is friction above and below the locks, of weight and of what holds
    the joint down; there always is between them.

    ValueError for what is no such chain: fewer than two locks, locks of their own, joined columns
    or bonds without strength. `CapacityError` if no face carries the load.
    """
    _require_chain(joint)
    if not bearing_pairs(joint, loading.push):
        raise CapacityError(f"law: no pair of {joint.locks} locks bears in this direction")
    model = ChainModel(joint, loading, standing)
    load, moved = joint.T0, None
    low, high = (0.0, 0.0), (np.inf, np.inf)  # loads below and above, with their use
    for _ in range(MOST_LOADS):
        moved = equilibrium(model, load, moved)
        used, cut_used = model.roots_used(moved), model.cut_used(moved)
        most = max(float(used.max()), cut_used)
        if not 0.0 < most < np.inf or model.loose * float(np.abs(moved).max()) > HELD * load:
            raise CapacityError(f"law: nothing holds {joint.locks} locks in this direction")
        low, high = ((load, most), high) if most < 1.0 else (low, (load, most))
        if abs(most - 1.0) < EXACT or high[0] < low[0] * (1.0 + CLOSE):
            force = -model.root_forces(moved)
            return ChainState(load, force[:, 0], force[:, 1], force[:, 5], used, cut_used)
        before, load = load, _next_load(load / most, low, high)
        moved = moved * (load / before)
    raise CapacityError(f"law: contacts and friction of {joint.locks} locks do not settle")


def _next_load(proportional: float, low: tuple[float, float], high: tuple[float, float]) -> float:
    """A load (N) to try: the ``proportional`` one, or one between ``low`` and ``high``.

    Friction that was called up before makes the use rise faster than the load.
    """
    if not low[0] or not np.isfinite(high[0]):
        return proportional
    part = -np.log(low[1]) / np.log(high[1] / low[1])
    return float(low[0] * (high[0] / low[0]) ** np.clip(part, NARROW, 1.0 - NARROW))


def _require_chain(joint: Joint) -> None:
    """ValueError if ``joint`` is not what the chain stands for."""
    bond = joint.inner
    faults = (
        (joint.locks < 2, f"locks: {joint.locks}", "at least 2"),
        (bool(joint.different), "different: locks of their own are", "none"),
        (joint.upper_body is UpperBody.JOINED, "upper_body: joined", "columns or monolithic"),
        (bond.friction > 0.0, f"inner.friction: {bond.friction:g}", "0"),
        (bond.cohesion == 0.0, "inner.cohesion: 0", "more than 0"),
        (bond.tensile_strength == 0.0, "inner.tensile_strength: 0", "more than 0"),
    )
    for wrong, what, allowed in faults:
        if wrong:
            raise ValueError(f"{what} not possible with the law; it must be {allowed}")

"""Search for the joint with the largest ratio of safe load to first failure: ``make attack``.

In each space (how the joint is held down, and whether its blocks are elastic) differential
evolution varies everything that a `Joint` can be inside the rule's `SPANS`, and the direction of
the load. The worst joint is then put on the limits of the ranges, one by one. The first failure is
the static model's on nodes that the rule does not use; the peak is never below it. The worst joint
of each start is then solved down to the peak, on two meshes and with two layouts of the nodes.
"""

import argparse
import itertools
import math
import sys
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from scipy.optimize import differential_evolution

from sidmacib.errors import CapacityError
from sidmacib.joint import Direction, Hold, HoldDown, Joint, Side, UpperBody
from sidmacib.joint.loading import Loading, Push, posed
from sidmacib.mechanics.assembly import GRAVITY, Elastic, FaceMaterial, NodeLayout
from sidmacib.mechanics.static import static_first_failure
from sidmacib.mechanics.static.peaks import lowest_peak
from sidmacib.problem import Problem
from sidmacib.rule import safe
from sidmacib.rule.spans import SPANS
from studies.markdown import markdown

WIDTH, KN, COHESION = 0.05, 1e10, 8e4  # b (m), Kn (Pa/m), Pa: what all ratios are to
LEAST = 1e-4  # of ratios that may be 0: spread evenly in their logarithm from here on
STIFFEST = 5e3  # E / (Kn b) of elastic blocks: stiffer ones are rigid
SMOOTH, LIGHT = 0.2, 0.2  # shares of the joints without friction, without weight
DIMENSIONS = 17
POPULATION = 6  # joints of a generation, over the dimensions
CELLS = {False: 5, True: 3}  # of the search, along a lock's shorter side; True: elastic blocks
MOST_NODES = 1_200  # of a joint of elastic blocks in the search: more take minutes
CHECKS = {  # of the worst joints
    False: ((NodeLayout.LOBATTO, 6), (NodeLayout.LOBATTO, 7), (NodeLayout.VERTICES, 8)),
    True: ((NodeLayout.LOBATTO, 3), (NodeLayout.LOBATTO, 4), (NodeLayout.VERTICES, 5)),
}

MORE_LOCKS = (7, 9, 12, 15)  # of the worst joints of elastic blocks, too slow to be searched
MORE = "safe_over_first_failure_{}_locks"
HEAD = [
    *("space", "joints", "answered", "not solved"),
    *("safe / first failure", "safe / peak, on other nodes"),
]


@dataclass(frozen=True)
class Space:
    """Joints that are held down in one way, with elastic or rigid blocks."""

    name: str
    hold: Hold
    elastic: bool = False
    body: UpperBody | None = None  # None: columns or one piece
    locks: tuple[int, int] = (2, 31)
    share: float = 1.0  # of the evaluations: elastic blocks take a hundred times as long


SPACES = (
    Space("plate", Hold.PLATE),
    Space("pressure", Hold.PRESSURE),
    Space("force", Hold.FORCE),
    Space("weight", Hold.WEIGHT),
    Space("elastic columns", Hold.PLATE, True, UpperBody.COLUMNS, (2, 5), 0.06),
    Space("elastic one piece", Hold.PLATE, True, UpperBody.MONOLITHIC, (2, 5), 0.06),
    Space("elastic, pressure", Hold.PRESSURE, True, None, (2, 5), 0.06),
)


@dataclass(frozen=True)
class Target:
    """A joint, loaded in a direction from one of its sides."""

    joint: Joint
    loading: Loading


def target_at(space: Space, place: Sequence[float]) -> Target:
    """The joint of ``space`` at a ``place`` in the unit cube of `DIMENSIONS` dimensions."""
    turn = iter(map(float, place))

    def ratio(name: str) -> float:
        low, high = SPANS[name]
        return _between(max(low, LEAST), min(high, STIFFEST), next(turn))

    def some(share: float, name: str) -> float:
        """A ratio, which is 0 for a ``share`` of the joints."""
        at = next(turn)
        low, high = SPANS[name]
        return 0.0 if at < share else _between(max(low, LEAST), high, (at - share) / (1.0 - share))

    least, most = space.locks
    locks = min(int(least * ((most + 1) / least) ** next(turn)), most)
    a, h, height = (WIDTH * ratio(f"{name} / b") for name in "ahH")
    shear = KN * ratio("shear over normal stiffness of inner faces")
    dry = KN * ratio("normal stiffness of dry over inner faces")
    slip = dry * ratio("shear over normal stiffness of dry faces")
    at = next(turn)
    friction = max(at - SMOOTH, 0.0) / (1.0 - SMOOTH) * SPANS["friction"][1]
    tension = COHESION * ratio("tensile strength over cohesion")
    weight = some(LIGHT, "weight of the upper block per area over cohesion")
    pressure = COHESION * ratio("force on top per area over cohesion")
    young = KN * WIDTH * ratio("E / (Kn b)")
    poisson = SPANS["Poisson's ratio"][1] * next(turn)
    body = space.body or (UpperBody.COLUMNS if next(turn) < 0.5 else UpperBody.MONOLITHIC)
    push = Push.PLUS_Y if next(turn) < 0.5 else Push.MINUS_Y
    first = Side.UPPER if next(turn) < 0.5 else Side.LOWER
    angle = math.pi * (next(turn) - 0.5)  # in the (V, M / a) plane, from torque to torque
    hold_down = {
        Hold.PRESSURE: HoldDown.pressure(pressure),
        Hold.FORCE: HoldDown.force(pressure * a * locks * WIDTH),
    }
    joint = Joint(
        locks,
        *(a, WIDTH, h, height),
        density=weight * COHESION / (GRAVITY * (h + height)),
        inner=FaceMaterial(KN, shear, 0.0, COHESION, tension),
        dry=FaceMaterial(dry, slip, friction, 0.0, 0.0),
        upper_body=body,
        first=first,
        hold_down=hold_down.get(space.hold) or HoldDown(space.hold),
        elastic=Elastic(young, poisson) if space.elastic else None,
    )
    return Target(joint, Loading(Direction(math.tan(angle)), push=push))


def _between(low: float, high: float, place: float) -> float:
    return float(low * (high / low) ** place)


def safe_load(target: Target) -> float | None:
    """The safe rule's load (N); None where it refuses."""
    try:
        return safe(target.joint, target.loading.direction, target.loading.push).load
    except (CapacityError, ValueError):
        return None


def ratio_at(space: Space, place: Sequence[float]) -> float | None:
    """`ratio_of` the joint of ``space`` at a ``place``; 0 for elastic blocks of `MOST_NODES`."""
    target = target_at(space, place)
    if space.elastic and len(_posed(target).assembly.nodes.area) > MOST_NODES:
        return 0.0
    return ratio_of(target)


def _posed(target: Target) -> Problem:
    """The problem on the nodes of the search, which the rule does not use."""
    joint = target.joint
    cells = CELLS[joint.elastic is not None]
    least = cells // 2 + 1 if joint.hold_down.kind is Hold.PLATE else None
    return posed(joint, target.loading, joint.least_side / cells, least=least)


def ratio_of(target: Target) -> float | None:
    """Safe load over first failure: 0 where the rule refuses, inf where nothing is carried.

    None where the static model has no answer on its nodes.
    """
    promised = safe_load(target)
    if promised is None:
        return 0.0
    try:
        load = static_first_failure(*_posed(target)).point.load
    except CapacityError:
        return None
    return promised / load if load > 0.0 else math.inf


def search(space: Space, seed: int, evaluations: int) -> dict[str, Any]:
    """Differential evolution over ``space`` from one start: its share of the ``evaluations``.

    Returns the row of the table: ``answered``: joints with a ratio; ``unsolved``: joints that the
    safe rule answers and the static model, on its finer nodes, does not; the largest ratio of safe
    load to first failure, its joint, and the loads (N) of that on other nodes.
    """
    tried: list[tuple[float | None, tuple[float, ...]]] = []

    def objective(place: Iterable[float]) -> float:
        values = tuple(map(float, place))
        tried.append((ratio_at(space, values), values))
        return -min(tried[-1][0] or 0.0, 1e9)

    size = POPULATION * DIMENSIONS
    differential_evolution(
        objective,
        [(0.0, 1.0)] * DIMENSIONS,
        popsize=POPULATION,
        maxiter=max(1, round(space.share * evaluations / size) - 1),
        init="sobol",
        mutation=(0.4, 1.0),
        recombination=0.8,
        tol=0.0,
        polish=False,
        rng=np.random.default_rng([seed, SPACES.index(space)]),  # a separate one for each space
    )
    # The worst joint on the limits of the ranges, one after the other, where it gets worse.
    for dimension, end in itertools.product(range(DIMENSIONS), (0.0, 1.0)):
        _, worst = max(tried, key=_ratio)
        objective([*worst[:dimension], end, *worst[dimension + 1 :]])
    ratio, place = max(tried, key=_ratio)
    target = target_at(space, place)
    promised = safe_load(target) or math.nan
    row: dict[str, Any] = {
        "space": space.name,
        "seed": seed,
        "evaluations": len(tried),
        "answered": sum(found is not None and found > 0.0 for found, _ in tried),
        "unsolved": sum(found is None for found, _ in tried),
        "safe_over_first_failure": ratio,
        "safe_N": promised,
    }
    for number, (layout, cells) in enumerate(CHECKS[space.elastic], start=1):
        row[f"nodes_{number}"] = f"{layout}, {cells} cells"
        mesh = target.joint.least_side / cells
        try:
            path = lowest_peak(*posed(target.joint, target.loading, mesh, layout))
        except CapacityError as error:
            row[f"error_{number}"] = str(error)
            continue
        peak = path.peak.load
        row[f"first_failure_{number}_N"], row[f"peak_{number}_N"] = path.first_failure_load, peak
        row[f"safe_over_peak_{number}"] = promised / peak if peak else math.inf
    return {
        **row,
        **(with_more_locks(target) if space.elastic else {}),
        "eccentricity_over_a": target.loading.direction.eccentricity,
        "push": str(target.loading.push),
        "joint": repr(target.joint),
    }


def _ratio(found: tuple[float | None, object]) -> float:
    return found[0] or 0.0


def with_more_locks(target: Target) -> dict[str, float | None]:
    """`ratio_of` the same joint with each of `MORE_LOCKS`."""
    longer = {n: replace(target.joint, locks=n) for n in MORE_LOCKS}
    return {MORE.format(n): ratio_of(Target(joint, target.loading)) for n, joint in longer.items()}


def main(arguments: Sequence[str] | None = None) -> int:
    """Attack all spaces, write the table, and fail if a safe load is above the first failure."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--evaluations", type=int, default=1800, help="of each start")
    parser.add_argument("--seeds", type=int, default=3, help="starts in each space")
    names = [space.name for space in SPACES]
    parser.add_argument("--spaces", nargs="+", choices=names, default=names)
    parser.add_argument("--table", type=Path, default=Path("results-attack/tables/attack.csv"))
    parser.add_argument("--processes", type=int, default=2)
    given = parser.parse_args(arguments)
    given.table.parent.mkdir(parents=True, exist_ok=True)
    spaces = [space for space in SPACES if space.name in given.spaces]
    rows: list[dict[str, Any]] = []
    with ProcessPoolExecutor(given.processes) as pool:
        starts = [
            pool.submit(search, space, seed, given.evaluations)
            for seed in range(1, given.seeds + 1)
            for space in spaces
        ]
        for start in starts:
            rows.append(start.result())
            table = pd.DataFrame(rows)
            table.to_csv(given.table, index=False)  # after each start: a later one may fail
            print(
                "{space}, seed {seed}: {evaluations} joints, {answered} answered, largest ratio "
                "{safe_over_first_failure:.4f}".format_map(rows[-1]),
                flush=True,
            )
    worst, total = table["safe_over_first_failure"].max(), table["evaluations"].sum()
    print(f"{total} joints; largest safe load over first failure {worst:.4f}; {given.table}")
    return 0 if worst <= 1.0 else 1


def worst(results: Path, *, elastic: bool) -> str:
    """A row for each space of ``elastic`` or of rigid blocks: the worst of all starts.

    FileNotFoundError if the table has none of these spaces.
    """
    path = results / "tables/attack.csv"
    table = pd.read_csv(path)
    names = [space.name for space in SPACES if space.elastic is elastic]
    table = table[table["space"].isin(names)]
    if table.empty:
        raise FileNotFoundError(None, None, f"the attack on these blocks in {path}")
    rows = []
    for space, group in table.groupby("space", sort=False):
        peaks = group.filter(regex=r"^safe_over_peak_\d+$").max(numeric_only=True)
        longer = group[[MORE.format(n) for n in MORE_LOCKS]].max() if elastic else []
        rows.append(
            [
                str(space),
                f"{group['evaluations'].sum():,}",
                f"{group['answered'].sum():,}",
                f"{group['unsolved'].sum():,}",
                f"{group['safe_over_first_failure'].max():.3f}",
                ", ".join(f"{value:.3f}" for value in peaks),
                *(f"{value:.3f}" for value in longer),
            ]
        )
    more = [f"{number} locks" for number in MORE_LOCKS] if elastic else []
    return markdown([*HEAD, *more], rows)


BLOCKS: dict[str, Callable[[Path], str]] = {
    "attack": partial(worst, elastic=False),
    "attack-elastic": partial(worst, elastic=True),
}


if __name__ == "__main__":
    sys.exit(main())

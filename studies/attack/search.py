"""Look for the joint whose safe load is most above what it carries: ``make attack``.

In each space (what holds the joint down, and whether its blocks bend) differential evolution varies
everything that a `Joint` can be inside the rule's `SPANS`, and the direction of the load, to make
safe load over first failure as large as it can. The first failure is the static model's on nodes
that the rule did not see; the peak is never below it. The worst joint of each start is then solved
on two meshes and with two layouts of the nodes, down to the peak.
"""

import argparse
import csv
import math
import sys
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.optimize import differential_evolution

from sidmacib.chain.rule import SPANS, safe
from sidmacib.errors import CapacityError
from sidmacib.hold_down import Hold, HoldDown
from sidmacib.joint import Block, Direction, Joint, UpperBody
from sidmacib.load_path import load_path
from sidmacib.loading import Loading, Push, lateral_load
from sidmacib.mechanics.assembly import GRAVITY, Elastic, FaceMaterial, NodeLayout
from sidmacib.mechanics.static import static_first_failure
from sidmacib.pieces import assemble

WIDTH, KN, COHESION = 0.05, 1e10, 8e4  # b (m), Kn (Pa/m), Pa: what all ratios are to
LEAST = 1e-4  # of ratios that may be 0: spread evenly in their logarithm from here on
STIFFEST = 5e3  # E over Kn b of blocks that bend: stiffer ones are rigid
SMOOTH, LIGHT = 0.2, 0.2  # parts of the joints without friction, without weight
DIMENSIONS = 17
POPULATION = 6  # joints of a generation, over the dimensions
CELLS = {False: 5, True: 2}  # of the search, along a lock's shorter side; True: blocks that bend
CHECKS = {  # of the worst joints
    False: ((NodeLayout.LOBATTO, 6), (NodeLayout.LOBATTO, 7), (NodeLayout.VERTICES, 8)),
    True: ((NodeLayout.LOBATTO, 2), (NodeLayout.LOBATTO, 3), (NodeLayout.VERTICES, 4)),
}


@dataclass(frozen=True)
class Space:
    """Joints that are held down in one way; of blocks that bend, or rigid ones."""

    name: str
    hold: Hold
    elastic: bool = False
    body: UpperBody | None = None  # None: columns or one piece
    locks: tuple[int, int] = (2, 31)
    share: float = 1.0  # of the evaluations: blocks that bend take a hundred times as long


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
    first = Block.UPPER if next(turn) < 0.5 else Block.LOWER
    angle = math.pi * (next(turn) - 0.5)  # in the (V, M / a) plane, from torque to torque
    joint = Joint(
        locks,
        *(a, WIDTH, h, height),
        density=weight * COHESION / (GRAVITY * (h + height)),
        inner=FaceMaterial(KN, shear, 0.0, COHESION, tension),
        dry=FaceMaterial(dry, slip, friction, 0.0, 0.0),
        upper_body=body,
        first=first,
        hold_down=_hold_down(space.hold, pressure, a * locks * WIDTH),
        elastic=Elastic(young, poisson) if space.elastic else None,
    )
    return Target(joint, Loading(Direction(math.tan(angle)), push=push))


def _between(low: float, high: float, place: float) -> float:
    return float(low * (high / low) ** place)


def _hold_down(hold: Hold, pressure: float, area: float) -> HoldDown:
    if hold is Hold.PRESSURE:
        return HoldDown.pressure(pressure)
    return HoldDown.force(pressure * area) if hold is Hold.FORCE else HoldDown(hold)


def safe_load(target: Target) -> float | None:
    """The safe rule's load (N); None where it refuses."""
    try:
        return safe(target.joint, target.loading.direction, target.loading.push).load
    except (CapacityError, ValueError):
        return None


def ratio_at(space: Space, place: Sequence[float]) -> float | None:
    """Safe load over first failure: 0 where the rule refuses, inf where nothing is carried.

    None where the static model has no answer on its nodes.
    """
    target = target_at(space, place)
    promised = safe_load(target)
    if promised is None:
        return 0.0
    joint = target.joint
    assembly = assemble(joint, joint.least_side / CELLS[space.elastic])
    try:
        loads = lateral_load(joint, assembly, target.loading)
        found = static_first_failure(assembly, loads)
    except CapacityError:
        return None
    return promised / found.point.load if found.point.load > 0.0 else math.inf


@dataclass(frozen=True)
class Worst:
    """The joint of one start with the largest ratio of safe load to first failure.

    ``answered``: joints for which there is a ratio; ``unsolved``: those that the safe rule answers
    and the static model, on its finer nodes, does not.
    """

    space: Space
    seed: int
    evaluations: int
    answered: int
    unsolved: int
    ratio: float
    place: tuple[float, ...]


@dataclass
class _Search:
    """What differential evolution minimises, and a count of what it looked at."""

    space: Space
    evaluations: int = 0
    answered: int = 0
    unsolved: int = 0
    best: float = 0.0
    place: tuple[float, ...] = ()

    def __call__(self, place: Iterable[float]) -> float:
        values = tuple(map(float, place))
        found = ratio_at(self.space, values)
        self.evaluations += 1
        if found is None:
            self.unsolved += 1
            return 0.0
        self.answered += found > 0.0
        if found > self.best:
            self.best, self.place = found, values
        return -min(found, 1e9)


def search(space: Space, seed: int, evaluations: int) -> Worst:
    """Differential evolution over ``space`` from one start: its share of the ``evaluations``."""
    own = _Search(space)
    size = POPULATION * DIMENSIONS
    rounds = max(1, round(space.share * evaluations / size) - 1)
    differential_evolution(
        own,
        [(0.0, 1.0)] * DIMENSIONS,
        popsize=POPULATION,
        maxiter=rounds,
        init="sobol",
        mutation=(0.4, 1.0),
        recombination=0.8,
        tol=0.0,
        polish=False,
        rng=np.random.default_rng([seed, SPACES.index(space)]),  # else spaces look at like joints
    )
    return Worst(space, seed, own.evaluations, own.answered, own.unsolved, own.best, own.place)


def row_of(worst: Worst) -> dict[str, object]:
    """The worst joint of a start, with its loads (N) on other nodes."""
    target = target_at(worst.space, worst.place)
    joint, direction = target.joint, target.loading.direction
    promised = safe_load(target) or math.nan
    row: dict[str, object] = {
        "space": worst.space.name,
        "seed": worst.seed,
        "evaluations": worst.evaluations,
        "answered": worst.answered,
        "unsolved": worst.unsolved,
        "safe_over_first_failure": worst.ratio,
        "safe_N": promised,
    }
    for number, (layout, cells) in enumerate(CHECKS[worst.space.elastic], start=1):
        row |= _checked(target, promised, number, layout, cells)
    row |= {"eccentricity_over_a": direction.eccentricity, "push": str(target.loading.push)}
    return row | {"joint": repr(joint)}


def _checked(
    target: Target, promised: float, number: int, layout: NodeLayout, cells: int
) -> dict[str, object]:
    """First failure and peak on other nodes; the reason if there is none."""
    row: dict[str, object] = {f"nodes_{number}": f"{layout}, {cells} cells"}
    try:
        _, found = load_path(target.joint, target.loading, target.joint.least_side / cells, layout)
    except CapacityError as error:
        return row | {f"error_{number}": str(error)}
    return row | {
        f"first_failure_{number}_N": found.first_failure_load,
        f"peak_{number}_N": found.peak.load,
        f"safe_over_peak_{number}": promised / found.peak.load if found.peak.load else math.inf,
    }


def starts(evaluations: int, seeds: int, spaces: Sequence[Space]) -> Iterator[tuple[Space, int]]:
    """Each space from each seed."""
    for seed in range(1, seeds + 1):
        for space in spaces:
            yield space, seed


def _one(space: Space, seed: int, evaluations: int) -> dict[str, object]:
    return row_of(search(space, seed, evaluations))


def main(arguments: Sequence[str] | None = None) -> int:
    """Attack all spaces, write the table, and fail if a safe load is above the first failure."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--evaluations", type=int, default=1800, help="of each start")
    parser.add_argument("--seeds", type=int, default=3, help="starts in each space")
    parser.add_argument("--spaces", nargs="*", default=[space.name for space in SPACES])
    parser.add_argument("--table", type=Path, default=Path("results-attack/tables/attack.csv"))
    parser.add_argument("--processes", type=int, default=2)
    given = parser.parse_args(arguments)
    spaces = [space for space in SPACES if space.name in given.spaces]
    rows: list[dict[str, object]] = []
    with ProcessPoolExecutor(given.processes) as pool:
        jobs = [
            pool.submit(_one, space, seed, given.evaluations)
            for space, seed in starts(given.evaluations, given.seeds, spaces)
        ]
        for job in jobs:
            rows.append(job.result())
            write(rows, given.table)  # what is known so far, whatever comes
            last = rows[-1]
            print(
                f"{last['space']}, seed {last['seed']}: {last['evaluations']} joints, "
                f"{last['answered']} answered, largest ratio {last['safe_over_first_failure']:.4f}",
                flush=True,
            )
    worst = max(float(str(row["safe_over_first_failure"])) for row in rows)
    total = sum(int(str(row["evaluations"])) for row in rows)
    print(f"{total} joints; largest safe load over first failure {worst:.4f}; {given.table}")
    return 0 if worst <= 1.0 else 1


def write(rows: Sequence[dict[str, object]], path: Path) -> None:
    """Write the ``rows`` as CSV; those of blocks that bend were checked on nodes of their own."""
    names = list(dict.fromkeys(name for row in rows for name in row))
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, names)
        table.writeheader()
        table.writerows(rows)


if __name__ == "__main__":
    sys.exit(main())

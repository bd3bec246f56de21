"""Search for the peak of a model that breaks by itself: by ever smaller increments of the load."""

from collections.abc import Sequence
from typing import Protocol

from .assembly import Search
from .records import NodeForce, Outcome, Peak, failure_mode

GROWTH = 1.5  # of the increment while the load is carried
LEAST_INCREMENT = 1e-9  # over the first: less is no load
LARGEST_LOAD = 1e6  # over the first increment
STEPS = 10  # to a load that is known


class Model(Protocol):
    """A model that the search raises the load on."""

    breakable: bool  # whether bonds are lost at their strength

    def raised(self, start: float, end: float, permanent: tuple[float, float]) -> Outcome:
        """Raise load (N) and share of the permanent loads, and wait for what becomes of it."""

    def broken(self) -> int:
        """Number of nodes whose bond has broken."""

    def displacement(self) -> float:
        """The displacement that the load works on, in m."""

    def node_forces(self) -> Sequence[NodeForce]:
        """Forces of all nodes, in their order."""

    def check_flat(self, load: float) -> None:
        """End with a reason where its contacts no longer stand for flat faces."""

    def keep(self) -> None:
        """Keep the present state."""

    def go_back(self) -> None:
        """Return to the state that was kept last."""


def peak_by_increments(model: Model, search: Search) -> Peak:
    """The largest load that ``model`` carries.

    The increment grows until the assembly fails. From then on every failure is taken back to the
    last equilibrium and halves the increment, so that the last one, which decides, is small and
    slow. The first node that fails is looked for in the same way, before the load goes on. Exits
    with a reason where the last failure is none: no bond breaks, and the pieces neither move off
    nor come to rest.
    """
    if model.raised(0.0, 0.0, (0.0, 1.0)) is not Outcome.EQUILIBRIUM:
        raise SystemExit("the assembly does not stand under its permanent loads")
    load, increment, growth = 0.0, search.first_increment_N, GROWTH
    first_failure = 0.0 if model.breakable and model.broken() else None
    while True:
        model.keep()
        nodes, broken = model.node_forces(), model.broken()
        while True:
            outcome = model.raised(load, load + increment, (1.0, 1.0))
            standing = outcome is Outcome.EQUILIBRIUM
            breaks = model.breakable and model.broken() > broken
            first = standing and breaks and first_failure is None
            # The first node may fail at a load that is next to none.
            least = max(load, search.first_increment_N) if first else load
            near = increment <= search.tolerance * least
            if first and near:
                first_failure = load + increment
            if standing and (near or not first):
                break
            print(f"{load + increment:12.4f} N {'breaks' if first else 'fails'}", flush=True)
            if near:
                mode = failure_mode(outcome, breaks, load + increment)
                if first_failure is None and breaks:
                    first_failure = load
                return Peak(load, load + increment, first_failure, mode, nodes)
            if increment < LEAST_INCREMENT * search.first_increment_N:
                raise SystemExit("the assembly carries no load in this direction")
            increment, growth = increment / 2, 1.0
            model.go_back()
        if first:
            growth = GROWTH  # the first failure is found: on to the peak
        load += increment
        model.check_flat(load)
        print(f"{load:12.4f} N stands", flush=True)
        if load > LARGEST_LOAD * search.first_increment_N:
            raise SystemExit("the load grows without a peak")
        increment *= growth


def displacements_towards(model: Model, load: float) -> list[float]:
    """Displacements (m) of a new ``model`` at equilibria on the way to ``load`` (N).

    `STEPS` of them, in equal steps of the load, or fewer where it does not come to equilibrium.
    """
    found: list[float] = []
    outcome = model.raised(0.0, 0.0, (0.0, 1.0))
    for step in range(STEPS):
        if outcome is Outcome.EQUILIBRIUM:
            outcome = model.raised(load * step / STEPS, load * (step + 1) / STEPS, (1.0, 1.0))
        if outcome is Outcome.EQUILIBRIUM:
            found.append(model.displacement())
    return found

"""The explorer's answer to a structure, an example or a file: what the command says and draws."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

from analysis.explore.comparison import Figure
from analysis.explore.examples import STRUCTURE_MODELS, Chosen
from sidmacib.answers.structure import StaticAnswer
from sidmacib.command.answers import Row
from sidmacib.command.assembly import demanded_rows
from sidmacib.command.structure_views import Views
from sidmacib.command.structures import limit_of, static_of, structure_notes
from sidmacib.errors import CapacityError
from sidmacib.mechanics.limit import LimitState
from sidmacib.scene.forces import arrows_of
from sidmacib.structure.files.structure_file import Demand, demands_of

KEPT = 64  # structures that are not computed again


@dataclass(frozen=True, eq=False)
class StructureAnswer:
    """What the command says of a structure: its views, its table, and which load counts."""

    description: Any
    views: Views
    rows: Sequence[Row]
    counts: str | None

    @classmethod
    def of(
        cls,
        path: Path,
        description: Any,
        demand: Demand,
        limit: LimitState | CapacityError | None,
        static: StaticAnswer | CapacityError,
        more_notes: Sequence[str] = (),
    ) -> "StructureAnswer":
        """From what the models answer; ``path``: of the file that the ``description`` is from.

        ``more_notes``: beside those of the command.
        """
        problem = demand.problem
        rows, found = demanded_rows(demand, limit, static)
        notes = [*more_notes, *structure_notes(problem, description)]
        verdict = "" if found is None else str(found)
        views = Views.of(path, description, problem, limit, static, notes, verdict)
        counts = static.counts.name if isinstance(static, StaticAnswer) else None
        return cls(description, views, rows, counts)

    @property
    def told(self) -> dict[str, Figure]:
        """The description, for a comparison."""
        return dict(_leaves(self.description))

    @property
    def carried(self) -> dict[str, Figure]:
        """The loads of each model, for a comparison."""
        told: dict[str, Figure] = {"load that counts": self.counts}
        for row in self.rows:
            told |= {
                f"{row['model']}: {name}": each
                for name, each in row.items()
                if isinstance(each, float) and not name.startswith("mesh error")
            }
        return told


def _leaves(value: Any, name: str = "") -> Iterator[tuple[str, Figure]]:
    """The values of a description by their keys; a list in a line."""
    if isinstance(value, Mapping):
        for key, each in value.items():
            yield from _leaves(each, f"{name}.{key}" if name else str(key))
    elif isinstance(value, int | float) and not isinstance(value, bool):
        yield name, float(value)
    else:
        yield name, str(value)


@lru_cache(maxsize=KEPT)
def demand(chosen: Chosen) -> Demand:
    """An example and its load."""
    return demands_of(chosen.description, chosen.path.parent)[0]


@lru_cache(maxsize=KEPT)
def limit(chosen: Chosen) -> LimitState | CapacityError | None:
    """Limit analysis of an example, on the cells of its file."""
    return limit_of(demand(chosen).problem)


@lru_cache(maxsize=KEPT)
def static(chosen: Chosen) -> StaticAnswer | CapacityError:
    """The static model of an example, as `multilock assembly` has it."""
    return static_of(demand(chosen).problem, limit(chosen))


@lru_cache(maxsize=KEPT)
def answered(chosen: Chosen) -> StructureAnswer:
    """What the command says of an example."""
    parts = demand(chosen), limit(chosen), static(chosen)
    return StructureAnswer.of(chosen.path, chosen.description, *parts)


STAGES = (limit, static, answered)  # what an answer needs, in this order


def structure_answer(chosen: Chosen) -> dict[str, Any]:
    """Content of the page: the command's table, and what is drawn of the model that is chosen."""
    found = answered(same(chosen))
    (drawn,) = (each for each in found.views.models if each.model == chosen.model)
    values = drawn.values()
    return {
        **values,
        "row": {**values["row"], "structure": chosen.example},
        "words": found.views.answer,
        "head": [*found.rows[0]],
        "rows": [[*row.values()] for row in found.rows],
        "shape": found.views.shape,
        "loads": arrows_of(*found.views.problem),
        "yaml": chosen.text,
    }


def same(chosen: Chosen) -> Chosen:
    """The structure whatever is drawn of it: what results are kept by."""
    return replace(chosen, model=STRUCTURE_MODELS[0])

"""The explorer's answer to a structure, an example or a file: what the command says and draws.

The answer to a file that is opened is the page that `multilock assembly --report` writes.
"""

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import yaml
from pydantic import Base64Bytes, BaseModel
from werkzeug.exceptions import NotFound

from analysis.explore.examples import STRUCTURE_MODELS, Chosen
from analysis.explore.numbers import numbers_of, put_numbers
from analysis.explore.state import Figure
from sidmacib.answers.ask import Solved, limit_of, static_of
from sidmacib.answers.said import Static
from sidmacib.answers.structure import Limit
from sidmacib.answers.structure_paths import StaticAnswer
from sidmacib.command.answers import Row
from sidmacib.command.cases import case_rows
from sidmacib.command.structure_views import Views
from sidmacib.command.structures import structure_rows
from sidmacib.scene.forces import arrows_of
from sidmacib.scene.page import page
from sidmacib.structure.files.structure_file import (
    OF_BLOCKS,
    Demand,
    demands_of,
    description_in,
    notes_on,
)
from sidmacib.structure.loads import SupportMotion
from sidmacib.validation import refused
from sidmacib.yaml_text import read_yaml

KEPT = 64  # examples that are not computed again
YAML = (".yaml", ".yml")
READ = *YAML, *OF_BLOCKS
OPENED = "/opened"
FORGOTTEN = "This file is no longer in memory; open it again at /structures."
MOST_FILES = 24  # that are remembered
HERE = Path(__file__).parent
TEMPLATE, SCRIPT = HERE / "opened.html.j2", HERE / "server.js"


@dataclass(frozen=True, eq=False)
class StructureAnswer:
    """What the command says of a structure: its views, its table, and which load counts."""

    description: Any
    views: Views
    rows: Sequence[Row]
    counts: str | None

    @classmethod
    def of(
        cls, path: Path, description: Any, solved: Solved, more_notes: Sequence[str] = ()
    ) -> "StructureAnswer":
        """From what the models answer; ``path``: of the file that the ``description`` is from.

        ``more_notes``: beside those of the command.
        """
        demand, static = solved.demand, solved.static
        notes = [*more_notes, *notes_on(description, demand.problem.assembly)]
        views = Views.of(path, description, solved, notes, str(solved.verdict or ""))
        counts = static.counts.name if isinstance(static, StaticAnswer) else None
        return cls(description, views, structure_rows(solved), counts)

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


@lru_cache(maxsize=KEPT)
def demand(chosen: Chosen) -> Demand:
    """An example and its load."""
    return demands_of(chosen.description, chosen.path.parent)[0]


@lru_cache(maxsize=KEPT)
def limit(chosen: Chosen) -> Limit:
    """Limit analysis of an example, on the cells of its file."""
    return limit_of(demand(chosen).problem)


@lru_cache(maxsize=KEPT)
def static(chosen: Chosen) -> Static:
    """The static model of an example, as `multilock assembly` has it."""
    return static_of(demand(chosen).problem, limit(chosen))


@lru_cache(maxsize=KEPT)
def answered(chosen: Chosen) -> StructureAnswer:
    """What the command says of an example."""
    solved = Solved(demand(chosen), limit(chosen), static(chosen))
    return StructureAnswer.of(chosen.path, chosen.description, solved)


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


class SentFile(BaseModel):
    """A file as the page sends it."""

    name: str
    data: Base64Bytes


class Sent(BaseModel):
    """What a page sends: ``files``, or ``numbers`` by name that change the file ``of``, if any."""

    files: list[SentFile] = []
    of: int = 0
    numbers: dict[str, float] = {}


class OpenedFiles:
    """The structures that were sent last, by number."""

    def __init__(self) -> None:
        self._found: dict[str, OpenedFile] = {}
        self._newest = 0

    def opened(self, sent: Sent) -> str:
        """The address of the page of what is ``sent``.

        Errors of the models; ValueError for files of something else.
        """
        if sent.of:
            if (of := str(sent.of)) not in self._found:
                raise ValueError(FORGOTTEN)
            self._found[of] = self._found.pop(of)  # to the end
            found = opened_file(self._found[of].files, sent.numbers)
        else:
            found = opened_file(sent.files)
        self._newest += 1
        self._found[str(self._newest)] = found
        while len(self._found) > MOST_FILES:
            self._found.pop(next(iter(self._found)))
        return f"{OPENED}?file={self._newest}"

    def page(self, query: Mapping[str, str]) -> str:
        """The page of a file; `NotFound` if it is not remembered."""
        number = query.get("file", "")
        if number not in self._found:
            raise NotFound(FORGOTTEN)
        return self._found[number].page({"number": number, "server": SCRIPT.read_text()})


class OpenedFile(NamedTuple):
    """A structure that was sent: its name for the command, what that says, and its ``files``."""

    name: str
    answer: StructureAnswer
    files: Sequence[SentFile]

    def page(self, words: Mapping[str, Any]) -> str:
        """The command's page; ``words``: those that it has beyond the command's."""
        here = self.answer
        data, own = here.views.content(here.rows, f"multilock assembly {self.name}")
        numbers = [(each, *each.slider) for each in numbers_of(here.description)]
        text = yaml.safe_dump(here.description, sort_keys=False, default_flow_style=None)
        return page(
            data, {**own, **words, "numbers": numbers, "yaml": text, "kinds": READ}, TEMPLATE
        )


def opened_file(
    files: Sequence[SentFile], numbers: Mapping[str, float] | None = None
) -> OpenedFile:
    """The structure in ``files``, with ``numbers`` by name in place of its own.

    A YAML file with blocks counts, which may name the others; if there is none, a file of blocks,
    to which a YAML file of the same name says what it lacks. Errors of the models; ValueError for
    files of something else, and for several structures.
    """
    with TemporaryDirectory() as folder:
        paths = [_written(each, Path(folder)) for each in files]
        if not paths:
            raise ValueError("no file was sent")
        found = _with_blocks(paths)
        if len(found) > 1:
            names = ", ".join(path.name for path in found)
            raise ValueError(f"{names}: are {len(found)} structures; open them one by one")
        return OpenedFile(*_solved(found[0], numbers or {}), files)


def _solved(path: Path, numbers: Mapping[str, float]) -> tuple[str, StructureAnswer]:
    """The name for the command, and what it says of the file with these ``numbers``."""
    description = description_in(path)
    told = put_numbers(description, numbers)
    demands = demands_of(description, path.parent)
    demand, name, notes = demands[0], path.name, [f"changed here: {', '.join(told)}"] * bool(told)
    if not demand.raises:
        raise ValueError(
            "load: missing; give one, such as load: {acceleration: [1, 0, 0]}, or look at the "
            "reserve without a load with multilock assembly FILE --report page.html"
        )
    if isinstance(demand.problem.loads, SupportMotion):
        raise ValueError(
            "load.support: is for multilock assembly and studies; use another load here"
        )
    if demand.case is None:
        solved = Solved.of(demand)
    else:
        _, words, solved = case_rows(demands)
        name = f"{path.name} --case {shlex.quote(str(solved.demand.case))}"
        notes.append(f"{words}.")
    return name, StructureAnswer.of(path, description, solved, notes)


def _written(file: SentFile, folder: Path) -> Path:
    path = folder / Path(file.name).name
    try:
        if path == folder or path.name.startswith("."):
            raise OSError
        path.write_bytes(file.data)
    except OSError as error:
        why = f" ({error.strerror})" if error.strerror else ""
        raise refused("file", file.name, f"the name of a file{why}") from None
    return path


def _with_blocks(paths: Sequence[Path]) -> list[Path]:
    """The files that have the blocks."""
    lists = [path for path in paths if path.suffix.lower() in YAML]
    with_blocks = [
        path for path in lists if isinstance(given := read_yaml(path), dict) and "blocks" in given
    ]
    others = [path for path in paths if path not in lists]
    return with_blocks or others or lists[:1]

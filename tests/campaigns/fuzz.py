"""Whatever comes in: a valid study, record or answer, or one line that says what is wrong with it.

    make fuzz FUZZ=100000

Configurations, names of cases, files that engines and 3DEC return and words of the command are made
from valid ones, by changes at random. A reader may refuse them with its error class,
of few lines; nothing else. What was tried is counted by kind in build/fuzz.csv.
"""

import json
import math
import random
import tempfile
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import chdir, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml
from campaigns.counts import ROOT, asked, write_counts
from click.testing import CliRunner
from test_compas import assembly, model
from test_record import case_of, returned, write_engine_files

from sidmacib.command.main import main as command
from sidmacib.engines.results import read_outcome
from sidmacib.engines.scripts.records import HISTORY, NODES, RESULT
from sidmacib.errors import ResultError
from sidmacib.problem import Outcome, Problem
from sidmacib.structure.files.compas import read_compas, read_compas_interfaces
from workflow.case import JointCase
from workflow.cases import case_count, cases_of, find_case
from workflow.configuration import ConfigError, read_study, read_study_file
from workflow.results import record_of
from workflow.results.joint_part import JointRecord
from workflow.threedec import read_returned

PUBLISHED: dict[str, Any] = yaml.safe_load((ROOT / "config.yaml").read_text())
SMALL = """samples: {n3: {locks: 3}, wide: {locks: 5, a: 0.09, dry: {friction: 0.1}}}
geometry: {a: 0.06, h: 0.01}
materials: {density: 1400, inner: {cohesion: 8.0e+4, tensile_strength: 3.7e+5}}
meshes: [0.02, 0.01]
eccentricities: [0, 0.5, torsion]
models: [static, limit]
assembly: {hold_down: {force: 100}, push: "-y"}
dem: {engines: [yade], time_limit: 60, numerics: {tolerance: 0.002, guided: false}}
variants: {slow: {numerics: {ramp_periods: 80}, meshes: [0.02]}}
"""
FEW = 200  # cases, of a study that is built out
MOST_LINES, MOST_LETTERS = 21, 500
VALUES: tuple[Any, ...] = (
    *(None, True, False, 0, -1, 3, 10**400, 1e308, 5e-324, math.inf, -math.inf, math.nan, 0.02),
    *("", " ", "torsion", "static", "yade", "0.02", "../x", "n3", "é\u202e", "\0", "x" * 900),
    *([], {}, [[]], [None], {"a": {}}, [0.02, 0.02], {"": 1}, {"force": -1}),
)
AMOUNTS = ("0", "-1", "0.06", "3", "1e-300", "1e308", "nan", "torsion", "weight", "force:0")
LETTERS = "0123456789.e+-:,[]{}&*!#|>%@\"' \n\tnaif\0é\u202e"


class BrokenError(AssertionError):
    """Something else came out than an answer or one line; the message says what, after what."""


@dataclass
class Fuzz:
    """What inputs are made from, and what came of them: accepted and refused, by kind."""

    folder: Path
    random: random.Random
    case: JointCase
    engine_files: dict[str, str]
    printed: str
    accepted: Counter[str] = field(default_factory=Counter)
    refused: Counter[str] = field(default_factory=Counter)

    def holds(self, kind: str, read: Callable[[], object], *errors: type[Exception]) -> None:
        """Have something read that may be refused by ``errors``; `BrokenError` for any other."""
        try:
            read()
        except errors as error:
            lines = str(error).splitlines()
            if not lines or len(lines) > MOST_LINES or max(map(len, lines)) > MOST_LETTERS:
                raise BrokenError(f"{kind}: refused in {len(lines)} lines: {error!r}") from error
            self.refused[kind] += 1
        except BaseException as error:
            raise BrokenError(f"{kind}: {error!r}") from error
        else:
            self.accepted[kind] += 1

    def records(self, kind: str, read: Callable[[], tuple[Problem, Outcome]]) -> None:
        """Have results read: a record that is believed is written, and read as it was."""

        def recorded() -> None:
            record = record_of(self.case, *read(), {})
            if JointRecord.from_json(record.to_json()) != record:
                raise AssertionError("the record is not read as it was written")

        self.holds(kind, recorded, ResultError)

    # --- changes at random -----------------------------------------------------------------------
    def cut(self, text: str) -> str:
        """``text`` with some letters changed, left out, doubled or moved."""
        for _ in range(self.random.choice((1, 1, 1, 2, 5))):
            start = self.random.randrange(len(text) + 1)
            end = min(len(text), start + self.random.choice((0, 1, 1, 2, 5, 40)))
            put = "".join(self.random.choices(LETTERS, k=self.random.choice((0, 1, 1, 3))))
            put = self.random.choice((put, put, text[start:end] * 2))
            text = text[:start] + put + text[end:]
        return text

    def changed(self, tree: Any) -> Any:
        """A copy of ``tree`` in which one key or value, somewhere, is another."""
        if isinstance(tree, dict) and tree and self.random.random() < 0.9:
            key = self.random.choice(list(tree))
            rest = {name: value for name, value in tree.items() if name != key}
            how = self.random.random()
            if how < 0.1:
                return rest
            if how < 0.2:
                return rest | {self.random.choice((self.cut(str(key)), 7, "")): tree[key]}
            return tree | {key: self.changed(tree[key])}
        if isinstance(tree, list) and tree and self.random.random() < 0.7:
            place = self.random.randrange(len(tree))
            return [*tree[:place], self.changed(tree[place]), *tree[place + 1 :]]
        if isinstance(tree, float):
            scale = 10.0 ** self.random.uniform(-12, 12)
            return self.random.choice((tree * scale, -tree, *VALUES))
        return self.random.choice(VALUES)


# --- what is read --------------------------------------------------------------------------------
def tree(fuzz: Fuzz) -> None:
    """A configuration as keys and values."""
    config = fuzz.random.choice((PUBLISHED, yaml.safe_load(SMALL)))
    for _ in range(fuzz.random.choice((1, 1, 2, 4))):
        changed = fuzz.changed(config)
        config = changed if isinstance(changed, dict) else config

    def built() -> None:
        study = read_study(config)
        if case_count(study) <= FEW:
            cases_of(study)

    fuzz.holds("configuration, values", built, ConfigError)


def text(fuzz: Fuzz) -> None:
    """A configuration as text."""
    path = fuzz.folder / "study.yaml"
    path.write_bytes(fuzz.cut(SMALL).encode("utf-8", "surrogateescape"))
    fuzz.holds("configuration, text", lambda: read_study_file(path), ConfigError)


def name(fuzz: Fuzz) -> None:
    """The name of a case, and of a model."""
    case = fuzz.cut("n3-mesh0.02-e0.5a")
    model = fuzz.random.choice((None, "static", "yade", fuzz.cut("static")))
    fuzz.holds("case", lambda: find_case(_SMALL_STUDY, case, model), ConfigError)


def engine(fuzz: Fuzz) -> None:
    """What an engine has left."""
    for file, whole in fuzz.engine_files.items():
        (fuzz.folder / file).write_text(whole)
    file = fuzz.random.choice((HISTORY, NODES, RESULT))
    whole = fuzz.engine_files[file]
    text = json.dumps(fuzz.changed(json.loads(whole))) if file == RESULT else whole
    text = fuzz.random.choice((fuzz.cut(whole), text))
    (fuzz.folder / file).write_text(text, encoding="utf-8", errors="surrogateescape")
    problem = fuzz.case.subject.problem()
    fuzz.records("engine", lambda: (problem, read_outcome(fuzz.folder, problem.assembly)))


def threedec(fuzz: Fuzz) -> None:
    """What 3DEC has printed."""
    text = fuzz.cut(fuzz.printed)
    fuzz.records("3DEC", lambda: read_returned(text, fuzz.case))


def words(fuzz: Fuzz) -> None:
    """Words of the command."""
    given = fuzz.random.choice((["law", "-n", "5"], ["capacity", "-n", "3", "-m", "law"]))
    for _ in range(fuzz.random.choice((0, 1, 1, 2, 3))):
        (flag, *_) = fuzz.random.choice(command.commands[given[0]].params).opts
        given += [flag, fuzz.random.choice(AMOUNTS)]
    place = fuzz.random.randrange(2 * len(given))  # half of them stay as they are
    given = [fuzz.cut(word) if number == place else word for number, word in enumerate(given)]
    given = [word.replace("\0", "") for word in given]  # which no shell can hand on
    with chdir(fuzz.folder):
        found = CliRunner().invoke(command, given)
    if found.exception and not isinstance(found.exception, SystemExit):
        raise BrokenError(f"command: {given}: {found.exception!r}")
    (fuzz.refused if found.exit_code else fuzz.accepted)["command"] += 1


def compas(fuzz: Fuzz) -> None:
    """A model of compas_dem or an assembly of compas_cra, as values or as text."""
    given = fuzz.random.choice((model, assembly))()
    values = fuzz.random.random() < 0.5
    text = json.dumps(fuzz.changed(given)) if values else fuzz.cut(json.dumps(given))
    path = fuzz.folder / "compas.json"
    path.write_text(text, encoding="utf-8", errors="surrogatepass")

    def read() -> None:
        read_compas_interfaces(path, read_compas(path, 2e3))

    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)  # of numbers that are not checked in time
        fuzz.holds("compas", read, ValueError)


KINDS: tuple[tuple[Callable[[Fuzz], None], int], ...] = (
    *((tree, 40), (text, 25), (name, 20), (engine, 10), (threedec, 3), (words, 2), (compas, 10)),
)
_SMALL_STUDY = read_study(yaml.safe_load(SMALL))


@contextmanager
def begun(seed: int) -> Iterator[Fuzz]:
    """The valid inputs that others are made from, in a separate folder."""
    with tempfile.TemporaryDirectory(prefix="multilock-fuzz-") as place:
        folder, case = Path(place), case_of(0.5)
        write_engine_files(folder, case)
        files = {file: (folder / file).read_text() for file in (HISTORY, NODES, RESULT)}
        printed = returned(case, json.loads(files[RESULT])["peak_load_N"])
        yield Fuzz(folder, random.Random(seed), case, files, printed)


def tried(fuzz: Fuzz, number: int) -> None:
    """Try about ``number`` inputs of all kinds; raises `BrokenError`."""
    whole = sum(share for _, share in KINDS)
    for kind, share in KINDS:
        for _ in range(math.ceil(number * share / whole)):
            kind(fuzz)


def main() -> None:
    """Try as many as asked for, and write their counts."""
    arguments = asked(__doc__, "inputs", 100_000, "fuzz.csv")
    with begun(arguments.seed) as fuzz:
        for part in range(100):
            tried(fuzz, math.ceil(arguments.number / 100))
            print(f"{part + 1} %", end="\r", flush=True)
    kinds = sorted(fuzz.accepted | fuzz.refused)
    rows = [(kind, fuzz.accepted[kind], fuzz.refused[kind]) for kind in kinds]
    write_counts(arguments.table, ("kind", "accepted", "refused"), rows)
    print(f"\nAn answer or a clear no, every time. Table: {arguments.table}")


if __name__ == "__main__":
    main()

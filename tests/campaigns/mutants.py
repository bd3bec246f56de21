"""Would tests notice? Faults are put into the code, one by one, and all without an engine run.

    make mutants MUTANTS=200

Cosmic Ray makes the faults: in the library and the readers of results, at places chosen at random,
one kind at a place. The tests that import a module come first, then the others. The score is the
share that is noticed; build/mutants.csv has every fault.
"""

import csv
import random
import re
import shlex
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable, Iterator
from pathlib import Path

from campaigns.counts import ROOT, asked
from cosmic_ray.commands.init import init
from cosmic_ray.mutating import mutate_and_test
from cosmic_ray.work_db import WorkDB, use_db
from cosmic_ray.work_item import MutationSpec, TestOutcome

READERS = ("workflow/results/__init__.py", "workflow/threedec.py")
TESTS = "not engine and not study and not machine"
COLUMNS = ("module", "line", "kind", "noticed", "diff")
TYPES = "BitOr"  # float | None: no tests are for those
Row = tuple[str, int, str, bool, str]
SLOWER = 5.0  # with a fault than without: the tests are taken to hang, which is noticed


def places(folder: Path, modules: Iterable[Path]) -> list[list[MutationSpec]]:
    """All faults that can be made, by place and kind."""
    found: dict[tuple[str, tuple[int, int], str], list[MutationSpec]] = {}
    with use_db(str(folder / "session.sqlite"), WorkDB.Mode.create) as database:
        init(modules, database, {})
        for item in database.work_items:
            (fault,) = item.mutations
            if TYPES not in fault.operator_name:
                kind = fault.operator_name.partition("_")[0]
                place = (str(fault.module_path), fault.start_pos, kind)
                found.setdefault(place, []).append(fault)
    return [found[place] for place in sorted(found)]


def importers(checkout: Path, module: str) -> list[str]:
    """Test files that import a module by its name, below the checkout."""
    name = re.escape(module.removesuffix(".py").removesuffix("/__init__").replace("/", "."))
    imports = re.compile(rf"^\s*(from|import) {name}\b", re.MULTILINE)
    files = sorted((checkout / "tests").glob("test_*.py"))
    return [f"tests/{path.name}" for path in files if imports.search(path.read_text())]


def command(checkout: Path, module: str | None = None) -> str:
    """The tests, in a shell: those that import the module, then all."""
    pytest = f"{shlex.quote(sys.executable)} -m pytest -x -q -p no:cacheprovider"
    pytest += f" -m {shlex.quote(TESTS)}"
    first = " ".join(importers(checkout, module)) if module else ""
    commands = f"{pytest} {first} && {pytest}" if first else pytest
    place = shlex.quote(str(checkout))
    return f"cd {place} && PYTHONPATH={place} OPENBLAS_NUM_THREADS=1 sh -c {shlex.quote(commands)}"


def tried(checkout: Path, faults: Iterable[MutationSpec], longest: float) -> Iterator[Row]:
    """A row for each fault, with what the tests say of it within ``longest`` (s)."""
    for fault in faults:
        module = str(Path(fault.module_path).relative_to(checkout))
        run = f"sh -c {shlex.quote(command(checkout, module))}"
        found = mutate_and_test([fault], run, longest)
        if found.test_outcome is None:
            continue
        noticed = found.test_outcome is not TestOutcome.SURVIVED
        kind = fault.operator_name.removeprefix("core/")
        yield module, fault.start_pos[0], kind, noticed, found.diff or ""


def main() -> None:
    """Try as many as asked for, in a copy of the checkout as it was committed."""
    arguments = asked(__doc__, "mutants", 200, "mutants.csv")
    arguments.table.parent.mkdir(parents=True, exist_ok=True)
    counts = [0, 0]
    with tempfile.TemporaryDirectory(prefix="multilock-mutants-") as name:
        checkout = Path(name, "checkout")
        subprocess.run(["git", "clone", "--quiet", str(ROOT), str(checkout)], check=True)
        modules = [*sorted((checkout / "sidmacib").rglob("*.py")), *(checkout / r for r in READERS)]
        chosen = random.Random(arguments.seed)
        start = time.monotonic()
        if subprocess.run(command(checkout), shell=True, check=False).returncode:
            raise SystemExit("The tests fail before any fault is put in.")
        longest = SLOWER * (time.monotonic() - start)
        every = places(Path(name), modules)
        some = chosen.sample(every, min(arguments.number, len(every)))
        with arguments.table.open("w", newline="") as stream:
            writer = csv.writer(stream, lineterminator="\n")
            writer.writerow(COLUMNS)
            for row in tried(checkout, (chosen.choice(kinds) for kinds in some), longest):
                module, line, kind, noticed, _ = row
                counts[noticed] += 1
                print(f"{module}:{line} {kind}: {'noticed' if noticed else 'SURVIVED'}", flush=True)
                writer.writerow(row)
                stream.flush()
    score = counts[True] / max(1, sum(counts))
    print(f"{counts[True]} of {sum(counts)} noticed, score {score:.2f}. Table: {arguments.table}")


if __name__ == "__main__":
    main()

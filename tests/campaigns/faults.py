"""A campaign of faults: whatever happens to a study, the next run ends as if nothing had happened.

    make faults FAULTS=500

A small study is run undisturbed. Then, round by round, faults of one kind are put into its results
or a run of it, and the next run must end well, with the same tables byte for byte; no process of
it may be left. A file that cannot be read is made again, or named; results are never taken for
those of another study. Faults are counted by kind in build/faults.csv.
"""

import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from itertools import cycle
from pathlib import Path
from typing import Any

import pandas as pd
import psutil
import yaml
from campaigns.counts import asked, tables_of, write_counts
from processes import started
from small import COARSE

from sidmacib.engines.scripts.records import RESULT
from workflow.results import BATCH_RECORDS, RECORD

STUDY = COARSE | {
    "eccentricities": [0, "torsion"],
    "dem": {"engines": ["yade"], "time_limit": 60},
    "sidmacib": {"reductions": ["none", "half"]},
}
STRONGER = {"materials": {"inner": {"cohesion": 1.2e5}}}
LONGEST = 300.0  # s, of a run
RUN = (sys.executable, "-m", "workflow", "study")
READ = (RECORD, BATCH_RECORDS)
# Root without the right to write where nobody may.
AS_ANYBODY = ("setpriv", "--bounding-set=-dac_override,-dac_read_search")
# What an engine's script may be run by in place of Python (YADE_PYTHON): none of it gives a result.
BAD_ENGINES = {
    "hangs": "#!/bin/sh\nexec sleep 1000\n",
    "is killed": "#!/bin/sh\nkill -KILL $$\n",
    "lies": "#!/bin/sh\necho load_N > history.csv; echo face > nodes.csv\n"
    """echo '{"peak_load_N": 1e9, "failed_load_N": 2e9}' > result.json\n""",
    "diverges": "#!/bin/sh\necho load_N > history.csv; echo face > nodes.csv\n"
    """echo '{"peak_load_N": NaN, "failed_load_N": NaN}' > result.json\n""",
}


class LostError(AssertionError):
    """Something was lost: the message says what, after which fault."""


@dataclass
class Campaign:
    """A study that was run undisturbed, and one that is disturbed again and again."""

    folder: Path
    random: random.Random
    kills: int = 4  # processes of one round
    counts: Counter[str] = field(default_factory=Counter)
    results: Path = field(init=False)

    def __post_init__(self) -> None:
        self.results = self.folder / "results"

    def run(
        self,
        limit: int | None = None,
        prefix: Sequence[str] = (),
        changed: Mapping[str, Any] = {},
        **environment: str,
    ) -> subprocess.Popen[str]:
        """Begin the study with ``changed`` keys, perhaps by another command, ``prefix``.

        ``limit``: bytes that a file may have, as on a disk that is full.
        """

        def full() -> None:
            if limit is not None:
                signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
                resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

        study = self.folder / "study.yaml"
        config = STUDY | ({"dem": {"engines": ["yade"], "time_limit": 3}} if environment else {})
        study.write_text(yaml.safe_dump({**config, **changed}))
        words = (*prefix, *RUN, str(study), f"--results={self.results}")
        env = {**os.environ, "OPENBLAS_NUM_THREADS": "1", **environment}
        return started(*words, env=env, start_new_session=True, preexec_fn=full)  # no threads here

    def finished(self, process: subprocess.Popen[str]) -> str:
        """What a run printed, once it has ended."""
        output, _ = process.communicate(timeout=LONGEST)
        return output

    def files(self) -> list[Path]:
        """Everything that the study has made, but its lock and what a run says."""
        found = (path for path in self.results.rglob("*") if path.is_file())
        return sorted(path for path in found if path.name != ".lock" and path.suffix != ".log")


# --- faults --------------------------------------------------------------------------------------
def deleted(campaign: Campaign) -> None:
    """Results that are gone, but the files that an engine leaves beside its records."""
    beside = campaign.results / "cases/yade"
    kept = (RECORD, RESULT)
    files = [p for p in campaign.files() if not p.is_relative_to(beside) or p.name in kept]
    for path in campaign.random.sample(files, 6):
        path.unlink()
        campaign.counts["deleted"] += 1


def full_disk(campaign: Campaign) -> None:
    """A disk on which no file of some size can be written."""
    shutil.rmtree(campaign.results / "tables")
    campaign.finished(campaign.run(limit=campaign.random.choice((100, 1000, 5000, 30000))))
    campaign.counts["full disk"] += 1


def two_runs(campaign: Campaign) -> None:
    """A second run in a folder where one is at work: it says so, and touches nothing."""
    shutil.rmtree(campaign.results / "tables")
    first = campaign.run()
    time.sleep(campaign.random.uniform(0.1, 3.0))
    output = campaign.finished(campaign.run())
    whole = campaign.finished(first)
    refused = ["another run is using this folder" in each for each in (output, whole)]
    if sum(refused) != 1:
        raise LostError(f"two runs in one folder: {output}")
    campaign.counts["two runs"] += 1


def killed(campaign: Campaign) -> None:
    """A process of a run that is killed, at any moment: the whole run, or a job, or an engine."""
    shutil.rmtree(campaign.results / "cases")
    shutil.rmtree(campaign.results / "tables")
    for _ in range(campaign.kills):
        process = campaign.run()
        time.sleep(campaign.random.uniform(0.2, 8.0))
        if process.poll() is None:
            family = descendants(process.pid)
            with suppress(ProcessLookupError):
                os.kill(campaign.random.choice([process.pid, *family, *family]), signal.SIGKILL)
                campaign.counts["killed"] += 1
        campaign.finished(process)


def read_only(campaign: Campaign) -> None:
    """Results that whoever runs the study may not write: one line says so, all stays as it is."""
    before = {path: path.read_bytes() for path in campaign.files()}
    (campaign.results / "tables/cases.csv").unlink()
    every = [campaign.results, *campaign.results.rglob("*")]
    modes = {path: path.stat().st_mode for path in every}
    try:
        for path, mode in modes.items():
            path.chmod(mode & ~0o222)
        process = campaign.run(prefix=AS_ANYBODY if os.getuid() == 0 else ())
        lines = campaign.finished(process).splitlines()
    finally:
        for path, mode in modes.items():
            path.chmod(mode)
    wrong = [path for path in before if path.name != "cases.csv" and not path.exists()]
    if wrong or not process.returncode or len(lines) > 2 or "cannot be written" not in lines[-1]:
        raise LostError(f"read-only results: code {process.returncode}, {wrong}, {lines}")
    campaign.counts["read-only folder"] += 1


def bad_engine(campaign: Campaign) -> None:
    """An engine that hangs, lies, diverges or crashes: its cases have no result, and are named."""
    kind = campaign.random.choice(sorted(BAD_ENGINES))
    program = campaign.folder / "engine"
    program.write_text(BAD_ENGINES[kind])
    program.chmod(0o755)
    shutil.rmtree(campaign.results / "cases" / "yade")
    output = campaign.finished(campaign.run(YADE_PYTHON=str(program)))
    if "No result" not in output and "WITHOUT A RESULT" not in output:
        raise LostError(f"an engine that {kind} was believed: {output[-2000:]}")
    campaign.counts["bad engine"] += 2  # its cases


def corrupted(campaign: Campaign) -> None:
    """A file of which a disk has lost a part: what the next run does not mend it names."""
    kept = [p for p in campaign.files() if p.name in READ or p.suffix == ".parquet"]
    path = campaign.random.choice(kept)
    content = path.read_bytes()
    at = campaign.random.randrange(len(content))
    path.write_bytes(content[:at] + bytes(campaign.random.choice((0, len(content) - at))))
    campaign.counts["corrupted"] += 1
    process = campaign.run()
    output = campaign.finished(process)
    if process.returncode:
        if str(path) not in output:
            raise LostError(f"{path} was damaged, and is not named: {output[-3000:]}")
        path.unlink()


def replaced(campaign: Campaign) -> None:
    """A record in the place of another's: results of one case are never those of another."""
    records = [path for path in campaign.files() if path.name == RECORD]
    one, other = campaign.random.sample(records, 2)
    shutil.copy(one, other)
    campaign.counts["replaced"] += 1


def shifted(campaign: Campaign) -> None:
    """Another study on results that were moved, by a clock that was wrong."""
    moved = campaign.folder / f"results-{campaign.counts.total()}"
    campaign.results.rename(moved)
    campaign.results = moved
    for path in campaign.files():
        when = time.time() + campaign.random.uniform(-1e8, 1e8)
        os.utime(path, (when, when))
    process = campaign.run(changed=STRONGER)
    output = campaign.finished(process)
    if process.returncode:
        raise LostError(f"another study does not run on moved results: {output[-2000:]}")
    weaker, stronger = (
        float(pd.read_csv(results / "tables/cases.csv")["load_N"].max())
        for results in (campaign.folder / "undisturbed", moved)
    )
    if not stronger > 1.2 * weaker:
        raise LostError(f"results of another study were taken for current: {output[-2000:]}")
    campaign.counts["shifted clock"] += 1


FAULTS = (
    *(deleted, corrupted, replaced, shifted),
    *(full_disk, read_only, two_runs, killed, bad_engine),
)


# --- what may be left ----------------------------------------------------------------------------
def descendants(pid: int) -> list[int]:
    """Processes that a process has started, and those that they have."""
    with suppress(psutil.NoSuchProcess):
        return [process.pid for process in psutil.Process(pid).children(recursive=True)]
    return []


def processes_in(folder: Path) -> list[str]:
    """Commands of the processes that name ``folder``, or work in it."""
    found = []
    for process in psutil.process_iter(["cmdline", "cwd"]):
        command = " ".join(process.info["cmdline"] or ())
        if process.pid != os.getpid() and str(folder) in f"{command} {process.info['cwd']}":
            found.append(command)
    return found


# --- the campaign --------------------------------------------------------------------------------
@contextmanager
def begun(seed: int) -> Iterator[Campaign]:
    """A campaign in a separate folder, whose study was run undisturbed."""
    with tempfile.TemporaryDirectory(prefix="multilock-faults-") as name:
        campaign = Campaign(Path(name), random.Random(seed))
        process = campaign.run()
        output = campaign.finished(process)
        if process.returncode:
            raise LostError(f"the study does not run undisturbed: {output[-2000:]}")
        shutil.copytree(campaign.results, campaign.folder / "undisturbed")
        yield campaign


def held(campaign: Campaign, fault: Callable[[Campaign], None]) -> None:
    """Put one round of a fault in, run the study again, and hold it against the undisturbed one.

    Raises `LostError`.
    """
    expected = tables_of(campaign.results)
    what = f"{fault.__name__}, round after {campaign.counts.total()} faults"
    fault(campaign)
    process = campaign.run()
    output = campaign.finished(process)
    if process.returncode:
        raise LostError(f"{what}: the next run did not end well: {output[:3000]}")
    tables = tables_of(campaign.results)
    for name in sorted(expected.keys() | tables.keys()):
        if expected.get(name) != tables.get(name):
            raise LostError(f"{what}: {name} is another")
    time.sleep(0.1)
    if left := processes_in(campaign.folder):
        raise LostError(f"{what}: processes are left: {left}")


def main() -> None:
    """Run as many faults as asked for, one kind after the other, and write their counts."""
    arguments = asked(__doc__, "faults", 500, "faults.csv")
    with begun(arguments.seed) as campaign:
        faults = cycle(FAULTS)
        while campaign.counts.total() < arguments.number:
            held(campaign, next(faults))
            print(f"{campaign.counts.total()} faults: {dict(campaign.counts)}", flush=True)
    write_counts(arguments.table, ("kind", "faults"), sorted(campaign.counts.items()))
    print(f"Nothing was lost. Table: {arguments.table}")


if __name__ == "__main__":
    main()

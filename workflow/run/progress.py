"""Progress of a run of Snakemake: a bar on a terminal, a few lines in a file.

Snakemake's log has about ten lines for each job. This one names each case without a result and each
failed job once, with the reason and the path of its log.
"""

import importlib
import json
import re
import shutil
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from logging import WARNING, LogRecord
from pathlib import Path
from typing import Any, TextIO

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn
from snakemake_interface_logger_plugins.base import LogHandlerBase
from snakemake_interface_logger_plugins.common import LogEvent

from workflow.results.files import RECORD
from workflow.run.attempts import STOPPED

NAME = "snakemake_logger_plugin_multilock"
SPARSE = 10  # lines of a run in a file, about,
SELDOM = 120.0  # and seconds after which there is another
SHOWN = 2  # jobs that are running, by name
MINUTE = 60.0
MESSAGE = 4096  # bytes that are left on a disk where a log has room for a message
FULL = "no space left on the disk"
COMPLETE = "Check that every case has a result"  # a job that fails because of others
WORDLESS = (STOPPED, "KeyboardInterrupt", "")  # last lines of jobs that may not have failed
DIED = re.compile(r"died with <Signals\.(\w+): \d+>")
REPEATED = (
    "RuleException",
    "Exiting because a job execution failed.",
    "WorkflowError:\nAt least one job did not complete successfully.",
)


@dataclass
class Run:
    """Jobs of a run: their number, those that are running and those that failed."""

    total: int = 0
    done: int = 0
    begun: float = 0.0
    started: dict[int, tuple[str, list[str], list[str]]] = field(default_factory=dict)
    rule_of: dict[int, str] = field(default_factory=dict)
    running: dict[int, str] = field(default_factory=dict)
    failed: list[str] = field(default_factory=list)
    lines: dict[str, str] = field(default_factory=dict)  # on what went wrong, by job
    rules: frozenset[str] = frozenset()  # of jobs to be done
    killed: list[str] = field(default_factory=list)  # Snakemake's messages about commands
    ended: set[str] = field(default_factory=set)  # rules of which a job has ended well

    @property
    def reasons(self) -> list[str]:
        """The errors, a line each; the job that checks all cases only if no other job failed."""
        names = [name for name in self.lines if name != COMPLETE] or list(self.lines)
        return [self.lines[name] for name in names]

    def is_made(self, rule: str) -> bool:
        """Whether the only job of ``rule`` ended well in this run, or was up to date before it."""
        return bool(self.rules) and (rule not in self.rules or rule in self.ended)

    def words(self, now: float) -> str:
        """Progress of the run in one line, ``now`` in s."""
        parts = [f"{self.done} of {self.total} jobs done"]
        if self.failed:
            parts.append(f"{len(self.failed)} failed")
        if self.running:
            names = list(self.running.values())
            more = f" and {len(names) - SHOWN} more" if len(names) > SHOWN else ""
            parts.append(f"running: {', '.join(names[:SHOWN])}{more}")
        if left := self.left(now):
            parts.append(f"about {left} left")
        return "; ".join(parts)

    def left(self, now: float) -> str:
        """Remaining time at the present rate of jobs; empty before the first has ended."""
        if not self.done or self.done >= self.total:
            return ""
        seconds = (now - self.begun) * (self.total - self.done) / self.done
        if seconds < 2 * MINUTE:
            return f"{seconds:.0f} s"
        return (
            f"{seconds / MINUTE:.0f} min" if seconds < 120 * MINUTE else f"{seconds / 3600:.1f} h"
        )

    def heard(self, record: LogRecord, now: float) -> list[str]:
        """Process a log record of Snakemake; returns lines that must be shown."""
        event, details = getattr(record, "event", None), record.__dict__
        if event == LogEvent.RUN_INFO:
            self.total = sum(count for job, count in details["stats"].items() if job != "total")
            self.begun, self.rules = now, frozenset(details["stats"])
        elif event == LogEvent.JOB_INFO:
            name = details["rule_msg"] or details["rule_name"]
            self.started[details["jobid"]] = (
                str(name),
                list(details["output"]),
                list(details["log"]),
            )
            self.rule_of[details["jobid"]] = str(details["rule_name"])
            self.running[details["jobid"]] = str(name)
        elif event == LogEvent.JOB_FINISHED:
            self.done += 1
            name = self.started.get(details["job_id"], ("", [], []))[0]
            self.ended.add(self.rule_of.get(details["job_id"], ""))
            self.lines.pop(name, None)
            if name in self.failed:  # and was tried again
                self.failed.remove(name)
            self.running.pop(details["job_id"], None)
            return self._without_result(details["job_id"])
        elif event == LogEvent.JOB_ERROR:
            self.running.pop(details["jobid"], None)
            return self._ended_badly(details)
        elif record.levelno >= WARNING and event in (None, LogEvent.ERROR):
            text = record.getMessage() if record.msg else ""
            if DIED.search(text):
                self.killed.append(text)
            # Jobs that ended badly have been named, or are about to be.
            return [] if not text or text.startswith(REPEATED) else [text]
        return []

    def _without_result(self, job: int) -> list[str]:
        """A line for a case whose record has no result."""
        name, outputs, logs = self.started.get(job, ("", [], []))
        for path in (Path(each) for each in outputs if Path(each).name == RECORD):
            try:
                error = json.loads(path.read_text()).get("error")
            except (OSError, ValueError, AttributeError, RecursionError):
                continue
            if error:
                self.failed.append(name)
                self.lines[name] = f"No result: {name}: {error}; log: {', '.join(logs)}"
                return [self.lines[name]]
        return []

    def _ended_badly(self, details: dict[str, Any]) -> list[str]:
        name, _, logs = self.started.get(details["jobid"], (details["rule_name"], [], []))
        reason = _last_line(logs)
        if killed := next((word for word in self.killed if logs and logs[0] in word), None):
            self.killed.remove(killed)
            reason = _by_signal(killed)
            _append(logs[0], reason)
        elif not reason and any(_is_full(Path(log).parent) for log in logs):
            reason = FULL
        shown = f"Failed: {name}: {reason or 'no message'}; log: {', '.join(logs)}"
        if reason in WORDLESS:  # asked to end, or never started, as in a group that failed
            if reason or any(Path(log).exists() for log in logs):
                self.lines[name] = shown
            return []
        self.failed.append(name)
        self.lines[name] = shown
        return [shown]


def _is_full(folder: Path) -> bool:
    """Whether a message would not fit onto the disk of ``folder``."""
    try:
        return shutil.disk_usage(folder).free < MESSAGE
    except OSError:
        return False


def _by_signal(text: str) -> str:
    """A short form of Snakemake's message about a command that a signal ended."""
    found = DIED.search(text)
    assert found is not None, "only such texts are kept"
    short = ", probably because memory ran out" if found[1] == "SIGKILL" else ""
    return f"killed by {found[1]}{short}"


def _append(log: str, words: str) -> None:
    """Append a reason to the log of a job that could not write it."""
    with suppress(OSError), Path(log).open("a") as stream:
        print(words, file=stream)


def _last_line(logs: list[str]) -> str:
    """The last line of a log that is not empty."""
    for path in map(Path, logs):
        try:
            lines = path.read_text(errors="replace").split("\n")
        except OSError:
            continue
        found = [line.strip() for line in lines if line.strip()]
        if found:
            return found[-1]
    return ""


_runs = [Run()]
_planned: list[Callable[[], None]] = []


def when_planned(call: Callable[[], None]) -> None:
    """Call ``call`` once the jobs of the next run are known."""
    _planned[:] = [call]


def last_run() -> Run:
    """The latest run of Snakemake in this process."""
    return _runs[-1]


class LogHandler(LogHandlerBase):
    """Snakemake's log, as a bar or as a few lines."""

    def __post_init__(self) -> None:
        self.run = Run()
        _runs[:] = [self.run]
        self.stream: TextIO = sys.stderr
        self.last, self.lines = -SELDOM, 0
        self.bar: Progress | None = None
        if self.stream.isatty():
            columns = TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn()
            console = Console(file=self.stream)
            self.bar = Progress(*columns, TextColumn("{task.fields[words]}"), console=console)
            self.task = self.bar.add_task("study", total=None, words="")

    def emit(self, record: LogRecord) -> None:
        """Show a log record."""
        now = time.monotonic()
        before = self.run.done
        if getattr(record, "event", None) == LogEvent.RUN_INFO:
            while _planned:
                _planned.pop()()
        for line in self.run.heard(record, now):
            self._print(line)
        if self.bar is not None:
            self._draw(now)
        elif self.run.total and self._due(before, now):
            self.last, self.lines = now, self.lines + 1
            self._print(self.run.words(now))

    def _due(self, before: int, now: float) -> bool:
        """Whether a new line is due: after a tenth of the jobs, or after `SELDOM` s."""
        part = max(1, self.run.total // SPARSE)
        return self.run.done // part > before // part or now - self.last > SELDOM

    def _draw(self, now: float) -> None:
        assert self.bar is not None
        if self.run.total and not self.bar.live.is_started:
            self.bar.start()
        words = "; ".join(self.run.words(now).split("; ")[1:])
        self.bar.update(
            self.task, total=self.run.total or None, completed=self.run.done, words=words
        )

    def _print(self, line: str) -> None:
        if self.bar is not None:
            self.bar.console.print(line, markup=False, highlight=False, soft_wrap=True)
        else:
            print(line, file=self.stream, flush=True)

    def close(self) -> None:
        """Restore the terminal."""
        if self.bar is not None and self.bar.live.is_started:
            self.bar.stop()
        super().close()

    writes_to_stream = property(lambda self: True)
    writes_to_file = property(lambda self: False)
    has_filter = property(lambda self: True)
    has_formatter = property(lambda self: True)
    needs_rulegraph = property(lambda self: False)


def register() -> str:
    """Register this log with Snakemake; returns its name there."""
    registry = importlib.import_module("snakemake_interface_logger_plugins.registry")
    registry.LoggerPluginRegistry().register_plugin(NAME, sys.modules[__name__])
    return NAME.removeprefix("snakemake_logger_plugin_")

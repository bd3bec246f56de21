"""Before anything runs: ^C while programs load, the locale, and a faulty configuration."""

import re
from pathlib import Path

import pytest
from conftest import INSTALLED
from processes import python, ran

SMALL = (
    "samples: {n3: {locks: 3}}\nmeshes: [0.02]\neccentricities: [0]\nmodels: [static]\n"
    "dem: {engines: []}\nsidmacib: {reductions: [none]}\n"
)
# ^C, twice, when a module is first imported.
INTERRUPTED = """
import builtins, os, signal, sys
real, late = __import__, sys.argv.pop(1)
def slow(name, *others, **more):
    if name.partition(".")[0] == late and late not in sys.modules:
        sys.modules[late] = None
        try:
            os.kill(os.getpid(), signal.SIGINT)
        finally:
            os.kill(os.getpid(), signal.SIGINT)
    return real(name, *others, **more)
builtins.__import__ = slow
"""
PROGRAM = "from sidmacib.command import run; run()"


@pytest.mark.parametrize("late", ["click", "numpy"])
def test_an_interrupt_while_a_program_loads_is_reported_in_one_line(late: str) -> None:
    found = python("-c", INTERRUPTED + PROGRAM, late)
    assert found.returncode == 1
    assert found.stderr == "Aborted!\n"


@pytest.mark.study
def test_a_case_is_run_in_a_locale_that_is_not_utf_8(tmp_path: Path) -> None:
    config = tmp_path / "study.yaml"
    config.write_text(SMALL + "# \u00b5\n", encoding="utf-8")
    words = (f"CONFIG={config}", f"RESULTS={tmp_path / 'results'}", "CASE=n3-mesh0.02-e0a")
    posix = {"LC_ALL": "POSIX", "PYTHONCOERCECLOCALE": "0", "PYTHONUTF8": ""}
    found = ran(*INSTALLED, "case", *words, **posix)
    assert found.returncode == 0, found.stderr
    assert "V = 24" in found.stdout


def test_make_installs_nothing_for_a_study_that_is_not_there() -> None:
    command = ("make", "--dry-run", "--always-make", "study", "CONFIG=my.yaml")
    printed = ran(*command, check=True).stdout
    first, *_ = [line for line in printed.splitlines() if re.search("not a file|environment", line)]
    early = ran("sh", "-c", first, CONFIG="my.yaml")
    assert (early.returncode, early.stderr) == (1, "my.yaml: not a file\n")


def test_a_fault_that_only_the_cases_show_names_the_file(tmp_path: Path) -> None:
    path = tmp_path / "study.yaml"
    path.write_text(SMALL + "overrides: {n3-mesh0.02-torsion: {ramp_periods: 50}}\n")
    asked = ["case", str(path), "--case", "n3-mesh0.02-e0a"]
    assert python("-m", "analysis", *asked).stderr.startswith(f"{path}: overrides: 'n3-mesh0.02-")
    path.write_text(SMALL)
    asked[-1] = "n4"
    assert python("-m", "analysis", *asked).stderr.startswith("CASE: 'n4' is not a case")

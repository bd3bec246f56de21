"""The commands behind `make study`, `make report`, `make decks` and `make cases`."""

from workflow.run.process import end_on_signals, read_utf8

if __name__ == "__main__":  # before the other imports, which take half a second
    end_on_signals()
    read_utf8()

import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from sidmacib.command.output import FORMATS, text_of
from workflow.configuration import ConfigError, installed_engines, read_study_file
from workflow.consistency import notes
from workflow.models import REFERENCE_MODEL
from workflow.planning.cases import case_count
from workflow.planning.results_folder import REPORT
from workflow.run.command import (
    because,
    options_of,
    profile_named,
    run_command,
    snakemake,
    study_with_joints,
)
from workflow.run.waiting import waiting
from workflow.schema import Study

# Of joints, and of structures: the job of that name, and its rule, by the file that it writes.
SUMMARIES = {"summary.txt": "summary", "structures.txt": "structure_summary"}
MANY = 5000  # cases, which take a while to plan


def run_study(config: Path, results: str | None, profile: Path | None = None) -> str | None:
    """Run a study and print its summary; returns why it is incomplete, None if it is complete."""
    from workflow.run import progress

    with waiting(f"Reading {config}"):
        study = read_study_file(config, results)
        count = case_count(study)
    for line in notes(study):
        print(f"Note: {line}", file=sys.stderr)
    if count > MANY:
        print(f"{count:,} cases", file=sys.stderr)
    engines = installed_engines(study)
    if profile is None:  # nothing is computed on a cluster's front end
        _first_report(config, study, engines)
    whole = snakemake(config, study.results, (), engines, profile)
    old = ""
    for name, rule in SUMMARIES.items():
        if not (study.samples if rule == "summary" else study.structures):
            continue
        path = Path(study.results, name)
        ours = whole or progress.last_run().is_made(rule)
        if ours and path.is_file():
            print(path.read_text(), end="")
        elif path.is_file():
            old += f" ({name} is from an earlier run)"
    if whole and study.structures and not study.samples:  # the summary of joints names it
        print(f"Report: {study.results}/{REPORT}")
    return None if whole else f"{study.results}: the study is incomplete{old}{because()}"


def _first_report(config: Path, study: Study, engines: Sequence[str]) -> None:
    """Write a first report without the engines, which may take long.

    Only if there is no report yet; it is written again when the engines have ended.
    """
    path = Path(study.results, REPORT)
    if study.samples and engines and REFERENCE_MODEL in study.models and not path.exists():
        print("Writing a first report without the engines", file=sys.stderr)
        # In a separate process, whose lock of the results folder ends with it.
        words = ["report", str(config), f"--results={study.results}"]
        words += ["--without-engines", "--end-with-parent"]
        subprocess.run([sys.executable, "-m", "workflow", *words], check=False)


def write_report(config: Path, results: str | None, engines: bool = True) -> str | None:
    """Write the report, on request without engines; returns an error message, or None."""
    study = read_study_file(config, results)
    if not study.samples and not study.structures:
        raise ConfigError("samples: missing; a report needs joints or structures")
    path = str(Path(study.results, REPORT))
    if not snakemake(config, study.results, (path,), installed_engines(study) if engines else ()):
        return f"no report{because()}"
    print(f"Report: {path}")
    return None


def write_decks(config: Path, results: str | None) -> str | None:
    """Write the decks for 3DEC; returns an error message, or None."""
    study = study_with_joints(config, results)
    if not snakemake(config, study.results, ("decks",), list(study.dem.engines)):
        return f"no decks{because()}"
    print(f"Decks: {study.results}/decks/3dec")
    return None


def list_cases(config: Path, results: str | None, form: str) -> None:
    """Print the cases of a study and their state."""
    from workflow.run.case_states import case_rows

    print(text_of(case_rows(config, results), form))


def main() -> None:
    """Command line: a command, a configuration and a results folder."""
    parser = options_of("python -m workflow", __doc__, ["study", "report", "decks", "cases"])
    parser.add_argument(
        "--profile", help="profile of a cluster: a folder in profiles, such as slurm"
    )
    parser.add_argument(
        "--without-engines", action="store_true", help="write the report without results of engines"
    )
    parser.add_argument(
        "--format", default="table", choices=FORMATS, help="of the list of cases; default: table"
    )
    arguments = parser.parse_args()
    config, results = arguments.config, arguments.results or None
    commands = {
        "study": lambda: run_study(config, results, profile_named(arguments.profile)),
        "report": lambda: write_report(config, results, not arguments.without_engines),
        "decks": lambda: write_decks(config, results),
        "cases": lambda: list_cases(config, results, arguments.format),
    }
    run_command(commands[arguments.what], arguments)


if __name__ == "__main__":
    main()

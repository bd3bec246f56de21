"""The commands behind `make case` and `make calibrate`."""

from pathlib import Path

from sidmacib.engines import ENGINES
from sidmacib.models import CLOSED_FORM, REFERENCE_MODEL
from workflow.cases import find_case, find_place
from workflow.command import (
    options_of,
    run_command,
    snakemake,
    study_with_joints,
    use_writable_caches,
)
from workflow.configuration import CallError, ConfigError
from workflow.results import RECORD, read_records
from workflow.schema import Study


def run_case(config: Path, results: str | None, name: str, model: str | None) -> str | None:
    """Run one case if necessary and print its result; returns an error message, or None."""
    study = study_with_joints(config, results)
    use_writable_caches(Path(study.results))  # before importing modules that compile code
    from analysis.summary.one_case import describe_record

    if model in CLOSED_FORM:
        return _rule(study, name, model)
    chosen = find_case(study, name, model)
    folder = Path(study.results, chosen.folder)
    if chosen.model in ENGINES and (missing := ENGINES[chosen.model].missing()):
        return f"{name}: no result: {missing}"
    if not snakemake(config, study.results, (str(folder / "result.json"),)):
        return f"{name}: no result, see above"
    (record,) = read_records([folder / RECORD])
    print(f"{describe_record(record)}\n  files: {folder}")
    if record.error is not None:
        return f"{name}: no result"
    if chosen.model == REFERENCE_MODEL:
        from analysis.vtk import write_path  # compiles code and caches it

        pieces, _ = write_path(chosen, folder / "vtk")
        print(f"  for ParaView: {pieces.parent}/*.pvd")
    return None


def _rule(study: Study, name: str, model: str) -> str | None:
    """Print the result of a closed-form rule for a case; returns an error message, or None."""
    from analysis.summary.one_case import describe_rule
    from analysis.tables.capacity import NO_ANSWER

    try:
        print(f"{name}, {describe_rule(study, model, find_place(study, name))}")
    except ConfigError:
        raise
    except NO_ANSWER as error:
        return f"{name} ({model}): no result: {error}"
    return None


def run_calibration(config: Path, results: str | None) -> str | None:
    """Calibrate the joints of a study; returns an error message, or None."""
    from analysis.calibration import calibrate

    study_with_joints(config, results)
    return calibrate(config, results, snakemake)


def main() -> None:
    """Command line: a command, a configuration and a results folder."""
    parser = options_of("python -m analysis", __doc__, ["case", "calibrate"])
    parser.add_argument("--case", help="name of a case, such as n3-mesh0.02-e0.1a")
    parser.add_argument("--model", help="model of the case; default: the first one installed")
    arguments = parser.parse_args()
    config, results = arguments.config, arguments.results or None

    def case() -> str | None:
        if not arguments.case:
            raise CallError(
                "CASE: missing; it must be the name of a case, as in "
                "make case CASE=n3-mesh0.02-e0.1a"
            )
        return run_case(config, results, arguments.case, arguments.model or None)

    commands = {"case": case, "calibrate": lambda: run_calibration(config, results)}
    run_command(commands[arguments.what], arguments)


if __name__ == "__main__":
    main()

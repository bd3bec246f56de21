"""The commands behind `make case` and `make calibrate`."""

from collections.abc import Iterator
from itertools import product
from pathlib import Path

from analysis.drawing import label_of, option_name, rule_name
from sidmacib.contact_points import REDUCTIONS
from sidmacib.engines import ENGINES
from sidmacib.errors import CapacityError
from sidmacib.joint import Direction
from sidmacib.models import CLOSED_FORM, LAWS, REFERENCE_MODEL
from workflow.cases import Place, find_case, find_place
from workflow.command import (
    options_of,
    run_command,
    snakemake,
    study_with_joints,
    use_writable_caches,
)
from workflow.configuration import CallError
from workflow.results import RECORD, read_records
from workflow.results.joint_part import JointRecord
from workflow.schema import Study

WITHOUT_WEIGHTS = ("none", "half")  # reductions that need nothing but the number of locks


def run_case(config: Path, results: str | None, name: str, model: str | None) -> str | None:
    """Run one case if necessary and print its result; returns an error message, or None."""
    study = study_with_joints(config, results)
    use_writable_caches(Path(study.results))  # before importing modules that compile code
    if model in CLOSED_FORM:
        place = find_place(study, name)
        try:
            print(f"{name}, {describe_rule(study, model, place)}")
        except (CapacityError, ValueError) as error:
            return f"{name} ({model}): no result: {error}"
        return None
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


def describe_record(record: JointRecord) -> str:
    """Capacity and lock weights of a case, or the reason why it has none."""
    part = record.part
    if record.load_N is None or part.shear_N is None or part.torque_Nm is None:
        return f"{record.name} ({record.model}): no result: {record.error or record.refused}"
    lines = [
        f"{record.name} ({record.model}): V = {part.shear_N:.2f} N, M = {part.torque_Nm:.4f} N m",
    ]
    name, unit, digits = ("V", "N", 2) if part.shear_N else ("M", "N m", 4)
    for words, load in (
        ("not carried any more", record.failed_load_N),
        ("first failure", record.first_failure_load_N),
    ):
        if load is not None:
            amount = load / record.load_N * (part.shear_N or part.torque_Nm)
            lines.append(f"  {words}: {name} = {amount:.{digits}f} {unit}")
    if record.peak_spread is not None:
        lines.append(f"  spread of the peaks found: {100 * record.peak_spread:.2f} %")
    if part.weights:
        lines.append("  lock  block  weight  mean shear / tau  largest / tau")
    lines += [
        f"  {each.lock:>4}  {each.block:5}  {each.weight:6.3f}  {each.mean_shear_ratio:16.3f}"
        f"  {each.max_shear_ratio:13.3f}"
        for each in part.weights
    ]
    return "\n".join(lines)


def describe_rule(study: Study, name: str, place: Place) -> str:
    """The capacity at ``place`` by the closed-form rule ``name``, in words.

    `CapacityError` or ValueError where the rule has none.
    """
    from analysis.tables.capacity import law_capacity

    if name not in LAWS:
        return "\n".join(_sidmacib(study, name, place))
    point = law_capacity(study, name, place.sample, place.ratio, place.variant)
    return f"{label_of(name).name}: V = {point.shear:.2f} N, M = {point.torque:.4f} N m"


def _sidmacib(study: Study, name: str, place: Place) -> Iterator[str]:
    from sidmacib.contact_points.programme import Sidmacib, capacity

    joint = study.joint(place.sample, study.every_variant[place.variant])
    direction = Direction(place.ratio)
    yield f"{label_of(name).name}, by rules that need no weights; tables/capacity.csv has all"
    given, overload = study.sidmacib, study.sidmacib.overload
    rules = [rule for rule in given.reductions if rule in WITHOUT_WEIGHTS]
    for rule, (option, points), friction in product(rules, given.options.items(), (False, True)):
        strength = REDUCTIONS[rule](joint, ())
        model = Sidmacib(joint, points.contact_option(), strength, friction, overload)
        point, along = capacity(model, direction), "friction" if friction else "no friction"
        label = f"{option_name(option)}, {along}, {rule_name(rule)}"
        yield f"  {label}: V = {point.shear:.2f} N, M = {point.torque:.4f} N m"


def main() -> None:
    """Command line: a command, a configuration and a results folder."""
    parser = options_of("python -m analysis", __doc__, ["case", "calibrate"])
    parser.add_argument("--case", help="name of a case, such as n3-mesh0.02-e0.1a")
    parser.add_argument("--model", help="model of the case; default: the first one installed")
    arguments = parser.parse_args()
    config, results = arguments.config, arguments.results or None

    def run() -> str | None:
        if arguments.what == "calibrate":
            from analysis.calibration import calibrate

            study_with_joints(config, results)
            calibrate(config, results)
            return None
        if not arguments.case:
            raise CallError(
                "CASE: missing; it must be the name of a case, as in "
                "make case CASE=n3-mesh0.02-e0.1a"
            )
        return run_case(config, results, arguments.case, arguments.model or None)

    run_command(run, arguments)


if __name__ == "__main__":
    main()

"""The result of one case in words: `make case`."""

from collections.abc import Iterator
from itertools import product

from analysis.drawing import label_of, option_name, rule_name
from analysis.tables.capacity import law_capacity
from sidmacib.contact_points import REDUCTIONS
from sidmacib.contact_points.programme import Sidmacib, capacity
from sidmacib.joint import Direction
from sidmacib.models import LAWS
from workflow.cases import Place
from workflow.results.joint_part import JointRecord
from workflow.schema import Study

WITHOUT_WEIGHTS = ("none", "half")  # reductions that need nothing but the number of locks


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

    One of `NO_ANSWER` of `analysis.tables.capacity` where the rule has none.
    """
    if name not in LAWS:
        return "\n".join(_sidmacib(study, name, place))
    point = law_capacity(study, name, place.sample, place.ratio, place.variant)
    return f"{label_of(name).name}: V = {point.shear:.2f} N, M = {point.torque:.4f} N m"


def _sidmacib(study: Study, name: str, place: Place) -> Iterator[str]:
    joint = study.joint(place.sample, study.every_variant[place.variant])
    direction = Direction(place.ratio)
    yield f"{label_of(name).name}, by rules that need no weights; tables/capacity.csv has all"
    rules = [rule for rule in study.sidmacib.reductions if rule in WITHOUT_WEIGHTS]
    for rule, (option, points), friction in product(
        rules, study.sidmacib.options.items(), (False, True)
    ):
        strength = REDUCTIONS[rule](joint, ())
        model = Sidmacib(
            joint, points.contact_option(), strength, friction, study.sidmacib.overload
        )
        point = capacity(model, direction)
        label = (
            f"{option_name(option)}, {'friction' if friction else 'no friction'}, {rule_name(rule)}"
        )
        yield f"  {label}: V = {point.shear:.2f} N, M = {point.torque:.4f} N m"

"""What the rules in closed form say of one case: the law, the safe rule and SiDMACIB.

They know no pieces, so there is nothing to run: the answer is told at once, or why there is none.
"""

from collections.abc import Iterator
from itertools import product

from analysis.looks import look_of, option_name, rule_name
from sidmacib.contact_points.programme import Sidmacib, capacity
from sidmacib.contact_points.reductions import REDUCTIONS
from sidmacib.errors import CapacityError
from sidmacib.joint import Direction
from sidmacib.rule.law import RULES, LawCapacity
from workflow.case import REFERENCE
from workflow.cases import Place
from workflow.consistency import needs
from workflow.models import LAWS, MODELS
from workflow.schema import Study

WITHOUT_WEIGHTS = ("none", "half")  # reductions that need nothing but the number of locks


def law_capacity(
    study: Study, name: str, sample: str, ratio: float, variant: str = REFERENCE
) -> LawCapacity:
    """What the law or the safe rule, ``name``, gives for a sample at ``ratio``, e / a.

    ValueError or `CapacityError` where it has no answer.
    """
    change = study.every_variant[variant]
    assembly = change.assembly(study.assembly)
    if (reason := MODELS[name].refusal(needs(study, assembly, sample))) is not None:
        raise ValueError(reason)
    return RULES[name](study.joint(sample, change), Direction(ratio), assembly.push)


def describe(study: Study, name: str, place: Place) -> str:
    """What the rule ``name`` gives at ``place``, in words.

    ValueError or `CapacityError` where it has no answer.
    """
    told = _law if name in LAWS else _sidmacib
    return "\n".join(told(study, name, place))


def _law(study: Study, name: str, place: Place) -> Iterator[str]:
    found = law_capacity(study, name, place.sample, place.ratio, place.variant)
    yield f"{look_of(name).name}: V = {found.shear:.2f} N, M = {found.torque:.4f} N m"
    yield f"  load along the path: {found.load:.2f} N"


def _sidmacib(study: Study, name: str, place: Place) -> Iterator[str]:
    joint = study.joint(place.sample, study.every_variant[place.variant])
    direction = Direction(place.ratio)
    yield f"{look_of(name).name}, by rules that need no weights; tables/capacity.csv has all"
    rules = [rule for rule in study.sidmacib.reductions if rule in WITHOUT_WEIGHTS]
    for rule, (option, points), friction in product(
        rules, study.sidmacib.options.items(), (False, True)
    ):
        strength = REDUCTIONS[rule](joint, ())
        model = Sidmacib(
            joint, points.contact_option(), strength, friction, study.sidmacib.overload
        )
        found = capacity(model, direction)
        told = (
            f"{option_name(option)}, {'friction' if friction else 'no friction'}, {rule_name(rule)}"
        )
        yield f"  {told}: V = {found.shear:.2f} N, M = {found.torque:.4f} N m"


ERRORS = (CapacityError, ValueError)  # of a rule that has no answer

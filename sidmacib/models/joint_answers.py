"""Which models answer for a joint, what they say, and whether it carries a load.

Models are imported where they are used: a solver takes longer to load than the law to answer.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial
from typing import TYPE_CHECKING

from sidmacib.answers.answer import LIMIT, STATIC, Answer
from sidmacib.engines import ENGINES
from sidmacib.errors import CapacityError
from sidmacib.joint import Direction, Joint, UpperBody
from sidmacib.joint.loading import Loading, Push, posed
from sidmacib.problem import Failures, checked_share
from sidmacib.quantities import four_digits

if TYPE_CHECKING:
    from sidmacib.answers.verdict import Verdict
    from sidmacib.rule import LawCapacity
    from sidmacib.rule.inverse import Demand
    from sidmacib.rule.reliability import Reliability

WORDS = {
    **{"design": "the design resistance", "safe": "the safe rule", "law": "the law"},
    **{"static": "the static model", "limit": "limit analysis", "sidmacib": "SiDMACIB"},
    **{name: engine.label for name, engine in ENGINES.items()},
}


def usual_models(joint: Joint) -> tuple[str, ...]:
    """The default models: those that answer at once."""
    return ("safe", "law", "static") if joint.elastic is None else ("safe", "law")


def _by_rule(
    name: str,
    rule: "str | Callable[..., LawCapacity]",
    margin: str,
    failure: str,
    joint: Joint,
    direction: Direction,
    push: Push,
) -> Answer:
    """The answer of a rule with its ``margin``, and the ``failure`` unless the joint moves away."""
    from sidmacib.rule import RULES

    found = (RULES[rule] if isinstance(rule, str) else rule)(joint, direction, push=push)
    notes = tuple(filter(None, (margin, found.moves or failure)))
    return Answer(model=name, value=found.load, notes=notes)


def _static(joint: Joint, direction: Direction, push: Push) -> Answer:
    from sidmacib.answers.joint import joint_answer, joint_mesh_error
    from sidmacib.mesh_error import SETTLED

    loading = Loading(direction, push=push)
    found, error = joint_answer(joint, loading), joint_mesh_error(joint, loading)
    notes: tuple[str, ...] = (found.why,)
    if error is not None and error > SETTLED:
        notes = (*notes, "not converged: use the first failure")
    first = float(found.solution.first_failure_load)
    return Answer(
        model=STATIC,
        value=found.load,
        failures=Failures(first, found.load),
        mesh_error=error,
        spread=found.solution.spread,
        notes=notes,
    )


def _limit(joint: Joint, direction: Direction, push: Push) -> Answer:
    from sidmacib.answers.joint import meshes
    from sidmacib.mechanics.limit import limit_load

    problem = posed(joint, Loading(direction, push=push), meshes(joint)[1])
    notes = ("ductile bonds, no friction",)
    return Answer(model=LIMIT, value=float(limit_load(*problem).load), notes=notes)


def _sidmacib(joint: Joint, direction: Direction, push: Push) -> Answer:
    from sidmacib.contact_points import OPTIONS, active
    from sidmacib.contact_points.programme import Sidmacib, capacity
    from sidmacib.rule.pairs import bearing_pairs

    counted = bearing_pairs(joint, push)
    model = Sidmacib(joint, OPTIONS["option4"], active(joint, counted), friction=False)
    notes = (f"Option 4, {counted} locks count", "assumed points")
    return Answer(model="sidmacib", value=capacity(model, direction).load, notes=notes)


def _engine(joint: Joint, direction: Direction, push: Push, name: str) -> Answer:
    from sidmacib.answers.joint import meshes
    from sidmacib.engines.results import disagreement
    from sidmacib.engines.run import EngineError, engine_outcome

    engine, loading = ENGINES[name], Loading(direction, push=push)
    problem = posed(joint, loading, meshes(joint)[1])
    try:
        found = engine_outcome(engine, problem)
    except EngineError as error:
        raise CapacityError(error.in_short) from None
    checked_share(problem, found)
    load, first = found.state.load, found.first_failure_load
    peak = None if engine.first_failure_only else load
    notes = [f"failure mode: {found.mode}", f"{engine.label} {engine.version()}"]
    if static := _static_failures(joint, loading, peak is None):
        notes.append(disagreement(peak, first, static))
    failures = None if first is None else Failures(first, load)
    return Answer(model=name, value=load, failures=failures, notes=tuple(filter(None, notes)))


def _static_failures(joint: Joint, loading: Loading, first_only: bool) -> Failures | None:
    """First failure and peak (N) of the static model on the engines' nodes; None if it has none.

    ``first_only``: without the peak, which takes minutes for elastic blocks.
    """
    from sidmacib.answers.joint import joint_answer, meshes
    from sidmacib.mechanics.static import static_first_failure

    try:
        if first_only:
            first = static_first_failure(*posed(joint, loading, meshes(joint)[1])).point.load
            return Failures(float(first), math.nan)
        found = joint_answer(joint, loading)
    except ERRORS:
        return None
    return Failures(float(found.solution.first_failure_load), found.load)


Model = Callable[[Joint, Direction, Push], Answer]
ERRORS = (CapacityError, ValueError, ArithmeticError)  # of models that have no answer
MODELS: dict[str, Model] = {
    "safe": partial(_by_rule, "safe", "safe", "margin for the model", ""),
    "law": partial(_by_rule, "law", "law", "", "first failure"),
    STATIC: _static,
    LIMIT: _limit,
    "sidmacib": _sidmacib,
    **{name: partial(_engine, name=name) for name in ENGINES},
}


def resistances(reliability: "Reliability", *, decides: bool) -> dict[str, Model]:
    """Characteristic and design resistance, of those that ``reliability`` asks for.

    ``decides``: whether one of them has to say if a load is carried.
    """
    from sidmacib.rule.reliability import resistances as asked

    words = {
        "characteristic": ("", "5 % fractile of the first failure"),
        "design": (f"gamma_M {reliability.partial_factor:g} and the safe rule's margin", ""),
    }
    rules = asked(reliability, decides=decides).items()
    return {name: partial(_by_rule, name, rule, *words[name]) for name, rule in rules}


def meaning(reliability: "Reliability", joint: Joint) -> Iterator[str]:
    """What the strengths and the upper block of ``joint`` are taken for, in a line each."""
    factored = reliability.partial_factor != 1.0
    if reliability.variation:
        words = f"Strengths are means with a scatter of {100.0 * reliability.variation:g} %"
        yield f"{words}." if factored else f"{words}; no gamma_M is given."
    elif factored:
        yield "Strengths are taken as characteristic values."
    else:
        words = "Strengths are taken as design values"
        yield f"{words}; if they are means, give --scatter and --gamma-m."
    if joint.upper_body is UpperBody.COLUMNS and joint.locks > 1:
        yield "The upper block is cut into columns, as in the paper."


def answer_of(name: str, model: Model, joint: Joint, direction: Direction, push: Push) -> Answer:
    """What a ``model`` of this ``name`` answers; one that refuses the joint has an error."""
    try:
        return model(joint, direction, push)
    except ERRORS as error:
        return Answer(model=name, error=error)


def deciding(models: Iterable[str]) -> str:
    """Which of ``models`` decides: the design resistance, else the safe rule, else the first."""
    known = [*models]
    return next(name for name in ("design", "safe", *known) if name in known)


def joint_verdict(demand: "Demand", joint: Joint, answers: Mapping[str, Answer]) -> "Verdict":
    """Whether ``joint`` carries the load of ``demand``, by ``answers`` in its direction, by model.

    By the one that is `deciding`.
    """
    from sidmacib.answers.verdict import Verdict, by_factors, factor_of

    load, direction = demand.load(joint), demand.direction(joint)
    name = deciding(answers)
    answer, by = answers[name], WORDS[name]
    if answer.value is None:
        return Verdict(load, False, f"{by} has no answer: {answer.note}", open=True)
    factor = answer.value / load
    both = (("V", direction.shear, "N"), ("M", direction.torque * joint.a, "N m"))
    what = ", ".join(f"{k} = {four_digits(load * of)} {unit}" for k, of, unit in both if of)
    words = by_factors(what, factor, f"{factor_of(factor)} by {by}")
    return Verdict(load, factor >= 1.0, words, decides=by, factor=factor)

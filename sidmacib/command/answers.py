"""Answers for one joint: rows of names and values, with units in the names.

Models are imported where they are used: a solver takes longer to load than the law to answer.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import product
from typing import TYPE_CHECKING, Any

from sidmacib.engines import ENGINES
from sidmacib.errors import CapacityError, reason
from sidmacib.joint import Direction, Joint, UpperBody
from sidmacib.joint.loading import Loading, Push, posed
from sidmacib.problem import Failures, checked_share
from sidmacib.quantities import four_digits

if TYPE_CHECKING:
    from sidmacib.answers.verdict import Verdict
    from sidmacib.rule import LawCapacity
    from sidmacib.rule.inverse import Demand
    from sidmacib.rule.reliability import Reliability

Row = dict[str, Any]
WORDS = {
    **{"design": "the design resistance", "safe": "the safe rule", "law": "the law"},
    **{"static": "the static model", "limit": "limit analysis", "sidmacib": "SiDMACIB"},
    **{name: engine.label for name, engine in ENGINES.items()},
}


@dataclass(frozen=True)
class Answer:
    """A model's load (N) along a direction, None if it has none, and further results.

    ``first_failure``: over the load; ``mesh_error``: of the load, over it; ``peak_spread``: see
    `sidmacib.mechanics.static.peaks`.
    """

    load: float | None
    note: str = ""
    first_failure: float | None = None
    mesh_error: float | None = None
    peak_spread: float | None = None


def usual_models(joint: Joint) -> tuple[str, ...]:
    """The default models: those that answer at once."""
    return ("safe", "law", "static") if joint.elastic is None else ("safe", "law")


def _by_rule(
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
    return Answer(found.load, "; ".join(filter(None, (margin, found.moves or failure))))


def _static(joint: Joint, direction: Direction, push: Push) -> Answer:
    from sidmacib.answers.joint import joint_answer, joint_mesh_error
    from sidmacib.mesh_error import SETTLED

    loading = Loading(direction, push=push)
    found, error = joint_answer(joint, loading), joint_mesh_error(joint, loading)
    late = "" if error is None or error <= SETTLED else "; not converged: use the first failure"
    return Answer(found.load, found.why + late, found.first_failure, error, found.solution.spread)


def _limit(joint: Joint, direction: Direction, push: Push) -> Answer:
    from sidmacib.answers.joint import meshes
    from sidmacib.mechanics.limit import limit_load

    problem = posed(joint, Loading(direction, push=push), meshes(joint)[1])
    return Answer(float(limit_load(*problem).load), "ductile bonds, no friction")


def _sidmacib(joint: Joint, direction: Direction, push: Push) -> Answer:
    from sidmacib.contact_points import OPTIONS, active
    from sidmacib.contact_points.programme import Sidmacib, capacity
    from sidmacib.rule.pairs import bearing_pairs

    counted = bearing_pairs(joint, push)
    model = Sidmacib(joint, OPTIONS["option4"], active(joint, counted), friction=False)
    note = f"Option 4, {counted} locks count; assumed points"
    return Answer(capacity(model, direction).load, note)


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
    first = None if first is None else first / load
    return Answer(load, "; ".join(filter(None, notes)), first)


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
    "safe": partial(_by_rule, "safe", "margin for the model", ""),
    "law": partial(_by_rule, "law", "", "first failure"),
    "static": _static,
    "limit": _limit,
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
    return {name: partial(_by_rule, rule, *words[name]) for name, rule in rules}


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


def capacity_rows(
    joint: Joint,
    ratios: Sequence[float],
    models: Mapping[str, Model],
    push: Push,
    progress: Callable[[str], object] = str,
) -> list[Row]:
    """Shear and torque that each model gives, in each direction e / a.

    A model that refuses the joint has a note in place of a load. ``progress`` is told what is
    computed next.
    """
    rows: list[Row] = []
    for ratio, name in product(ratios, models):
        direction = Direction(ratio)
        place = f"{len(rows) + 1} of {len(ratios) * len(models)}"
        progress(f"{place}: {name}, e/a = {ratio:g}")
        try:
            answer = models[name](joint, direction, push)
        except ERRORS as error:
            answer = Answer(None, reason(error))
        load = answer.load
        rows.append(
            {
                "e/a": "torsion" if math.isinf(ratio) else ratio,
                "model": name,
                "V (N)": None if load is None else load * direction.shear,
                "M (N m)": None if load is None else load * direction.torque * joint.a,
                "first failure / load": answer.first_failure,
                "mesh error / load": answer.mesh_error,
                "peak spread": answer.peak_spread,
                "note": answer.note,
            }
        )
    return rows


def with_factors(
    rows: Sequence[Row], demand: "Demand", joint: Joint
) -> "tuple[list[Row], Verdict]":
    """The ``rows`` with factors on the load of ``demand``, and the verdict.

    The design resistance decides, else the safe rule, else the first model that was asked.
    """
    from sidmacib.answers.verdict import Verdict, by_factors, factor_of

    direction, load = demand.direction(joint), demand.load(joint)
    shear, torque = load * direction.shear, load * direction.torque * joint.a
    key, needed = ("V (N)", shear) if shear else ("M (N m)", torque)
    found: dict[str, Row] = {}
    for row in rows:
        loads = {name: row[name] for name in ("e/a", "model", "V (N)", "M (N m)")}
        factor = None if row[key] is None else row[key] / needed
        found[row["model"]] = {**loads, "factor": factor, **row}
    name = next(name for name in ("design", "safe", *found) if name in found)
    factor, by = found[name]["factor"], WORDS[name]
    if factor is None:
        words = f"{by} has no answer: {found[name]['note']}"
        return [*found.values()], Verdict(load, False, words, open=True)
    both = (("V", shear, "N"), ("M", torque, "N m"))
    what = ", ".join(f"{k} = {four_digits(size)} {unit}" for k, size, unit in both if size)
    words = by_factors(what, factor, f"{factor_of(factor)} by {by}")
    return [*found.values()], Verdict(load, factor >= 1.0, words, decides=by, factor=factor)


def weight_rows(joint: Joint, ratio: float, push: Push) -> list[Row]:
    """Loads of the locks at the load that counts in the static model.

    `CapacityError` if there is none.
    """
    from sidmacib.answers.joint import joint_answer
    from sidmacib.joint.pieces import lock_weights

    found = joint_answer(joint, Loading(Direction(ratio), push=push))
    noise = 1e-9 * max(joint.strengths)  # rounding error of forces that balance
    return [
        {
            "lock": each.lock,
            "block": each.block,
            "weight": each.weight,
            "Vx (N)": each.shear_x_N if abs(each.shear_x_N) > noise else 0.0,
            "Vy (N)": each.shear_y_N if abs(each.shear_y_N) > noise else 0.0,
            "largest shear / cohesion": each.max_shear_ratio,
        }
        for each in lock_weights(joint, found.assembly, found.solution.peak.force)
    ]


def effect_rows(
    joint: Joint, ratio: float, push: Push, progress: Callable[[str], object]
) -> tuple[str, list[Row]]:
    """The first failure in words, and how it depends on each parameter, largest effects first.

    Effects are of V, in pure torsion of M. ``progress`` is told what is computed next.
    `CapacityError` if the static model has no such failure.
    """
    from sidmacib.answers.joint import meshes
    from sidmacib.joint.effects import sensitivity
    from sidmacib.joint.pieces import lock_faces

    loading = Loading(Direction(ratio), push=push)
    found = sensitivity(joint, loading, meshes(joint)[1], progress=progress)
    locks = lock_faces(joint)
    where = ", ".join(
        f"root of lock {locks[face]}" if face in locks else face for face in found.faces
    )
    loads = f"V = {found.shear:.4g} N, M = {found.torque:.4g} N m"
    rows = [
        {
            "parameter": each.name,
            "value": each.value,
            "unit": each.unit,
            "1 % more (%)": each.more,
            "1 % less (%)": each.less,
            f"derivative ({found.unit} per unit)": each.derivative,
            f"first failure ({found.unit})": found.amount,
            "note": each.note,
        }
        for each in found.effects
    ]
    words = f"First failure at {loads}: {where}."
    return words, sorted(rows, key=lambda row: -abs(row["1 % more (%)"] or 0.0))


def law_rows(joint: Joint, push: Push) -> list[Row]:
    """Numbers of effective locks in pure shear: the closed form, the law, the safe rule."""
    from sidmacib.rule.pairs import pairs_of

    pairs, pair_words = pairs_of(joint, push), "(n - 1) / 2 for an odd number of locks"
    endless, length = (
        value if math.isfinite(value) else None for value in (pairs.most, pairs.transfer_length)
    )
    length_words = "pairs over which lock forces fall to 1 / 2.718"
    results: list[tuple[str, Any, str]] = [
        ("bearing pairs of locks", pairs.count, pair_words),
        ("effective locks, closed form", pairs.working, "V / T0, without friction"),
        ("effective locks, endless joint", endless, "limit of the closed form for many locks"),
        ("transfer length", length, length_words),
    ]
    rules = {name: MODELS[name] for name in ("law", "safe")}
    for row in capacity_rows(joint, [0.0], rules, push):
        load = row["V (N)"]
        working = None if load is None else load / joint.T0
        results.append((f"effective locks, {row['model']}", working, row["note"]))
        results.append((f"V (N), {row['model']}", load, row["note"]))
    return [{"what": what, "value": value, "note": note} for what, value, note in results]

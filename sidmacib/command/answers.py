"""Answers for one joint: rows of names and values, with units in the names.

Models are imported where they are used: a solver takes longer to load than the law to answer.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from itertools import product
from typing import TYPE_CHECKING, Any

from sidmacib.joint import Direction, Joint
from sidmacib.joint.loading import Loading, Push
from sidmacib.models.joint_answers import MODELS, Model, answer_of, joint_verdict
from sidmacib.quantities import four_digits

if TYPE_CHECKING:
    from sidmacib.answers.answer import Answer
    from sidmacib.answers.verdict import Verdict
    from sidmacib.rule.inverse import Demand

Row = dict[str, Any]


def capacity_rows(
    joint: Joint,
    ratios: Sequence[float],
    models: Mapping[str, Model],
    push: Push,
    progress: Callable[[str], object] = str,
    demand: "Demand | None" = None,
    tell: Callable[[str], object] = str,
) -> "tuple[list[Row], Verdict | None]":
    """Shear and torque that each model gives, in each direction e / a.

    A model that refuses the joint has a note in place of a load. ``progress`` is told what is
    computed next, ``tell`` what is known. ``demand``: a load in the one direction; rows then have
    the factor on it, and there is a verdict.
    """
    rows: list[Row] = []
    answers: dict[str, Answer] = {}
    for ratio, name in product(ratios, models):
        direction = Direction(ratio)
        place = f"{len(rows) + 1} of {len(ratios) * len(models)}"
        progress(f"{place}: {name}, e/a = {ratio:g}")
        tell(f"{place}: {name}, e/a = {ratio:g} ...")
        answers[name] = answer = answer_of(name, models[name], joint, direction, push)
        load, failures = answer.value, answer.failures
        needed = None if demand is None else demand.load(joint)
        factor = {} if needed is None else {"factor": load and load / needed}
        rows.append(
            {
                "e/a": "torsion" if math.isinf(ratio) else ratio,
                "model": name,
                "V (N)": None if load is None else load * direction.shear,
                "M (N m)": None if load is None else load * direction.torque * joint.a,
                **factor,
                "first failure / load": failures.first / load if failures and load else None,
                "mesh error / load": answer.mesh_error,
                "peak spread": answer.spread,
                "note": answer.note,
            }
        )
        tell(f"{place}: {name}, e/a = {ratio:g}: {_loads_in_words(rows[-1])}")
    return rows, None if demand is None else joint_verdict(demand, joint, answers)


def _loads_in_words(row: Row) -> str:
    if row["V (N)"] is None:
        return f"no answer: {row['note']}"
    return f"V = {four_digits(row['V (N)'])} N, M = {four_digits(row['M (N m)'])} N m"


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
    loads = f"V = {four_digits(found.shear)} N, M = {four_digits(found.torque)} N m"
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
    for row in capacity_rows(joint, [0.0], rules, push)[0]:
        load = row["V (N)"]
        working = None if load is None else load / joint.T0
        results.append((f"effective locks, {row['model']}", working, row["note"]))
        results.append((f"V (N), {row['model']}", load, row["note"]))
    return [{"what": what, "value": value, "note": note} for what, value, note in results]

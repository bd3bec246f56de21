"""The first lines of a study's summary: common questions, each with an answer in one line.

How far each rule for the capacity of a joint is unsafe at most, and where, is found here too.
"""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from typing import Any

import numpy as np
import pandas as pd

from analysis.drawing import label_of, option_name, rule_name
from analysis.tables import winner
from sidmacib.engines import ENGINES
from sidmacib.engines.results import disagreement
from sidmacib.models import REFERENCE_MODEL, first_failure_only
from sidmacib.problem import Failures
from sidmacib.quantities import four_digits
from workflow.case import REFERENCE

# Smaller errors count as none: the distinct elements' peaks are not known more accurately.
PEAK_ACCURACY = 0.0025
AGREEMENT = 0.01  # of two models on the same nodes: larger differences are marked
OTHERS = ("limit", "law", "safe")  # models that are rules too: a load without a path to the peak
MESH_LIMIT = 0.02  # of a mesh error
AS_PRINTED = "as printed"  # the setting of samples with the friction that the paper prints
# Models whose loads are for design, the second where strengths are design values: what is asked,
# and what they rest on.
DESIGN = {
    "design": ("design resistance", "With the scatter and gamma_M of the study"),
    "safe": ("safe load", "By the safe rule"),
}
DEMANDED = "Does each joint carry the load?"
CARRIED = "What does each joint carry?"
SHOWN = 6  # samples in one answer


@dataclass(frozen=True)
class RuleError:
    """The largest error of a rule over a sample's directions: promised over carried load, less 1.

    ``rule``: a reduction of SiDMACIB, or the name of a model. ``error``: negative where the rule
    promises less in every direction. ``ratio``: the direction, e / a. ``mesh_error``: of the load
    carried there. ``option``: the safest option of SiDMACIB for the sample; None for a model.
    ``friction``: whether it acts along the locks.
    """

    rule: str
    error: float
    sample: str
    ratio: float
    mesh_error: float
    option: str | None = None
    friction: bool = False

    @property
    def safe(self) -> bool:
        """Whether the rule promises no more than is carried, as far as that is known."""
        return self.error <= PEAK_ACCURACY

    @property
    def name(self) -> str:
        """The rule in words."""
        return label_of(self.rule).name if self.option is None else rule_name(self.rule)


def rule_errors(
    tables: Mapping[str, pd.DataFrame], leading: Mapping[str, str], mesh: float
) -> list[RuleError]:
    """Each rule's error for each sample, rule by rule, against the sample's ``leading`` model.

    Of SiDMACIB by the best safe option of the sample, else the least unsafe. ``tables``: fit and
    capacity. ``mesh``: the one that is compared at (m).
    """
    capacity = tables["capacity"][np.isclose(tables["capacity"]["mesh_m"], mesh)]
    reference = capacity[capacity["variant"].eq(REFERENCE)].dropna(subset=["load_N"])
    carried = of_leading(reference, leading, mesh).set_index("case")
    fit = of_leading(tables["fit"], leading, mesh).reset_index(drop=True)
    unsafe = fit["largest_unsafe_error"]
    chosen = fit.assign(unsafe=unsafe > PEAK_ACCURACY)
    chosen["by"] = unsafe.where(chosen["unsafe"], fit["misfit"])
    chosen = chosen.sort_values(["unsafe", "by"], kind="stable")
    chosen = chosen.drop_duplicates(["reduction", "sample"]).sort_index()
    found = []
    for rule in tables["fit"]["reduction"].unique():
        for row in chosen[chosen["reduction"].eq(rule)].to_dict("records"):
            same = {name: row[name] for name in ("sample", "reduction", "option", "friction")}
            same["weights_from"] = row["model"]
            promised = capacity[np.logical_and.reduce([capacity[k].eq(v) for k, v in same.items()])]
            friction = bool(row["friction"])
            found.append(_worst(rule, row["sample"], promised, carried, row["option"], friction))
    for model, (sample, first) in product(OTHERS, leading.items()):
        promised = reference[reference["model"].eq(model) & reference["sample"].eq(sample)]
        if first != model and promised["case"].isin(carried.index).any():
            found.append(_worst(model, sample, promised, carried))
    return found


def _worst(
    rule: str, sample: str, promised: pd.DataFrame, carried: pd.DataFrame, *how: Any
) -> RuleError:
    """The largest error of what is ``promised`` over what is ``carried``, which is by case."""
    error = (promised.set_index("case")["load_N"] / carried["load_N"] - 1.0).dropna()
    at = carried.loc[error.idxmax()]
    place = float(at["eccentricity_over_a"]), float(at["mesh_error"])
    return RuleError(rule, float(error.max()), sample, *place, *how)


def worst_of(errors: Sequence[RuleError]) -> list[RuleError]:
    """The sample with the largest error for each rule, the rules in their order."""
    rules = dict.fromkeys(each.rule for each in errors)
    return [max((e for e in errors if e.rule == rule), key=lambda e: e.error) for rule in rules]


def direction_words(ratio: float) -> str:
    """A direction in words."""
    if math.isinf(ratio):
        return "torsion"
    return f"e/a = {ratio:g}" if ratio else "pure shear"


def varied(name: str, variant: str) -> str:
    """``name`` in a variant."""
    return name if variant == REFERENCE else f"{name}, {variant}"


@dataclass(frozen=True)
class Question:
    """A question, and its answer in a few words.

    ``by_sample``: the answer for each sample, by its name, on a line below where there are words
    for all of them. ``column``: what these answers are in a table of samples.
    """

    question: str
    answer: str = ""
    by_sample: Mapping[str, str] = field(default_factory=dict)
    column: str = ""

    @property
    def lines(self) -> Iterator[str]:
        """The answer as lines of text."""
        parts = listed(f"{sample} {words}" for sample, words in self.by_sample.items())
        yield f"{self.question} {self.answer or parts}"
        if parts and parts not in self.answer and self.answer:
            yield f"  {parts}"


def answers(
    tables: Mapping[str, pd.DataFrame], leading: Mapping[str, str], mesh: float
) -> list[Question]:
    """The answers, at the finest ``mesh`` (m); ``leading``: see the summary.

    Of samples that the paper has no numbers for, what they carry comes first. Each says so if cases
    of the study have no result.
    """
    found = [*_answers(tables, leading, mesh)]
    if tables["validation"].empty:
        found.sort(key=lambda each: each.question != CARRIED)
    if "demands" in tables:
        found.insert(0, _demanded(tables["demands"]))
    found = [each for each in found if each.answer or each.by_sample]
    without = tables["cases"]["error"].notna()
    if without.any():
        words = f"(incomplete: {without.sum()} of {len(without)} cases have no result)"
        found = [replace(each, question=f"{each.question} {words}") for each in found]
    return found


def _answers(
    tables: Mapping[str, pd.DataFrame], leading: Mapping[str, str], mesh: float
) -> Iterator[Question]:
    fit, best, published = (
        of_leading(tables[name], leading, mesh) for name in ("fit", "best_fit", "validation")
    )
    yield from _half(tables, leading, mesh)
    yield Question(
        "How many locks, each at full strength, fit the detailed model best?",
        by_sample={
            row.sample: f"{row.locks_that_count:.2f}"
            for row in best[best["friction"].eq(False)].itertuples()
        },
        column="best-fit number of locks",
    )
    yield from _design(of_cases(tables), own=tables["validation"].empty)
    winners = [winner(fit, sample, mesh) for sample in fit["sample"].unique()]
    yield Question(
        "Which option and rule of SiDMACIB fit the detailed model best?",
        by_sample={
            row["sample"]: f"{option_name(row['option'])}, {rule_name(row['reduction'])} "
            f"({percent(row['misfit'])})"
            for row in winners
        },
        column="best fit of SiDMACIB (misfit)",
    )
    yield Question(
        "How far are computed peaks from published ones?",
        by_sample={
            row.sample: f"{100 * float(row.relative_difference):+.2f} %"
            for row in published[published["quantity"].eq("dem_pure_shear_N")].itertuples()
        },
        column="difference from the published peak",
    )
    yield from _engines(tables["cases"])
    yield from _mesh(tables["capacity"], mesh)


def of_cases(tables: Mapping[str, pd.DataFrame]) -> pd.DataFrame:
    """The capacities where there are cases: not of a sample whose engines are all missing."""
    capacity = tables["capacity"]
    return capacity[capacity["case"].isin(tables["cases"]["case"])]


def percent(share: float) -> str:
    """A share as a percentage."""
    return f"{100 * share:.1f} %"


def listed(words: Iterable[str]) -> str:
    """The first of some clauses, and how many more there are."""
    every = list(words)
    more = f"; {len(every) - SHOWN} more below" if len(every) > SHOWN else ""
    return "; ".join(every[:SHOWN]) + more


def _half(
    tables: Mapping[str, pd.DataFrame], leading: Mapping[str, str], mesh: float
) -> Iterator[Question]:
    """Whether (n - 1) / 2 locks may be counted, with any option, and where not."""
    errors = [each for each in rule_errors(tables, leading, mesh) if each.rule == "half"]
    if not errors:
        return
    worst = worst_by_friction(errors, tables["validation"])
    unsafe = [
        f"{percent(error.error)}{words} ({error.sample}, {direction_words(error.ratio)})"
        for words, error in worst.items()
        if not error.safe
    ]
    yield Question(
        "Is it safe to count (n - 1) / 2 of the n locks of a joint?",
        f"No: unsafe by {' and by '.join(unsafe)}" if unsafe else "Yes, for these joints",
        {
            error.sample: ("safe" if error.safe else f"unsafe by {percent(error.error)}")
            + f" ({option_name(str(error.option))})"
            for error in errors
        },
        "(n - 1) / 2 locks",
    )


def worst_by_friction(
    errors: Sequence[RuleError], validation: pd.DataFrame
) -> dict[str, RuleError]:
    """The largest of one rule's ``errors``, by what is said of the friction of its sample.

    Where the study has the paper's samples with the friction as printed: of these first, and then
    of the other ones if it is larger. Elsewhere of all, of which nothing is said.
    """
    as_printed = set(validation.loc[validation["setting"].eq(AS_PRINTED), "sample"])
    printed = [error for error in errors if error.sample in as_printed]
    others = [error for error in errors if error.sample not in as_printed]
    if not (printed and others):
        return {"": worst_of(errors)[0]}
    (first,), (other,) = worst_of(printed), worst_of(others)
    found = {" with the friction as printed": first}
    return found | ({" with another friction": other} if other.error > first.error else {})


def of_leading(table: pd.DataFrame, leading: Mapping[str, str], mesh: float) -> pd.DataFrame:
    """The rows of each sample's ``leading`` model at a ``mesh`` (m)."""
    own = table["model"].eq(table["sample"].map(leading))
    return table[own & np.isclose(table["mesh_m"], mesh)]


def _demanded(demands: pd.DataFrame) -> Question:
    """Whether each joint carries the load that the study asks for."""
    verdicts = {row.sample: str(row.verdict) for row in demands.itertuples()}
    unknown = demands["open"].astype(bool)
    lost = demands.loc[~demands["carried"].astype(bool) & ~unknown, "sample"].tolist()
    words = "Yes"
    if lost:
        words = f"No: {listed(lost)} {'does' if len(lost) == 1 else 'do'} not"
    elif unknown.any():
        words = f"Open: no answer for {listed(demands.loc[unknown, 'sample'])}"
    return Question(DEMANDED, words, verdicts, "is the load carried?")


def _design(capacity: pd.DataFrame, *, own: bool) -> Iterator[Question]:
    """Design loads in the first and the last direction of each sample.

    Of joints of one's ``own`` the first model says what they carry.
    """
    loads = "V (N) or M (N m)"
    for model, (what, words) in DESIGN.items():
        rows = capacity[capacity["model"] == model]
        if rows.empty:
            continue
        found = _design_loads(rows)
        question, answer = f"What is the {what}?", f"{words}, {loads}; other directions below:"
        if own:
            told = listed(f"{name} {load}" for name, load in found.items())
            question, answer, own = CARRIED, f"{words}, {loads}: {told}", False
        yield Question(question, answer, found, f"{what}, {loads}")


def _design_loads(loads: pd.DataFrame) -> dict[str, str]:
    """By sample, in words."""
    parts, ratio = {}, "eccentricity_over_a"
    for sample, of_meshes in loads.groupby("sample", sort=False):
        rows = of_meshes.sort_values(ratio, kind="stable").drop_duplicates(ratio)  # all alike
        ends = rows.iloc[[0, -1] if len(rows) > 1 else [0]]
        known = ends["load_N"].notna().any()
        parts[sample] = ", ".join(map(_at, ends.itertuples())) if known else "no answer, see below"
    return parts


def _at(row: Any) -> str:
    """V of a row in pure shear, M in torsion, both in between; with the direction."""
    ratio = row.eccentricity_over_a
    if math.isinf(ratio):
        return "no answer" if math.isnan(row.shear_N) else f"M {four_digits(row.torque_Nm)}"
    loads = f"V {four_digits(row.shear_N)}" + (f" M {four_digits(row.torque_Nm)}" if ratio else "")
    loads = "no answer" if math.isnan(row.shear_N) else loads
    return f"{loads} at {direction_words(ratio)}" if ratio else loads


def _engines(cases: pd.DataFrame) -> Iterator[Question]:
    """Differences of the engines from the static model."""
    engines = cases[cases["model"].isin(list(ENGINES))]
    size = engines["difference_to_static"].abs().dropna()
    if len(size):
        names = ", ".join(label_of(model).name for model in engines["model"].unique())
        within = f"{names}: within {100 * size.max():.2g} % in {len(size)} cases"
        far = sum(model in ENGINES for _, model, _ in disagreements(cases))
        yield Question(
            "Do the engines agree with the static model?",
            f"No, not in {far} of {len(size)} cases. {within}" if far else within,
        )


def disagreements(cases: pd.DataFrame) -> list[tuple[str, str, str]]:
    """Cases and models that disagree with the static model on the same nodes, and on what."""
    static = cases[cases["model"].eq(REFERENCE_MODEL)]
    firsts = dict(zip(static["load_N"], static["first_failure_load_N"], strict=True))
    found = []
    for row in cases[compared_with_static(cases)].to_dict("records"):
        load, peak = row["load_N"], row["static_load_N"]
        if first_failure_only(row["model"]):
            words = disagreement(None, load, Failures(peak, peak))
        else:
            first = row["first_failure_load_N"]
            failures = Failures(firsts.get(peak, math.nan), peak)
            words = disagreement(load, None if pd.isna(first) else first, failures)
        if words:
            found.append((row["name"], row["model"], words))
    return found


def compared_with_static(table: pd.DataFrame) -> "pd.Series[bool]":
    """Which rows have a load that should be the static model's: not those of limit analysis."""
    return table["difference_to_static"].notna() & table["model"].ne("limit")


def _mesh(capacity: pd.DataFrame, mesh: float) -> Iterator[Question]:
    """Whether the finest mesh is fine enough."""
    selected = capacity[capacity["mesh_error"].notna() & np.isclose(capacity["mesh_m"], mesh)]
    if selected.empty:
        return
    row = selected.sort_values("mesh_error", kind="stable").iloc[-1]
    verdict = "No" if row["mesh_error"] > MESH_LIMIT else "Yes"
    yield Question(
        f"Is a mesh of {mesh:g} m fine enough?",
        f"{verdict}: mesh error up to {percent(row['mesh_error'])} ({row['model']}, {row['case']})",
    )

"""Largest unsafe error of each rule for the capacity of a joint, and its place."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from analysis.drawing.labels import label_of, option_name, rule_name
from workflow.case import REFERENCE

# Smaller errors count as none: the distinct elements' peaks are not known more accurately.
PEAK_ACCURACY = 0.0025
OTHERS = ("limit", "law", "safe")  # models that are rules too: a load without a path to the peak


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

    @property
    def option_words(self) -> str:
        """The option of SiDMACIB in words; empty for a model."""
        if self.option is None:
            return ""
        return option_name(self.option) + (" with friction" if self.friction else "")


def rule_errors(
    tables: Mapping[str, pd.DataFrame], leading: Mapping[str, str], mesh: float
) -> list[RuleError]:
    """Each rule's error for each sample, rule by rule, against the sample's ``leading`` model.

    ``tables``: fit, capacity and cases. ``mesh``: the one that is compared at (m).
    """
    capacity = tables["capacity"]
    ratios = tables["cases"].drop_duplicates("case").set_index("case")["eccentricity_over_a"]
    fit = tables["fit"]
    at_mesh = fit[np.isclose(fit["mesh_m"], mesh)]
    found = []
    for reduction in fit["reduction"].unique():
        for row in safest(at_mesh, leading, reduction):
            error, case, mesh_error = least_safe(capacity, row)
            place = row["sample"], float(ratios[case]), mesh_error
            found.append(RuleError(reduction, error, *place, row["option"], bool(row["friction"])))
    for model in OTHERS:
        found += _of_model(model, capacity[np.isclose(capacity["mesh_m"], mesh)], leading, ratios)
    return found


def worst_of(errors: Sequence[RuleError]) -> list[RuleError]:
    """The sample with the largest error for each rule, the rules in their order."""
    rules = dict.fromkeys(error.rule for error in errors)
    return [
        max((error for error in errors if error.rule == rule), key=lambda error: error.error)
        for rule in rules
    ]


def safest(fit: pd.DataFrame, leading: Mapping[str, str], reduction: str) -> Iterator[pd.Series]:
    """The best safe row of each sample by ``reduction``, else the least unsafe."""
    rows = fit[fit["reduction"].eq(reduction) & fit["model"].eq(fit["sample"].map(leading))]
    for sample in rows["sample"].unique():
        sample_rows = rows[rows["sample"] == sample]
        safe = sample_rows[sample_rows["largest_unsafe_error"] <= PEAK_ACCURACY]
        by = "largest_unsafe_error" if safe.empty else "misfit"
        yield (sample_rows if safe.empty else safe).sort_values(by, kind="stable").iloc[0]


def least_safe(capacity: pd.DataFrame, row: pd.Series) -> tuple[float, str, float]:
    """The largest error of a row of fits, the case that has it, and the mesh error there."""
    same = capacity[capacity["sample"].eq(row["sample"])]
    same = same[np.isclose(same["mesh_m"], row["mesh_m"])]
    carried = same[same["model"].eq(row["model"]) & same["variant"].eq(REFERENCE)]
    promised = same[
        same["weights_from"].eq(row["model"])
        & same["reduction"].eq(row["reduction"])
        & same["option"].eq(row["option"])
        & same["friction"].eq(row["friction"])
    ]
    return _largest(promised, carried)


def _of_model(
    model: str, capacity: pd.DataFrame, leading: Mapping[str, str], ratios: pd.Series
) -> Iterator[RuleError]:
    """The error of a model for each sample where it is not the leading one."""
    here = capacity[capacity["variant"].eq(REFERENCE)]
    for sample, first in leading.items():
        sample_rows = here[here["sample"].eq(sample)].dropna(subset=["load_N"])
        promised, carried = (
            sample_rows[sample_rows["model"].eq(model)],
            sample_rows[sample_rows["model"].eq(first)],
        )
        if first == model or not set(promised["case"]) & set(carried["case"]):
            continue
        error, case, mesh_error = _largest(promised, carried)
        yield RuleError(model, error, sample, float(ratios[case]), mesh_error)


def _largest(promised: pd.DataFrame, carried: pd.DataFrame) -> tuple[float, str, float]:
    by_case = carried.set_index("case")
    error = (promised.set_index("case")["load_N"] / by_case["load_N"] - 1.0).dropna()
    case = str(error.idxmax())
    return float(error.max()), case, float(by_case["mesh_error"][case])


def direction_words(ratio: float) -> str:
    """A direction in words."""
    if math.isinf(ratio):
        return "torsion"
    return f"e/a = {ratio:g}" if ratio else "pure shear"

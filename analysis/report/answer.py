"""The report's first screen: the question, its answer, and how far each rule can be trusted."""

import re
from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from analysis.drawing.labels import label_of
from analysis.drawing.sketch import sketch
from analysis.report.json_values import json_value
from analysis.report.provenance import sample_words
from analysis.summary.answers import Question, answers, percent, worst_by_friction
from analysis.summary.rules import (
    PEAK_ACCURACY,
    RuleError,
    direction_words,
    rule_errors,
    worst_of,
)
from analysis.summary.summary import leading_models
from workflow.schema import Study

NO_RULE = Question("What do the joints carry?", "See the curves and tables below.")
HYPHEN = re.compile(r"(?<![\w.-])-(?=\d)")  # before a number


def answer_content(study: Study, tables: Mapping[str, pd.DataFrame]) -> dict[str, Any]:
    """The first answer of the summary, the other ones, and the table of rules.

    ``named``: in words, the samples that the first answer names. ``sketch``: of the joint, as SVG.
    ``by_sample``: the answers that each sample has, as a table. ``rules``: of each rule its largest
    error, where, and whether it is safe, the least safe first.
    ``half``: how (n - 1) / 2 is drawn for each sample. ``sample``: the one that is shown first,
    where (n - 1) / 2, or else the least safe rule, is least safe: with the friction as printed if
    there are such samples.
    """
    leading, mesh = leading_models(tables["fit"]), min(study.meshes)
    errors = rule_errors(tables, leading, mesh)
    first, *others = [*answers(tables, leading, mesh)] or [NO_RULE]
    worst = sorted(worst_of(errors), key=lambda error: -error.error)
    half = [error for error in errors if error.rule == "half"]
    shown = next(iter(worst[:1]), None)
    if half:
        shown = next(iter(worst_by_friction(half, tables["validation"]).values()))
    return {
        "first": _words(first),
        "named": [
            words for name, words in sample_words(study).items() if f"({name}, " in first.answer
        ],
        "sketch": sketch(study.joint(shown.sample if shown else next(iter(study.samples)))),
        "others": [_words(each) for each in others if each.answer and not each.by_sample],
        "by_sample": _by_sample(study, [first, *others]),
        "safe": first.answer.startswith("Yes"),
        "rules": [_row(error) for error in worst],
        "caption": _caption(leading, mesh) if worst else "",
        "half": {
            error.sample: {"option": error.option, "friction": error.friction} for error in half
        },
        "sample": next(iter(study.samples)) if shown is None else shown.sample,
        "leading": leading,
        "mesh": mesh,
    }


def _words(answer: Question) -> dict[str, str]:
    return {
        "question": _typeset(answer.question),
        "answer": _typeset(answer.answer),
    }


def _by_sample(study: Study, given: Sequence[Question]) -> dict[str, Any]:
    """A table of the answers that are given sample by sample: ``columns`` and ``rows``."""
    shown = [answer for answer in given if answer.by_sample]
    return {
        "columns": [_typeset(answer.column) for answer in shown],
        "rows": [
            [words, *(_typeset(answer.by_sample.get(sample, "")) for answer in shown)]
            for sample, words in sample_words(study).items()
        ],
    }


def _typeset(words: str) -> str:
    """With the minus of numbers."""
    whole = words.replace("(n - 1) / 2", "(n \N{MINUS SIGN} 1)/2")
    return HYPHEN.sub("\N{MINUS SIGN}", whole)


def _row(error: RuleError) -> dict[str, Any]:
    return {
        "rule": _typeset(error.name),
        "option": error.option_words,
        "error": f"{100 * error.error:+.1f} %".replace("-", "\N{MINUS SIGN}"),
        "mesh_error": "" if pd.isna(error.mesh_error) else percent(error.mesh_error),
        "where": f"{error.sample}, {direction_words(error.ratio)}",
        "safe": error.safe,
        "ratio": json_value(error.ratio),
    }


def _caption(leading: Mapping[str, str], mesh: float) -> str:
    models = " and ".join(dict.fromkeys(label_of(name).name for name in leading.values()))
    return (
        "Worst case over all joints and load directions: predicted capacity / capacity by the "
        f"detailed model ({models}, mesh {1000 * mesh:g} mm) \N{MINUS SIGN} 1. Positive is unsafe; "
        f"up to +{100 * PEAK_ACCURACY:g} % is treated as zero. SiDMACIB uses the contact points "
        "that are safest for each joint. Mesh error: of the detailed model."
    )

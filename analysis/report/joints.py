"""The report's data of joints: its first screen, and charts.

The first screen has the question, its answer, and how far each rule can be trusted. The charts are
drawn from the tables, and a few load paths of the static model.
"""

import re
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import pandas as pd

from analysis.drawing import label_of, option_colour, option_name, rule_name, sketch
from analysis.paths import paths_of, pieces_of, shown_cases
from analysis.published import read_published
from analysis.report import failed_cases, finding, json_value
from analysis.summary import (
    AGREEMENT,
    PEAK_ACCURACY,
    Question,
    RuleError,
    answers,
    compared_with_static,
    direction_words,
    disagreements,
    percent,
    rule_errors,
    worst_by_friction,
    worst_of,
)
from analysis.summary.summary import leading_models
from sidmacib.errors import CapacityError
from sidmacib.joint import Direction, Joint
from sidmacib.joint.parameters import SIZES
from sidmacib.rule import RULES
from sidmacib.rule.pairs import pairs_of
from workflow.cases import cases_of
from workflow.schema import Study

NO_RULE = Question("What do the joints carry?", "See the curves and tables below.")
HYPHEN = re.compile(r"(?<![\w.-])-(?=\d)")  # before a number
PEAK = "dem_pure_shear_N"
NEAR = 0.005  # of a published number
LEAST_SHOWN = 5e-5  # share that two digits of a percentage show
NUMBERS_OF_LOCKS = (3, 4, 5, 6, 7, 9, 11, 13, 15)
# Of `numbers_of` a joint: what tells samples apart, in this order.
FEATURES = ("friction of dry faces", "a (mm)", "b (mm)", "h (mm)", "H (mm)", "T0 (N)")


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
    first, *others = answers(tables, leading, mesh) or [NO_RULE]
    alone = [first, *(each for each in others if each.answer and not each.by_sample)]
    texts = [
        {"question": _typeset(each.question), "answer": _typeset(each.answer)} for each in alone
    ]
    worst = sorted(worst_of(errors), key=lambda error: -error.error)
    half = [error for error in errors if error.rule == "half"]
    shown = list(worst_by_friction(half, tables["validation"]).values()) if half else worst
    sample = shown[0].sample if shown else next(iter(study.samples))
    told, by_sample = sample_words(study), [each for each in (first, *others) if each.by_sample]
    return {
        "first": texts[0],
        "named": [words for name, words in told.items() if f"({name}, " in first.answer],
        "sketch": sketch(study.joint(sample)),
        "others": texts[1:],
        "by_sample": {
            "columns": [_typeset(each.column) for each in by_sample],
            "rows": [
                [words, *(_typeset(each.by_sample.get(name, "")) for each in by_sample)]
                for name, words in told.items()
            ],
        },
        "safe": first.answer.startswith("Yes"),
        "rules": [_row(error) for error in worst],
        "caption": _caption(leading, mesh) if worst else "",
        "half": {
            error.sample: {"option": error.option, "friction": error.friction} for error in half
        },
        "sample": sample,
        "leading": leading,
        "mesh": mesh,
    }


def _typeset(words: str) -> str:
    """With the minus of numbers."""
    whole = words.replace("(n - 1) / 2", "(n \N{MINUS SIGN} 1)/2")
    return HYPHEN.sub("\N{MINUS SIGN}", whole)


def _row(error: RuleError) -> dict[str, Any]:
    return {
        "rule": _typeset(error.name),
        "option": option_name(error.option or "") + (" with friction" if error.friction else ""),
        "error": f"{100 * error.error:+.1f} %".replace("-", "\N{MINUS SIGN}"),
        "mesh_error": "" if pd.isna(error.mesh_error) else percent(error.mesh_error),
        "where": f"{error.sample}, {direction_words(error.ratio)}",
        "safe": error.safe,
    }


def _caption(leading: Mapping[str, str], mesh: float) -> str:
    models = " and ".join(dict.fromkeys(label_of(name).name for name in leading.values()))
    return (
        "Worst case over all joints and load directions: predicted capacity / capacity by the "
        f"detailed model ({models}, mesh {1000 * mesh:g} mm) \N{MINUS SIGN} 1. Positive is unsafe; "
        f"up to +{100 * PEAK_ACCURACY:g} % is treated as zero. SiDMACIB uses the contact points "
        "that are safest for each joint. Mesh error: of the detailed model."
    )


def law_of(joint: Joint) -> dict[str, list[Any]]:
    """Locks that work in pure shear, for joints like ``joint`` with more and fewer locks."""
    rows: dict[str, list[Any]] = {"locks": list(NUMBERS_OF_LOCKS), "closed": [], "half": []}
    rows |= {name: [] for name in RULES}
    for locks in NUMBERS_OF_LOCKS:
        similar = replace(joint, locks=locks, different=())
        rows["closed"].append(json_value(pairs_of(similar).working))
        rows["half"].append((locks - 1) / 2 if locks % 2 else None)
        for name, rule in RULES.items():
            try:
                rows[name].append(json_value(rule(similar, Direction(0.0)).load / similar.T0))
            except (CapacityError, ValueError):
                rows[name].append(None)
    return rows


def joints_verdict(tables: Mapping[str, pd.DataFrame], study: Study) -> list[dict[str, str]]:
    """Findings on the joints of a study."""
    return [
        *failed_cases(tables["cases"], "Cases without a result"),
        *_published(tables["validation"]),
        *_agreement(tables["cases"]),
        *verdict_of_spread(tables["capacity"]),
        finding(
            "Assumptions",
            "The positions of SiDMACIB's contact points."
            if tables["validation"].empty
            else "The positions of SiDMACIB's contact points, and a, b, h and H of the published "
            "joints: the paper gives only the product a·b.",
        ),
    ]


def _published(validation: pd.DataFrame) -> list[dict[str, str]]:
    peaks = validation[validation["quantity"].eq(PEAK) & validation["model"].ne("limit")]
    peaks = peaks.dropna(subset=["relative_difference"])
    if peaks.empty:
        return [finding("Published numbers", "None for the joints of this study.")]
    found = []
    for setting, part in peaks.groupby("setting", sort=True):
        worst = part.loc[part["relative_difference"].abs().idxmax()]
        size = abs(float(worst["relative_difference"]))
        found.append(
            finding(
                f"Published peaks, friction {part['friction'].iloc[0]:.4g} ({setting})",
                f"Largest difference {100 * size:.1f} %: {label_of(worst['model']).name} "
                f"{worst['computed']:.1f} N, published {worst['published']:g} N, "
                f"{worst['locks']} locks, mesh {1000 * worst['mesh_m']:g} mm.",
                "good" if size < NEAR else "note",
            )
        )
    return found


def _agreement(cases: pd.DataFrame) -> list[dict[str, str]]:
    compared = cases[compared_with_static(cases)]
    if compared.empty:
        return []
    worst = float(compared["difference_to_static"].abs().max())
    text = f"{len(compared)} cases with the same contact nodes: at most {100 * worst:.2f} % apart."
    if far := disagreements(cases):
        name, model, words = far[0]
        text += f" {len(far)} of them disagree, such as {name}: {label_of(model).name} {words}."
    kind = "good" if worst < AGREEMENT else "bad"
    return [finding("Engines against the static model", text, kind)]


def verdict_of_spread(capacity: pd.DataFrame) -> list[dict[str, str]]:
    """How far the peaks spread that the static model found."""
    spread = capacity["peak_spread"].dropna()
    if spread.empty:
        return []
    largest = spread.max()
    most = f"at most {100 * largest:.2f} %" if largest >= LEAST_SHOWN else "less than 0.005 %"
    words = (
        f"Peaks found from several starting points differ by {most}. The lowest one is reported."
    )
    kind = "good" if largest < AGREEMENT else "note"
    return [finding("Uniqueness of the static peak", words, kind)]


def joints_content(study: Study, tables: Mapping[str, pd.DataFrame]) -> dict[str, Any]:
    """Data of the page's charts of joints, beside the tables."""
    cases = shown_cases(cases_of(study).values())
    joints = {name: study.joint(name) for name in study.samples}
    return {
        "samples": list(study.samples),
        "words": sample_words(study),
        "sizes": {  # in SI units
            name: {
                "locks": joint.locks,
                "a_m": joint.a,
                "b_m": joint.b,
                "T0_N": float(f"{joint.T0:.6g}"),
                "friction": joint.dry.friction,
            }
            for name, joint in joints.items()
        },
        "meshes": sorted(study.meshes),
        "rules": {name: rule_name(name) for name in study.sidmacib.reductions},
        "options": {
            name: {"name": option_name(name), "colour": option_colour(name)}
            for name in study.sidmacib.options
        },
        "paths": paths_of(cases),
        "pieces": {case.subject.sample: pieces_of(case) for case in cases},
        # The rules of elastic blocks take minutes for many locks.
        "law": {
            name: law_of(joints[name])
            for name in study.interlocking
            if joints[name].elastic is None
        },
    }


def numbers_of(joint: Joint) -> dict[str, float]:
    """Sizes and materials of a joint, by their names with units."""
    inner, dry = joint.inner, joint.dry
    return {
        "locks": joint.locks,
        **{f"{size} (mm)": 1e3 * getattr(joint, size) for size in SIZES},
        "T0 (N)": joint.T0,
        "cohesion (kPa)": 1e-3 * inner.cohesion,
        "tensile strength (kPa)": 1e-3 * inner.tensile_strength,
        "Kn, inner faces (N/mm³)": 1e-9 * inner.normal_stiffness,
        "Ks, inner faces (N/mm³)": 1e-9 * inner.shear_stiffness,
        "Kn, dry faces (N/mm³)": 1e-9 * dry.normal_stiffness,
        "Ks, dry faces (N/mm³)": 1e-9 * dry.shear_stiffness,
        "friction of dry faces": dry.friction,
    }


def size_table(study: Study) -> dict[str, Any]:
    """`numbers_of` each sample as a table to be read: ``columns`` and ``rows``."""
    numbers = {name: numbers_of(study.joint(name)) for name in study.samples}
    return {
        "columns": ["joint", *next(iter(numbers.values()))],
        "rows": [
            [name, *(f"{each:.4g}" for each in own.values())] for name, own in numbers.items()
        ],
    }


def sample_words(study: Study) -> dict[str, str]:
    """Each sample in a few words: its locks, and of its sizes those that tell it from others."""
    numbers = {name: numbers_of(study.joint(name)) for name in study.samples}
    words = {name: f"{own['locks']} locks" for name, own in numbers.items()}
    published = read_published()
    for feature in FEATURES:
        values = {name: own[feature] for name, own in numbers.items()}
        if len(set(words.values())) < len(words) and len(set(values.values())) > 1:
            title = feature.partition(" of ")[0]
            words = {n: f"{words[n]}, {title} {values[n]:.4g}" for n in words}
            if title == "friction":
                printed = [n for n in published.samples(study) if published.as_printed(study, n)]
                words |= {name: f"{words[name]} as printed" for name in printed}
    return {name: f"{name}: {told}" for name, told in words.items()}

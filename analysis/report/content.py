"""What the report shows, as plain data: from tables, and a few paths of the static model."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import pandas as pd

from analysis.drawing.labels import SERIES, label_of, option_colour, option_name, rule_name
from analysis.report.paths import paths_of, pieces_of, shown_cases
from analysis.summary.summary import AGREEMENT, leading_models
from sidmacib.errors import CapacityError
from sidmacib.joint import Direction, Joint
from sidmacib.mechanics.solution import SPREAD_LIMIT
from sidmacib.rule.law import RULES
from sidmacib.rule.pairs import pairs_of
from workflow.case import REFERENCE
from workflow.cases import cases_of
from workflow.engines import ENGINES
from workflow.models import MODELS, REFERENCE_MODEL
from workflow.schema import Study
from workflow.times import read_times

PEAK = "dem_pure_shear_N"
NEAR = 0.005  # of a published number
NUMBERS_OF_LOCKS = (3, 4, 5, 6, 7, 9, 11, 13, 15)


def plain(table: pd.DataFrame) -> dict[str, Any]:
    """A table's columns and rows, as JSON has them: nothing for what is missing, text for inf."""
    return {
        "columns": list(table.columns),
        "rows": [[_plain(value) for value in row] for row in table.itertuples(index=False)],
    }


def _plain(value: Any) -> Any:
    if value is None or value is pd.NA or (isinstance(value, float) and math.isnan(value)):
        return None
    if isinstance(value, float):
        return "inf" if math.isinf(value) else float(f"{value:.6g}")
    return value.item() if hasattr(value, "item") else value


def looks() -> dict[str, dict[str, Any]]:
    """Name and colour of each model, and whether it is an engine, which is drawn by marks."""
    return {name: {**asdict(label_of(name)), "engine": name in ENGINES} for name in MODELS}


def law_of(joint: Joint) -> dict[str, list[Any]]:
    """Locks that work in pure shear, for joints like ``joint`` of more and fewer locks."""
    rows: dict[str, list[Any]] = {"locks": list(NUMBERS_OF_LOCKS), "closed": [], "half": []}
    rows |= {name: [] for name in RULES}
    for locks in NUMBERS_OF_LOCKS:
        own = replace(joint, locks=locks, different=())
        rows["closed"].append(_plain(pairs_of(own).working))
        rows["half"].append((locks - 1) / 2 if locks % 2 else None)
        for name, rule in RULES.items():
            try:
                rows[name].append(_plain(rule(own, Direction(0.0)).load / own.T0))
            except (CapacityError, ValueError):
                rows[name].append(None)
    return rows


def verdict(tables: Mapping[str, pd.DataFrame], study: Study) -> list[dict[str, str]]:
    """The findings that come first: a heading, what was found, and whether that is good."""
    return [
        *_failed(tables["cases"]),
        *_published(tables["validation"]),
        *_agreement(tables["cases"]),
        *_safe_rule(tables["capacity"], leading_models(tables["fit"])),
        *_mesh(tables["capacity"], study),
        *verdict_of_spread(tables["capacity"]),
        {
            "title": "What is assumed",
            "text": "The positions of the contact points."
            if tables["validation"].empty
            else "The positions of the contact points, and a, b, h and H of the published samples: "
            "the paper's text gives a·b only.",
            "kind": "note",
        },
    ]


def _failed(cases: pd.DataFrame) -> list[dict[str, str]]:
    failed = cases[cases["error"].notna()]
    if failed.empty:
        return []
    return [
        {
            "title": "Cases without a result",
            "text": f"{len(failed)} of {len(cases)}: they are listed at the end.",
            "kind": "bad",
        }
    ]


def _published(validation: pd.DataFrame) -> list[dict[str, str]]:
    peaks = validation[validation["quantity"].eq(PEAK) & validation["model"].ne("limit")]
    peaks = peaks.dropna(subset=["relative_difference"])
    if peaks.empty:
        return [
            {
                "title": "Published numbers",
                "text": "There are none for the samples of this study.",
                "kind": "note",
            }
        ]
    found = []
    for setting, part in peaks.groupby("setting", sort=True):
        worst = part.loc[part["relative_difference"].abs().idxmax()]
        size = abs(float(worst["relative_difference"]))
        found.append(
            {
                "title": f"Published peaks, friction {part['friction'].iloc[0]:.4g}, {setting}",
                "text": f"Largest deviation {100 * size:.1f} %: {label_of(worst['model']).name} "
                f"{worst['computed']:.1f} N, published {worst['published']:g} N, "
                f"{worst['locks']} locks, mesh {worst['mesh_m']:g} m.",
                "kind": "good" if size < NEAR else "note",
            }
        )
    return found


def _agreement(cases: pd.DataFrame) -> list[dict[str, str]]:
    held = cases[cases["difference_to_static"].notna() & cases["model"].ne("limit")]
    if held.empty:
        return []
    worst = float(held["difference_to_static"].abs().max())
    return [
        {
            "title": "Engines against the static model",
            "text": f"{len(held)} cases on the same nodes, at most {100 * worst:.2f} % apart.",
            "kind": "good" if worst < AGREEMENT else "bad",
        }
    ]


def _safe_rule(capacity: pd.DataFrame, leading: Mapping[str, str]) -> list[dict[str, str]]:
    """Revised SiDMACIB against the peaks of each sample's leading model, rule by rule."""
    rule = capacity[capacity["model"].eq("sidmacib") & capacity["reduction"].notna()]
    rule = rule[~rule["friction"].astype(str).eq("True") & rule["option"].eq("option4")]
    own = rule[rule["weights_from"].eq(rule["sample"].map(leading))]
    peaks = capacity[capacity["variant"].eq(REFERENCE)].set_index(["model", "case"])["load_N"]
    if own.empty or peaks.empty:
        return []
    against = peaks.reindex(pd.MultiIndex.from_frame(own[["weights_from", "case"]]))
    over = own["load_N"].to_numpy() / against.to_numpy() - 1.0
    known = own.assign(over=over).dropna(subset=["over"])
    told = []
    for name, part in known.groupby("reduction", sort=True):
        worst = part.loc[part["over"].idxmax()]
        words = f"unsafe by up to {100 * worst['over']:.1f} % ({worst['case']})"
        told.append(f"{rule_name(str(name))}: {words if worst['over'] > 0.0 else 'safe'}")
    models = ", ".join(label_of(name).name for name in dict.fromkeys(leading.values()))
    return [
        {
            "title": "Which rule is safe",
            "text": f"SiDMACIB, Option 4, no friction, against {models}. {'; '.join(told)}.",
            "kind": "note",
        }
    ]


def _mesh(capacity: pd.DataFrame, study: Study) -> list[dict[str, str]]:
    own = capacity[capacity["variant"].eq(REFERENCE) & capacity["mesh_m"].isin(study.meshes)]
    error = own.groupby("mesh_m")["mesh_error"].max().dropna()
    if error.empty:
        return []
    words = ", ".join(f"{100 * value:.1f} % at {mesh:g} m" for mesh, value in error.items())
    return [{"title": "Largest mesh error", "text": f"{words}.", "kind": "note"}]


def verdict_of_spread(capacity: pd.DataFrame) -> list[dict[str, str]]:
    """Which capacities of the static model are first failures, as peaks spread too far."""
    spread = capacity["peak_spread"].dropna()
    if spread.empty:
        return []
    far = int((spread > SPREAD_LIMIT).sum())
    words = (
        f"At most {100 * spread.max():.2f} %"
        if not far
        else (
            f"Above {100 * SPREAD_LIMIT:g} % in {far} of {len(spread)} capacities, up to "
            f"{100 * spread.max():.0f} % or more: there the first failure is told, and is no peak"
        )
    )
    return [
        {
            "title": "Spread of the static model's peaks",
            "text": f"{words}, under changes of the input by 1e-9.",
            "kind": "bad" if far else "good",
        }
    ]


def _ends(cases: pd.DataFrame) -> dict[str, str]:
    """What the end of the static model's path is, by case, where peaks spread too far."""
    own = cases[cases["model"].eq(REFERENCE_MODEL) & cases["variant"].eq(REFERENCE)]
    far = own[own["peak_spread"] > SPREAD_LIMIT]
    return {
        row.case: f"The capacity is the first failure, {row.first_failure_load_N:.4g} N: peaks "
        f"spread by {100 * float(row.peak_spread):.0f} % or more. End of this path"
        for row in far.itertuples()
    }


def times_of(results: Path) -> list[list[Any]]:
    """Seconds of each kind of job: on the clock, of processors; how many there were."""
    found: dict[str, list[float]] = {}
    for kind, told in read_times(results):
        own = found.setdefault(kind, [0.0, 0.0, 0.0])
        own[0] += 1
        own[1] += told["wall_s"]
        own[2] += told["own_cpu_s"] + told["programs_cpu_s"]
    return [[kind, int(n), round(wall, 1), round(cpu, 1)] for kind, (n, wall, cpu) in found.items()]


def content(
    study: Study, tables: Mapping[str, pd.DataFrame], shown: Sequence[str], results: Path
) -> dict[str, Any]:
    """All that the page is made from; ``shown``: tables that it has in full."""
    cases = shown_cases(cases_of(study).values())
    samples = {case.sample: case for case in cases}
    ends = _ends(tables["cases"])
    return {
        "samples": list(study.samples),
        "meshes": sorted(study.meshes),
        "rules": {name: rule_name(name) for name in study.sidmacib.reductions},
        "looks": looks(),
        "series": SERIES,
        "options": {
            name: {"name": option_name(name), "colour": option_colour(name)}
            for name in study.sidmacib.options
        },
        "verdict": verdict(tables, study),
        "paths": [path | {"end": ends.get(path["case"], "Peak")} for path in paths_of(cases)],
        "pieces": {name: pieces_of(case) for name, case in samples.items()},
        "law": {name: law_of(study.joint(name)) for name in study.interlocking},
        "tables": {name: plain(tables[name]) for name in shown},
        "failed": plain(
            tables["cases"].loc[tables["cases"]["error"].notna(), ["model", "name", "error"]]
        ),
        "times": times_of(results),
    }

"""The paper's numbers, the samples of a study that they can be compared with, and both in words.

`analysis.tables.comparisons` makes the table of validation, which is read here for people.
"""

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd
import yaml

from sidmacib.joint import Side, UpperBody
from workflow.schema import Study
from workflow.schema.sections import AssemblySection


@dataclass(frozen=True)
class Published:
    """The paper's numbers, see published.yaml."""

    numbers: dict[str, Any]

    def covers(self, study: Study, sample: str) -> bool:
        """Whether the paper has numbers for ``sample``, loaded as in ``study``.

        Strength, locks, their blocks, failure, the cut of the body, the hold-down and the load must
        be the paper's; sizes may differ, as it gives a * b only, and friction may, see
        `as_printed`. Its numbers are for e = 0.
        """
        joint, numbers = study.joint(sample), self.numbers["sample"]
        return (
            math.isclose(joint.T0, numbers["T0"])
            and joint.locks in self.numbers["weights"]
            and joint.first is Side.UPPER
            and not joint.different
            and study.assembly == AssemblySection(upper_body=UpperBody.COLUMNS)
            and 0.0 in study.eccentricities
        )

    def as_printed(self, study: Study, sample: str) -> bool:
        """Whether the dry faces of ``sample`` have the friction that the paper prints."""
        return math.isclose(
            study.joint(sample).dry.friction, self.numbers["sample"]["friction"], abs_tol=1e-12
        )

    def samples(self, study: Study) -> dict[str, int]:
        """Names and numbers of locks of the study's samples that the paper has."""
        return {n: s.locks for n, s in study.samples.items() if self.covers(study, n)}

    def dem_pure_shear(self, locks: int, mesh: float) -> float | None:
        """Published peak V at e = 0, in N, if there is one for this mesh (m)."""
        printed = self.numbers["dem_pure_shear"][locks]
        return next((float(v) for m, v in printed.items() if math.isclose(m, mesh)), None)


def read_published() -> Published:
    """The published numbers."""
    return Published(yaml.safe_load(Path(__file__).with_name("published.yaml").read_text()))


@dataclass(frozen=True)
class PublishedLine:
    """A published number and the rows of the validation table that belong to it, by sample."""

    quantity: str
    mesh: str
    published: float
    rows: Mapping[str, Any]


@dataclass(frozen=True)
class PublishedSamples:
    """Published numbers for ``locks`` locks, and the samples with as many: setting and model."""

    locks: int
    samples: Mapping[str, tuple[str, str]]
    lines: tuple[PublishedLine, ...]


def comparisons(table: pd.DataFrame, leading: Mapping[str, str]) -> Iterator[PublishedSamples]:
    """The validation table by number of locks; ``leading``: the model that is shown, by sample.

    SiDMACIB's numbers are those without friction along the locks; with it they are the same.
    """
    shown = (table["model"] == "sidmacib") | (table["model"] == table["sample"].map(leading))
    table = table[shown & ~table["quantity"].str.contains("_friction_N")]
    for locks, rows in table.groupby("locks"):
        by_line: dict[tuple[str, str], dict[str, Any]] = {}
        for row in rows.itertuples():
            mesh = "" if pd.isna(row.mesh_m) else f"{row.mesh_m:g}"
            by_line.setdefault((str(row.quantity), mesh), {})[str(row.sample)] = row
        samples = {
            str(row.sample): (
                f"friction {row.friction:.4g}, {row.setting}",
                leading.get(str(row.sample), "no model"),
            )
            for row in rows.drop_duplicates("sample").itertuples()
        }
        lines = tuple(
            PublishedLine(quantity, mesh, next(iter(line.values())).published, line)
            for (quantity, mesh), line in by_line.items()
        )
        yield PublishedSamples(int(str(locks)), samples, lines)


QUANTITIES = (  # of the validation table: pattern and label
    (r"sidmacib_pure_shear_option(\w+?)_(frictionless|friction)_N", r"SiDMACIB, Option \1, V (N)"),
    (r"dem_pure_shear_N", r"peak V of the pieces (N)"),
    (r"weight_lock(\d+)", r"weight of lock \1"),
    (r"weight_lock(\d+)_swapped", r"weight of lock \1, first two swapped"),
    (r"weight_sum", r"sum of weights"),
    (r"weight_sum_rounded_down", r"sum of weights, rounded down"),
    (r"best_option", r"option that fits best"),
)


def quantity_label(quantity: str) -> str:
    """A quantity of the validation table in words; an unknown one keeps its name."""
    for pattern, label in QUANTITIES:
        if match := re.fullmatch(pattern, quantity):
            return match.expand(label)
    return quantity


def difference_text(row: Any) -> str:
    """The difference of a row's computed value from the published one, in words."""
    if pd.isna(row.absolute_difference):
        return "same" if row.computed == row.published else "other"
    if pd.isna(row.relative_difference):
        return f"{row.absolute_difference:+.3f}"
    return f"{100 * row.relative_difference:+.2f} %"

"""Tables as the report shows them: values for JSON, headings with units, and words."""

import math
import re
from collections.abc import Mapping
from typing import Any

import pandas as pd

from analysis.drawing import label_of, option_name, rule_name
from analysis.published import quantity_label
from workflow.results.tables import TABLES, meaning

UNITS = {
    **{"J_m2": "J/m²", "m_s2": "m/s²", "m_s": "m/s"},
    **{"N": "N", "Nm": "N m", "m": "m", "m2": "m²", "m3": "m³", "Pa": "Pa"},
    **{"degrees": "°", "s": "s"},
}
# Of columns that hold a share, which is shown in percent.
SHARE = re.compile(r"_error$|^misfit$|difference$|difference_to_static$|_share$|peak_spread$")
SYMBOLS = {"shear_N": "V (N)", "torque_Nm": "M (N m)", "eccentricity_over_a": "e / a"}
CODE = re.compile(r"`([^`]*)`")
NAMED = {
    **dict.fromkeys(("model", "weights_from"), lambda name: label_of(name).name),
    **{"option": option_name, "reduction": rule_name, "quantity": quantity_label},
}


def json_table(table: pd.DataFrame) -> dict[str, Any]:
    """A table's columns and rows for JSON: None for a missing value, "inf" for an infinite one."""
    return {
        "columns": list(table.columns),
        "rows": [[json_value(value) for value in row] for row in table.itertuples(index=False)],
    }


def json_value(value: Any) -> Any:
    """A value of a table for JSON, with six digits."""
    if value is None or value is pd.NA or (isinstance(value, float) and math.isnan(value)):
        return None
    if isinstance(value, float):
        return "inf" if math.isinf(value) else float(f"{value:.6g}")
    return value.item() if hasattr(value, "item") else value


def finding(title: str, text: str, kind: str = "note") -> dict[str, str]:
    """A line of the report's verdict; ``kind``: good, bad or note."""
    return {"title": title, "text": text, "kind": kind}


def failed_cases(table: pd.DataFrame, title: str, what: str = "") -> list[dict[str, str]]:
    """A finding on the cases without a result, if there are any."""
    failed = int(table["error"].notna().sum())
    text = f"{failed} of {len(table)}{what}; they are listed at the end."
    return [finding(title, text, "bad")] if failed else []


def headings(tables: Mapping[str, pd.DataFrame]) -> dict[str, list[dict[str, Any]]]:
    """Of each column of each table its title, its meaning and what its numbers are shown times."""
    forms = {form.name: form for form in TABLES}
    found = {}
    for name, table in tables.items():
        own = []
        for column in table.columns:
            shares = bool(SHARE.search(column)) and pd.api.types.is_numeric_dtype(table[column])
            title = f"{_title(column)} (%)" if shares else SYMBOLS.get(column, _title(column))
            told = meaning(forms[name], column) if column in forms[name].columns else ""
            told = CODE.sub(lambda code: _title(code[1]), told)
            own.append({"title": title, "meaning": told, "times": 100 if shares else 1})
        found[name] = own
    return found


def words(tables: Mapping[str, pd.DataFrame]) -> dict[str, dict[str, str]]:
    """Names of models, options, rules and published numbers in words, column by column."""
    return {
        column: {
            str(name): spelled(str(name))
            for table in tables.values()
            if column in table
            for name in table[column].dropna().unique()
        }
        for column, spelled in NAMED.items()
    }


def _title(column: str) -> str:
    """A column's name without underscores, its unit in brackets."""
    for ending, unit in UNITS.items():
        if column.endswith(f"_{ending}"):
            return f"{_title(column.removesuffix(f'_{ending}'))} ({unit})"
    return column.replace("_over_", " / ").replace("_", " ")

"""Findings, tables and their values for JSON."""

import math
from typing import Any

import pandas as pd


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

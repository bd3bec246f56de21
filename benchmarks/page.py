"""Numbers of `make scaling`: how a study grows with its cases."""

from pathlib import Path

import pandas as pd

from studies.markdown import markdown

COLUMNS = {  # of the page, and those of the table
    "cases": ("cases", "{:,.0f}"),
    "jobs": ("jobs", "{:.0f}"),
    "first run (s)": ("wall_s", "{:.0f}"),
    "processors (s)": ("cpu_s", "{:.0f}"),
    "of these, cases (s)": ("cases_cpu_s", "{:.0f}"),
    "their table (s)": ("tables_cpu_s", "{:.0f}"),
    "again, nothing to do (s)": ("again_s", "{:.0f}"),
    "largest process (MB)": ("largest_process_MB", "{:.0f}"),
    "files": ("files", "{:.0f}"),
    "MB": ("MB", "{:.0f}"),
}


def growth(results: Path) -> str:
    """A row for each number of cases."""
    table = pd.read_csv(results / "tables/scaling.csv")
    rows = [
        [form.format(row[column]) for column, form in COLUMNS.values()]
        for row in table.to_dict("records")
    ]
    return markdown(list(COLUMNS), rows)


BLOCKS = {"scaling": growth}

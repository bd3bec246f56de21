"""The joints of a study's samplings, one row for each joint and direction; loads over T0."""

from collections.abc import Sequence

import numpy as np
import pandas as pd

from workflow.results.tables import SAMPLINGS, write_table
from workflow.run.step import Arguments, FileLists, Files, step


def samplings_table(batches: Sequence[pd.DataFrame]) -> pd.DataFrame:
    """The rows of all ``batches``."""
    table = pd.concat(batches, ignore_index=True).reindex(columns=SAMPLINGS.columns)
    table["stiffness_ratio"] = table["stiffness_ratio"].replace(np.inf, np.nan)  # rigid pieces
    return table


def run(arguments: Arguments, inputs: FileLists, outputs: Files) -> None:
    """Put the batches of all samplings together."""
    table = samplings_table([*map(pd.read_parquet, inputs["batches"])])
    write_table(SAMPLINGS, table, outputs["samplings"])


if __name__ == "__main__":
    step(run)

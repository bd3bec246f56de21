"""Rows of a batch of a design's joints: what both steps that go through such a batch share."""

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq

from sidmacib.fields import from_plain
from sidmacib.joint import Joint
from workflow.design import Design, designed


def write_rows(
    arguments: Mapping[str, Any], rows_of: Callable[..., Iterable[dict[str, Any]]], path: Path
) -> None:
    """Write what ``rows_of`` says of each joint from ``start`` to before ``stop`` of a design."""
    design, base = from_plain(Design, arguments["design"]), from_plain(Joint, arguments["base"])
    rows = [
        row
        for one in designed(design, base, arguments["start"], arguments["stop"])
        for row in rows_of(one, **arguments["asked"])
    ]
    pq.write_table(pa.Table.from_pandas(pd.DataFrame(rows)), path, compression="zstd")

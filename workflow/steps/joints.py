"""Batches of a sampling's joints: reading them from a job's arguments, and writing their rows."""

from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq

from sidmacib.joint.joint import Joint
from sidmacib.validation import dataclass_from
from workflow.sampling import SampledJoint, Sampling, sampled_joints


def joints_of(arguments: Mapping[str, Any]) -> Iterator[SampledJoint]:
    """The joints of a batch, from ``start`` to before ``stop``."""
    sampling = dataclass_from(Sampling, arguments["sampling"])
    base = dataclass_from(Joint, arguments["base"])
    return sampled_joints(sampling, base, arguments["start"], arguments["stop"])


def write_rows(sampling: str, rows: Iterable[Mapping[str, Any]], path: Path) -> None:
    """Write ``rows`` of a batch of a ``sampling`` as Parquet."""
    frame = pd.DataFrame([{"sampling": sampling, **row} for row in rows])
    pq.write_table(pa.Table.from_pandas(frame), path, compression="zstd")

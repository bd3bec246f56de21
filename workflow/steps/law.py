"""What the chain of springs says of a batch of a design's joints, in all directions."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq

from sidmacib.errors import CapacityError
from sidmacib.joint import Direction, Joint
from sidmacib.law.chain import first_failure
from sidmacib.law.pairs import pairs_of
from sidmacib.loading import Loading
from workflow.design import Design, Designed, designed
from workflow.plain import read_plain


def run(arguments: Mapping[str, Any], inputs: Sequence[Path], outputs: Sequence[Path]) -> None:
    """Write the rows of the joints from ``start`` to before ``stop``."""
    design, base = read_plain(Design, arguments["design"]), read_plain(Joint, arguments["base"])
    rows = [
        row
        for one in designed(design, base, arguments["start"], arguments["stop"])
        for row in law_rows(one, **arguments["asked"])
    ]
    pq.write_table(pa.Table.from_pandas(pd.DataFrame(rows)), outputs[0], compression="zstd")


def law_rows(one: Designed, eccentricities: Sequence[float]) -> Iterator[dict[str, Any]]:
    """The law's load over T0 along each direction e / a, and the closed form of the pairs."""
    row = pairs_of(one.joint, one.push)
    for ratio in map(float, eccentricities):
        told: dict[str, Any] = {
            "number": one.number,
            "eccentricity_over_a": ratio,
            "pairs": row.count,
            "closed_form": row.working,
            "most": row.most,
            "law": None,
            "cut_fails": None,
            "law_error": None,
        }
        try:
            state = first_failure(one.joint, Loading(Direction(ratio), push=one.push))
            told |= {"law": state.load / one.joint.T0, "cut_fails": state.cut_fails}
        except (CapacityError, ValueError) as error:
            told["law_error"] = str(error)
        yield told

"""Results of the law for a batch of a sampling's joints, in all directions."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Any

import pandas as pd

from sidmacib.errors import CapacityError
from sidmacib.joint import Direction, HoldDown, Joint, UpperBody
from sidmacib.joint.loading import Loading
from sidmacib.rule import RULES, first_failure
from sidmacib.rule.pairs import pairs_of
from workflow.sampling import SampledJoint, joints_of
from workflow.step import Arguments, Files, step

MANY = 41  # locks


def run(arguments: Arguments, inputs: Files, outputs: Files) -> None:
    """Write the rows of a batch."""
    rows = pd.DataFrame(law_rows(joints_of(arguments), arguments["eccentricities"]))
    rows.insert(0, "sampling", arguments["name"])
    rows.to_parquet(outputs["joints"], compression="zstd")


def law_rows(
    joints: Iterable[SampledJoint], eccentricities: Sequence[float]
) -> Iterator[dict[str, Any]]:
    """Loads over T0 by the law and the safe rule along each direction e / a, and the closed form.

    ``pairs``, ``closed_form``: pairs of locks, and how many locks work by the closed form.
    """
    for one in joints:
        pairs = pairs_of(one.joint, one.push)
        saturation = _saturation(one.joint)
        for ratio in map(float, eccentricities):
            row: dict[str, Any] = {
                "number": one.number,
                "eccentricity_over_a": ratio,
                "pairs": pairs.count,
                "closed_form": pairs.working,
                "saturation": saturation,
                "law_error": None,
                **dict.fromkeys(RULES),
            }
            try:
                for name, rule in RULES.items():
                    row[name] = rule(one.joint, Direction(ratio), one.push).load / one.joint.T0
            except (CapacityError, ValueError) as error:
                row["law_error"] = str(error)
            yield row


def _saturation(joint: Joint) -> float | None:
    """Locks that work in pure shear of `MANY` smooth columns under a plate; None: not columns."""
    if joint.upper_body is not UpperBody.COLUMNS:
        return None
    long = replace(
        joint,
        locks=MANY,
        dry=replace(joint.dry, friction=0.0),
        hold_down=HoldDown.plate(),
    )
    try:
        return first_failure(long, Loading(Direction(0.0))).load / long.T0
    except (CapacityError, ValueError):
        return None


if __name__ == "__main__":
    step(run)

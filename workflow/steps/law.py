"""What the law says of a batch of a design's joints, in all directions."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from sidmacib.chain.failure import first_failure
from sidmacib.chain.pairs import pairs_of
from sidmacib.chain.rule import RULES
from sidmacib.errors import CapacityError
from sidmacib.hold_down import HoldDown
from sidmacib.joint import Direction, Joint, UpperBody
from sidmacib.loading import Loading
from workflow.design import Designed
from workflow.steps.joints import write_rows

MANY = 41  # locks


def run(
    arguments: Mapping[str, Any], inputs: Mapping[str, Path], outputs: Mapping[str, Path]
) -> None:
    """Write the rows of the joints from ``start`` to before ``stop``."""
    write_rows(arguments, law_rows, outputs["joints"])


def law_rows(one: Designed, eccentricities: Sequence[float]) -> Iterator[dict[str, Any]]:
    """The law's load over T0 along each direction e / a, and the closed form of the pairs."""
    row = pairs_of(one.joint, one.push)
    saturation = _saturation(one.joint)
    for ratio in map(float, eccentricities):
        told: dict[str, Any] = {
            "number": one.number,
            "eccentricity_over_a": ratio,
            "pairs": row.count,
            "closed_form": row.working,
            "saturation": saturation,
            "law_error": None,
            **dict.fromkeys(RULES),
        }
        try:
            for name, rule in RULES.items():
                told[name] = rule(one.joint, Direction(ratio), one.push).load / one.joint.T0
        except (CapacityError, ValueError) as error:
            told["law_error"] = str(error)
        yield told


def _saturation(joint: Joint) -> float | None:
    """Locks that work in pure shear of many columns, all smooth and under a plate."""
    if joint.upper_body is not UpperBody.COLUMNS:  # one piece has no such number
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

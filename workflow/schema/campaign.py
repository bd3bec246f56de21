"""The campaign that a study belongs to: a folder of `studies` with jobs of its own."""

from pathlib import Path
from typing import Annotated, Any

from pydantic import BeforeValidator

from workflow.schema.values import shown

STUDIES = Path(__file__).parents[2] / "studies"


def campaign(value: Any) -> str:
    """A folder of ``studies`` that has a module ``jobs``."""
    known = sorted(path.parent.name for path in STUDIES.glob("*/jobs.py"))
    if value not in known:
        raise ValueError(f"{shown(value)} is not allowed; it must be one of {', '.join(known)}")
    return str(value)


Campaign = Annotated[str, BeforeValidator(campaign)]

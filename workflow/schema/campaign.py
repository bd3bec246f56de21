"""The campaign that a study belongs to: a folder of `studies` with additional rules."""

import importlib
from pathlib import Path
from typing import Annotated, Any

from pydantic import BeforeValidator

from sidmacib.quantities import shown

STUDIES = Path(__file__).parents[2] / "studies"


def campaign(value: Any) -> str:
    """A folder of ``studies`` with additional rules."""
    known = sorted(path.parent.name for path in STUDIES.glob("*/rules.smk"))
    if value not in known:
        raise ValueError(f"{shown(value)} is not allowed; it must be one of {', '.join(known)}")
    return str(value)


Campaign = Annotated[str, BeforeValidator(campaign)]


def required_sections(name: str) -> tuple[str, ...]:
    """Sections of the configuration that the campaign ``name`` requires."""
    package = importlib.import_module(f"studies.{name}")
    return tuple(getattr(package, "REQUIRED_SECTIONS", ()))

"""The campaign that a study belongs to: a folder of `studies` with additional rules."""

import importlib
from pathlib import Path
from typing import Annotated

from sidmacib.quantities import one_of

STUDIES = Path(__file__).parents[2] / "studies"


Campaign = Annotated[str, one_of(sorted(path.parent.name for path in STUDIES.glob("*/rules.smk")))]


def required_sections(name: str) -> tuple[str, ...]:
    """Sections of the configuration that the campaign ``name`` requires."""
    package = importlib.import_module(f"studies.{name}")
    return tuple(getattr(package, "REQUIRED_SECTIONS", ()))

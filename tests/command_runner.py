"""The command as tests run it."""

import json
from pathlib import Path
from typing import Any

from click.testing import CliRunner, Result

from sidmacib.command.main import main


def run(*arguments: str) -> Result:
    return CliRunner().invoke(main, list(arguments))


def answers(*arguments: str) -> list[dict[str, Any]]:
    found = run(*arguments, "--format", "json")
    assert found.exit_code == 0, found.output
    return list(json.loads(found.stdout))


def by_model(path: Path, description: Any, *options: str) -> dict[str, dict[str, Any]]:
    """What models answer for a structure as a file describes it; the file is written."""
    path.write_text(json.dumps(description))
    return {str(row["model"]): row for row in answers("assembly", str(path), *options)}

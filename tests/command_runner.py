"""The command as tests run it."""

import json
from pathlib import Path
from typing import Any

import yaml
from click.testing import CliRunner, Result

from sidmacib.command import output
from sidmacib.command.main import main

output.PATIENCE = 3600.0  # functions may have to be compiled first


def run(*arguments: str) -> Result:
    return CliRunner().invoke(main, list(arguments))


def answers(*arguments: str) -> list[dict[str, Any]]:
    found = run(*arguments, "--format", "json")
    assert found.exit_code == 0, found.output
    return list(json.loads(found.stdout)["rows"])


def assembly(path: Path, description: Any, *options: str) -> Result:
    """The command for a structure as a file describes it; the file is written."""
    path.write_text(yaml.safe_dump(description, sort_keys=False))
    return run("assembly", str(path), *options)


def by_model(path: Path, description: Any, *options: str) -> dict[str, dict[str, Any]]:
    """What models answer for a structure as a file describes it; the file is written."""
    found = assembly(path, description, "--format", "json", *options)
    return {row["model"]: row for row in json.loads(found.stdout)["rows"]}

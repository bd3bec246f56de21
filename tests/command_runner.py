"""The command as tests run it."""

import json

from click.testing import CliRunner, Result

from sidmacib.command.main import main


def run(*arguments: str) -> Result:
    return CliRunner().invoke(main, list(arguments))


def answers(*arguments: str) -> list[dict[str, object]]:
    found = run(*arguments, "--format", "json")
    assert found.exit_code == 0, found.output
    return list(json.loads(found.output))

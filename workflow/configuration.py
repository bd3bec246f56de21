"""Read a study's configuration: from a mapping or a YAML file, every fault in one line."""

import argparse
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml
from pydantic import ValidationError

from workflow.engines import ENGINES
from workflow.study import Study


class ConfigError(ValueError):
    """The configuration is not valid; the arguments are lines, one for each fault."""

    def __str__(self) -> str:
        return "\n".join(map(str, self.args))


def read_study(config: Mapping[str, Any]) -> Study:
    """The study that ``config`` describes; raises `ConfigError`."""
    try:
        return Study.model_validate(config)
    except ValidationError as error:
        faults = error.errors(include_url=False)
        # A list is reported as too short as well when its only item is at fault.
        faults = [f for f in faults if f["type"] != "too_short"] or faults
        raise ConfigError(*dict.fromkeys(map(_one_line, faults))) from None


def _one_line(fault: Any) -> str:
    place = [str(part) for part in fault["loc"]]
    if fault["type"] == "extra_forbidden":
        return f"{'.'.join(place)}: unknown key; allowed here are {', '.join(_keys(place[:-1]))}"
    if fault["type"] == "missing":
        return f"{'.'.join(place)}: missing"
    if fault["type"] == "string_pattern_mismatch":
        where = ".".join(place[:-2])
        return f"{where}: got {fault['input']!r}, allowed are letters, digits, _ and . in a name"
    if fault["type"] == "value_error":  # one of our own, which names the key or what stands in it
        return ": ".join(filter(None, [".".join(place), str(fault["ctx"]["error"])]))
    message = fault["msg"][0].lower() + fault["msg"][1:]
    message = message.replace("valid tuple", "list").replace("valid dictionary", "mapping")
    return f"{'.'.join(place)}: got {fault['input']!r}, {message}"


def _keys(place: list[str]) -> list[str]:
    """Keys of the section at ``place``."""
    schema = Study.model_json_schema()
    node: dict[str, Any] = schema
    for part in place:
        of_any_name = node.get("patternProperties", {"": node.get("additionalProperties")})
        below = node.get("properties", {}).get(part) or next(iter(of_any_name.values())) or {}
        node = schema["$defs"][below["$ref"].rsplit("/", 1)[1]] if "$ref" in below else below
    return list(node.get("properties", {}))


def read_study_file(path: Path, results: str | None = None) -> Study:
    """The study in the YAML file ``path``, perhaps with another results folder.

    Ends the program with a line for each fault.
    """
    try:
        config = yaml.safe_load(path.read_text()) or {}
        if not isinstance(config, dict):
            raise ConfigError("got no keys, allowed is a mapping of keys to values")
        return read_study({**config, "results": results} if results else config)
    except OSError as error:
        sys.exit(f"{path}: {error.strerror}")
    except yaml.YAMLError as error:
        sys.exit(f"{path}: {' '.join(str(error).split())}")
    except ConfigError as error:
        sys.exit("\n".join(f"{path}: {line}" for line in error.args))


def installed_engines(study: Study) -> list[str]:
    """The engines of ``study`` that this system has; says on stderr which it lacks."""
    missing = {name: ENGINES[name].missing() for name in study.dem.engines}
    for reason in filter(None, missing.values()):
        print(f"{reason}. The study goes on without it.", file=sys.stderr)
    return [name for name, reason in missing.items() if reason is None]


def main() -> None:
    """Command line: a study's configuration; prints the folder of results, or the engines."""
    parser = argparse.ArgumentParser(description="Print what a study writes to, or runs with.")
    parser.add_argument("what", choices=["folder", "engines"])
    parser.add_argument("config", type=Path)
    parser.add_argument("--results", help="another folder than the configuration's")
    arguments = parser.parse_args()
    study = read_study_file(arguments.config, arguments.results)
    if arguments.what == "folder":
        print(study.results)
    else:
        print(", ".join(installed_engines(study)))


if __name__ == "__main__":
    main()

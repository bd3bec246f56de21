"""Read a study's configuration from a mapping or a YAML file; one line reports each error."""

import sys
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from sidmacib.quantities import shown
from sidmacib.yaml_text import TextError, read_yaml
from workflow.consistency import faults, requirements
from workflow.engines import ENGINES
from workflow.models import LAWS, MODELS, SOLVED
from workflow.schema import Study
from workflow.schema.values import shown_key

MAX_LINES, MAX_LINE = 20, 380


class ConfigError(ValueError):
    """The configuration is not valid; the arguments are lines of text, one for each fault."""

    def __init__(self, *lines: str) -> None:
        super().__init__(
            *(line if len(line) < MAX_LINE else f"{line[:MAX_LINE]}..." for line in lines)
        )

    def __str__(self) -> str:
        return "\n".join(map(str, self.args))

    def of(self, path: Path) -> "ConfigError":
        """The same, each line beginning with the file's name."""
        name = f"{_named(path)}: "
        return ConfigError(*(f"{name}{str(line).removeprefix(name)}" for line in self.args))


class CallError(ConfigError):
    """A wrong argument of a command; the configuration itself may be right."""


def read_study_file(path: Path, results: str | None = None) -> Study:
    """The study in the YAML file ``path``; ``results``: overrides its results folder.

    Raises `ConfigError`, whose lines begin with the file's name.
    """
    config = load_configuration(path, {"results": results} if results is not None else {})
    try:
        return read_study(config)
    except ConfigError as error:
        raise error.of(path) from None


def load_configuration(path: Path, changes: Mapping[str, Any]) -> dict[str, Any]:
    """The keys and values in the YAML file ``path`` with ``changes``, section by section.

    Files of structures are read too. Raises `ConfigError` if a file cannot be read; `read_study`
    checks whether it is a study.
    """
    return _with_descriptions(_merged(read_config_text(path), changes), path)


def read_config_text(path: Path) -> dict[str, Any]:
    """The keys and values in the YAML file ``path``; raises `ConfigError`."""
    try:
        config = read_yaml(path)
    except TextError as error:
        raise ConfigError(f"{_named(path)}: {error}") from None
    if config is None:
        return {}
    if not isinstance(config, dict):
        raise ConfigError(
            f"{_named(path)}: {shown(config)} is not a study; it must be a mapping of keys to "
            "values"
        )
    return config


def read_study(config: Mapping[str, Any]) -> Study:
    """The study in ``config``; if it names no models, with all that support it.

    Raises `ConfigError`.
    """
    try:
        study = _with_able_models(Study.model_validate(_with_all_models(config)), config)
    except ValidationError as error:
        found = error.errors(include_url=False)
        lines = [_one_line(fault) for fault in found[:MAX_LINES]]
        raise ConfigError(*lines, *_others(len(found))) from None
    lines = [*faults(study), *_unfit_folder(Path(study.results))]
    if lines:
        raise ConfigError(*lines[:MAX_LINES], *_others(len(lines)))
    return study


def with_installed_engines(study: Study) -> Study:
    """``study`` without the engines that are not installed, which are named on stderr."""
    missing = {name: ENGINES[name].missing() for name in study.dem.engines}
    for reason in filter(None, missing.values()):
        print(f"{reason}. The study continues without it.", file=sys.stderr)
    engines = tuple(name for name, reason in missing.items() if reason is None)
    return study.model_copy(update={"dem": study.dem.model_copy(update={"engines": engines})})


def _others(count: int) -> list[str]:
    """A line for the faults, of ``count``, that are not shown."""
    return [f"and {count - MAX_LINES} more faults"] if count > MAX_LINES else []


def _merged(config: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    nested = {
        key: _merged(config[key], value)
        for key, value in changes.items()
        if isinstance(value, Mapping) and isinstance(config.get(key), Mapping)
    }
    return {**config, **changes, **nested}


def _with_descriptions(config: dict[str, Any], path: Path) -> dict[str, Any]:
    """``config`` with the descriptions from the files of its structures, relative to ``path``."""
    structures = config.get("structures")
    if not isinstance(structures, Mapping):
        return config
    from sidmacib.structure.files.structure_file import with_bodies  # noqa: PLC0415 (polygons take long to import)

    read = {}
    for name, section in structures.items():
        read[name] = section
        if isinstance(section, Mapping) and isinstance(file := section.get("file"), str):
            key = f"structures.{shown_key(name)}"
            if "description" in section:
                raise ConfigError(
                    f"{_named(path)}: {key}: file and description are both given; give only "
                    "one of them"
                )
            beside = path.parent / file
            try:
                description = with_bodies(read_yaml(beside), beside.parent)
                read[name] = {**section, "description": description}
            except ValueError as error:
                raise ConfigError(f"{_named(path)}: {key}.file: {file}: {error}") from None
    return {**config, "structures": read}


def _with_all_models(config: Mapping[str, Any]) -> dict[str, Any]:
    """``config`` with all models if it names none."""
    dem = config.get("dem", {})
    if isinstance(dem, Mapping):
        dem = {"engines": tuple(ENGINES), **dem}
    models = *SOLVED, *LAWS
    return {"models": models, **config, "dem": dem}


def _with_able_models(study: Study, config: Mapping[str, Any]) -> Study:
    """``study`` without those models that ``config`` does not name and that cannot model it."""

    def refused(name: str) -> bool:
        return any(
            MODELS[name].refusal(requirements(study, study.assembly, sample))
            for sample, section in study.samples.items()
            if section.models is None or name in section.models
        )

    def able(names: tuple[str, ...]) -> tuple[str, ...]:
        # A law that refuses a joint gives its reason in the tables.
        return tuple(name for name in names if name in LAWS or not refused(name))

    if "models" not in config:
        study = study.model_copy(update={"models": able(study.models)})
    if "engines" not in config.get("dem", {}):
        dem = study.dem.model_copy(update={"engines": able(study.dem.engines)})
        study = study.model_copy(update={"dem": dem})
    return study


def _unfit_folder(folder: Path) -> list[str]:
    """Why results cannot be written to ``folder``, as far as can be seen beforehand."""
    for path in (folder, *folder.parents):
        try:
            if path.is_dir():
                return []
            if path.exists():
                return [f"results: {shown(str(path))} is a file; it must be a folder"]
        except OSError as error:
            return [f"results: {shown(str(path))}: {error.strerror}"]
    return []


_MAPPING = "it must be a mapping of keys to values"
_EXPECTED = {
    "model_type": _MAPPING,
    "model_attributes_type": _MAPPING,
    "dict_type": _MAPPING,
    "string_type": "it must be a name",
}


def _one_line(fault: Any) -> str:
    place = list(fault["loc"])
    if place[-1:] == ["[key]"]:
        place = place[:-2]
    kind, message = fault["type"], f"{shown(fault['input'])} is not allowed"
    if kind == "value_error":  # raised by this project's readers
        message = str(fault["ctx"]["error"])
    elif kind == "extra_forbidden":
        keys = _sections(place[:-1])[-1].get("properties", ())
        message = f"unknown key; allowed keys: {', '.join(keys)}"
    elif kind == "missing":
        message = "missing; this key is required"
    elif kind == "enum":
        message += f"; it must be {fault['ctx']['expected'].replace(chr(39), '')}"
    else:
        message += f"; {_EXPECTED.get(kind, fault['msg'])}"
    return f"{'.'.join(map(shown_key, _counted(place))) or 'study'}: {message}"


_schema = cache(Study.model_json_schema)


def _sections(place: Sequence[Any]) -> list[dict[str, Any]]:
    """The schema of the study and of each part of ``place``, from the outside in."""
    found = [_schema()]
    for part in place:
        node = found[-1]
        of_any_name = node.get("patternProperties", {"": node.get("additionalProperties")})
        below = node.get("properties", {}).get(part) or node.get("items")
        found.append(_plain(below or next(iter(of_any_name.values())) or {}))
    return found


def _plain(node: dict[str, Any]) -> dict[str, Any]:
    """A schema that a reference stands for, or the first of several, as of a section or null."""
    node = node.get("anyOf", [node])[0]
    return _schema()["$defs"][node["$ref"].rsplit("/", 1)[1]] if "$ref" in node else node


def _counted(place: Sequence[Any]) -> list[str]:
    """``place`` with the entries of lists counted from 1; keys stay as they are."""
    around = _sections(place)
    return [
        str(part + 1) if isinstance(part, int) and node.get("type") == "array" else str(part)
        for part, node in zip(place, around, strict=False)
    ]


def _named(path: Path) -> str:
    """The file's name in a message."""
    text = str(path)
    return text if len(text) <= 100 and text.isprintable() else shown(text)

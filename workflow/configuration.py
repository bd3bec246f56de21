"""Read a study's configuration from a mapping or a YAML file; one line reports each error."""

import re
import sys
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from sidmacib.engines import ENGINES
from sidmacib.models import LAWS, MODELS, RESISTANCES, SOLVED
from sidmacib.quantities import shown
from sidmacib.reading import faults, shown_key
from sidmacib.yaml_text import TextError, read_yaml
from workflow.consistency import inconsistencies, requirements, rule_refusal
from workflow.schema import Study, with_changes


class ConfigError(ValueError):
    """The configuration is not valid; the arguments are lines of text, one for each fault."""

    def __str__(self) -> str:
        return "\n".join(self.args)

    def of(self, path: Path) -> "ConfigError":
        """The same, each line beginning with the file's name."""
        return ConfigError(*(f"{path}: {line.removeprefix(f'{path}: ')}" for line in self.args))


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
    try:
        config = read_yaml(path)
    except TextError as error:
        raise ConfigError(f"{path}: {error}") from None
    if not isinstance(config, dict | None):
        raise ConfigError(
            f"{path}: {shown(config)} is not a study; it must be a mapping of keys to values"
        )
    return _with_records(_with_descriptions(with_changes(config or {}, changes), path), path)


def read_study(config: Mapping[str, Any]) -> Study:
    """The study in ``config``; if it names no models, with all that support it.

    Raises `ConfigError`.
    """
    try:
        study = _with_able_models(Study.model_validate(_with_all_models(config)), config)
    except ValidationError as error:
        lines = [line if ": " in line else f"study: {line}" for line in faults(error)]
    else:
        study = _with_able_rules(study, config)
        lines = [*inconsistencies(study)]
    if lines:
        raise ConfigError(*lines)
    return study


def with_installed_engines(study: Study) -> Study:
    """``study`` without the engines that are not installed, which are named on stderr."""
    missing = {name: ENGINES[name].missing() for name in study.dem.engines}
    for reason in filter(None, missing.values()):
        print(f"{reason}. The study continues without it.", file=sys.stderr)
    engines = tuple(name for name, reason in missing.items() if reason is None)
    return study.model_copy(update={"dem": study.dem.model_copy(update={"engines": engines})})


def _with_descriptions(config: dict[str, Any], path: Path) -> dict[str, Any]:
    """``config`` with the descriptions of its structures, and blocks from mesh files, as values.

    Files are relative to the one that names them: ``path``, or the file of a structure.
    """
    structures = config.get("structures")
    if not isinstance(structures, Mapping):
        return config
    from sidmacib.structure.files.structure_file import with_bodies  # noqa: PLC0415 (polygons take long to import)

    read = {**structures}
    for name, given in structures.items():
        if not isinstance(given, Mapping):
            continue
        key, own = f"{path}: structures.{shown_key(name)}", path
        read[name] = section = {**given}
        if isinstance(file := section.get("file"), str):
            if "description" in section:
                raise ConfigError(f"{key}: file and description are both given; give only one")
            own, key = path.parent / file, f"{key}.file: {file}"
        variants = section.get("variants")
        try:
            if own is not path:
                section["description"] = read_yaml(own)
            if "description" in section:
                section["description"] = with_bodies(section["description"], own.parent)
            if isinstance(variants, Mapping):
                within = {which: with_bodies(of, own.parent) for which, of in variants.items()}
                section["variants"] = within
        except ValueError as error:
            raise ConfigError(f"{key}: {error}") from None
    return {**config, "structures": read}


def _with_records(config: dict[str, Any], path: Path) -> dict[str, Any]:
    """``config`` with the descriptions and the records of its earthquakes as values.

    Their files are beside ``path``; those that a structure's file names are beside that.
    """
    earthquakes = config.get("earthquakes")
    if not isinstance(earthquakes, Mapping):
        return config
    from sidmacib.structure.files.structure_file import with_bodies  # noqa: PLC0415 (as above)
    from sidmacib.structure.files.time_loads import recorded, with_records  # noqa: PLC0415
    from sidmacib.structure.shaking import UNITS  # noqa: PLC0415

    read = {**earthquakes}
    for name, given in earthquakes.items():
        if not isinstance(given, Mapping):
            continue
        key = f"{path}: earthquakes.{shown_key(name)}"
        read[name] = section = {**given}
        try:
            if isinstance(file := section.get("file"), str):
                own = path.parent / file
                section["description"] = with_records(
                    with_bodies(read_yaml(own), own.parent), own.parent
                )
            patterns = section.get("records")
            if not isinstance(patterns, list | Mapping):
                patterns = () if patterns is None else (patterns,)
            if not isinstance(patterns, Mapping):
                unit = UNITS.get(str(section.get("unit")))
                section["records"] = {}
                for each in (file for one in patterns for file in _found(path.parent, one)):
                    label = re.sub("[^A-Za-z0-9_.]", "_", each.stem)
                    if label in section["records"]:
                        allowed = "names must differ in letters, digits, _ and ."
                        raise ValueError(f"records: two files are called {label}; {allowed}")
                    section["records"][label] = recorded(each, unit).values
        except ValueError as error:
            raise ConfigError(f"{key}: {error}") from None
    return {**config, "earthquakes": read}


def _found(folder: Path, pattern: Any) -> list[Path]:
    """The files that fit a ``pattern`` in a ``folder``, in order; ValueError if there are none."""
    if not isinstance(pattern, str):
        raise ValueError(f"records: {shown(pattern)} is not allowed; it must be names of files")
    if Path(pattern).is_absolute():
        folder, pattern = Path(Path(pattern).anchor), str(Path(pattern).relative_to("/"))
    if found := sorted(folder.glob(pattern)):
        return found
    raise ValueError(f"records: {shown(pattern)} is not allowed; it must be files that are there")


def _with_all_models(config: Mapping[str, Any]) -> dict[str, Any]:
    """``config`` with all models if it names none."""
    dem = config.get("dem", {})
    if isinstance(dem, Mapping):
        dem = {"engines": tuple(ENGINES), **dem}
    models = tuple(name for name in (*SOLVED, *LAWS) if name not in RESISTANCES)
    return {"models": models, **config, "dem": dem}


def _with_able_rules(study: Study, config: Mapping[str, Any]) -> Study:
    """``study`` without the reductions that ``config`` does not name and a joint does not take."""
    if "reductions" in config.get("sidmacib", {}):
        return study
    joints = []
    for name in study.samples:
        with suppress(ValueError):  # found later
            joints.append(study.joint(name))
    rules = study.sidmacib.reductions
    able = tuple(each for each in rules if not any(rule_refusal(each, j) for j in joints))
    sidmacib = study.sidmacib.model_copy(update={"reductions": able})
    return study.model_copy(update={"sidmacib": sidmacib})


def _with_able_models(study: Study, config: Mapping[str, Any]) -> Study:
    """``study`` without those models that ``config`` does not name and that cannot model it.

    With the resistances that it asks for by its reliability.
    """

    def refused(name: str) -> bool:
        return any(
            MODELS[name].refusal(requirements(study, study.assembly, sample))
            for sample, section in study.samples.items()
            if section.models is None or name in section.models
        )

    def able(names: tuple[str, ...]) -> tuple[str, ...]:
        # A law that refuses a joint gives its reason in the tables.
        return tuple(name for name in names if name in LAWS or not refused(name))

    models = able(study.models) if "models" not in config else study.models
    asked = [name for name in study.reliability.resistances if name not in models]
    study = study.model_copy(update={"models": (*models, *asked)})
    if "engines" not in config.get("dem", {}):
        dem = study.dem.model_copy(update={"engines": able(study.dem.engines)})
        study = study.model_copy(update={"dem": dem})
    return study

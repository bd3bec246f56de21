"""Files that are opened in the explorer: the page that `multilock assembly --report` writes."""

import base64
import binascii
from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from sidmacib.command.structure_views import Views
from sidmacib.command.structures import limit_of, static_of, structure_notes
from sidmacib.command.verdicts import demanded_rows
from sidmacib.structure.files.structure_file import demands_of, description_in
from sidmacib.structure.loads import SupportMotion
from sidmacib.yaml_text import read_yaml

YAML = (".yaml", ".yml")


def report_of(files: Sequence[Mapping[str, Any]]) -> str:
    """The page of the structure in ``files``, each a name and data in base64.

    A YAML file with blocks counts, which may name the others; any other says what it adds to a file
    of blocks of the same name. Errors of the models; ValueError for files of something else.
    """
    with TemporaryDirectory() as folder:
        paths = [_written(each, Path(folder)) for each in files]
        if not paths:
            raise ValueError("no file was sent")
        path = _main(paths)
        description = description_in(path)
        demand = demands_of(description, path.parent)[0]
        if demand.case is not None or not demand.raises:
            raise ValueError("load: missing; load_cases, or none, are for multilock assembly only")
        problem = demand.problem
        if isinstance(problem.loads, SupportMotion):
            raise ValueError("load.support: is for multilock assembly only; use another load here")
        notes = structure_notes(problem, description)
        limit, static = limit_of(problem), static_of(problem)
        rows, found = demanded_rows(demand, limit, static)
        verdict = "" if found is None else str(found)
        views = Views.of(path, description, problem, limit, static, notes, verdict)
        return views.page(rows, f"multilock assembly {path.name}")


def _written(file: Mapping[str, Any], folder: Path) -> Path:
    name, data = file.get("name"), file.get("data")
    if not isinstance(name, str) or not isinstance(data, str):
        raise ValueError("each file must have a name and data")
    path = folder / Path(name).name
    if path == folder or path.name.startswith("."):
        raise ValueError(f"{name!r} is not allowed; it must be the name of a file")
    try:
        path.write_bytes(base64.b64decode(data, validate=True))
    except binascii.Error:
        raise ValueError(f"{path.name}: its data must be in base64") from None
    return path


def _main(paths: Sequence[Path]) -> Path:
    """The file that has the blocks."""
    for path in paths:
        if path.suffix.lower() in YAML:
            given = read_yaml(path)
            if len(paths) == 1 or (isinstance(given, dict) and "blocks" in given):
                return path
    others = [path for path in paths if path.suffix.lower() not in YAML]
    return (others or paths)[0]

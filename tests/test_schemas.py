"""Schemas by which editors check studies and files of structures, and the pages of their keys."""

import json
from typing import Any

import pytest
from conftest import ROOT
from jsonschema import Draft202012Validator
from referencing import Registry
from referencing.jsonschema import DRAFT202012

from sidmacib.yaml_text import read_yaml
from workflow.site import page, schemas, structure_page

SCHEMAS = {name: json.loads(text) for name, text in schemas().items()}
BESIDE: Any = Registry().with_resources(
    (name, DRAFT202012.create_resource(schema)) for name, schema in SCHEMAS.items()
)
FILES = {
    path: line.rpartition("/")[2]
    for path in sorted({ROOT / "config.yaml", *(ROOT / "studies").rglob("*.yaml")})
    if (line := path.read_text().partition("\n")[0]).startswith("# yaml-language-server: ")
}


def faults(name: str, value: Any) -> list[str]:
    """The places where ``value`` does not fit a schema."""
    errors = Draft202012Validator(SCHEMAS[name], registry=BESIDE).iter_errors(value)
    return [error.json_path for error in errors]


@pytest.mark.parametrize("name", SCHEMAS)
def test_the_schema_in_the_repository_is_current(name: str) -> None:
    """If it is not: make docs."""
    assert (ROOT / "docs" / name).read_text() == schemas()[name]
    Draft202012Validator.check_schema(SCHEMAS[name])


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_a_study_or_structure_of_this_checkout_fits_the_schema_that_it_names(path: Any) -> None:
    assert faults(FILES[path], read_yaml(path)) == []
    (where,) = [line for line in path.read_text().splitlines() if "$schema=" in line]
    assert (path.parent / where.partition("$schema=")[2]).is_file()


def test_the_studies_and_the_examples_name_their_schemas() -> None:
    named = {str(path.relative_to(ROOT)) for path in FILES}
    studies = {str(path.relative_to(ROOT)) for path in (ROOT / "studies").glob("*/config.yaml")}
    assert named >= {"config.yaml", "studies/structures/trilith.yaml", *studies}


@pytest.mark.parametrize(
    ("keys", "value", "place"),
    [
        (("geometry", "a"), -1, "$.geometry.a"),
        (("geometry", "c"), 1, "$.geometry"),
        (("meshes",), [], "$.meshes"),
        (("eccentricities",), ["twist"], "$.eccentricities[0]"),
        (("assembly", "failure"), "soft", "$.assembly.failure"),
        (("assembly", "hold_down"), {"force": -1}, "$.assembly.hold_down"),
        (("structures",), {"s": {"description": {"blocks": {}}}}, "$.structures.s.description"),
    ],
)
def test_a_fault_is_seen_by_an_editor(keys: tuple[str, ...], value: Any, place: str) -> None:
    study = read_yaml(ROOT / "config.yaml")
    section = study
    for key in keys[:-1]:
        section = section[key]
    section[keys[-1]] = value
    (found,) = faults("study.schema.json", study)
    assert found.startswith(place)


def test_the_pages_have_all_keys_with_default_and_what_is_allowed() -> None:
    for text, name in ((page(), "study.schema.json"), (structure_page(), "structure.schema.json")):
        for section in (SCHEMAS[name], *SCHEMAS[name]["$defs"].values()):
            for key in section.get("properties", ()):
                assert f"\n| `{key}` | " in text
    assert "| `young` | `1e+10` | a number greater than 0 (Pa) |" in page()
    words = "number of locks; a whole number of at least 1 |"
    assert f"| `count` | must be given | {words}" in structure_page()
    assert "## locks.<number>.condensed\n" in structure_page()

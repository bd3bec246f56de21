"""Reading a configuration: whatever is in the file, a study or one clear line for each fault."""

import math
import os
from pathlib import Path

import numpy as np
import pytest
import yaml
from processes import python

from workflow.configuration import ConfigError, load_configuration, read_study, read_study_file
from workflow.schema import Study

STUDY = "samples: {n3: {locks: 3}}\n"
LETTERS = 450


def written(folder: Path, text: str | bytes) -> Path:
    path = folder / "study.yaml"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


# --- texts ---------------------------------------------------------------------------------------
NASTY: list[tuple[str | bytes, str]] = [
    ("# caf\xe9\nsamples: {}".encode("latin-1"), "line 1: not UTF-8 text; save the file as UTF-8"),
    (STUDY.encode("utf-16"), "line 1: not UTF-8 text"),
    (STUDY.encode() + b"\0", "line 2: not text; it contains a control character"),
    ("samples:\n\tn3: {locks: 3}", "line 2: a tab where spaces are needed; indent with spaces"),
    ("meshes: " + "[" * 100_000, "line 1: nested too deeply; at most 20 levels are allowed"),
    ("- " * 100_000, "line 1: nested too deeply"),
    ("a: &a [*a]", "line 1: not YAML: found unconstructable recursive node"),
    ("a: *b", "line 1: not YAML: found undefined alias"),
    (f"{STUDY}geometry: {{a: 0.06}}\ngeometry: {{a: 0.07}}", "line 3: 'geometry' appears twice"),
    ("samples: {n3: {locks: 3, locks: 5}}", "line 1: 'locks' appears twice; each key must appear"),
    ("samples: !!python/object/apply:os.system [ls]", "line 1: the tag tag:yaml.org.* not allowed"),
    (f"{STUDY}meshes: !!set {{0.02}}", "line 2: the tag .*set is not allowed; leave it out"),
    (f"{STUDY}geometry: {{a: !x 1}}", "line 2: the tag !x is not allowed"),
    ("- samples", "a list is not a study; it must be a mapping of keys to values"),
    ("? [1, 2]\n: 3", "line 1: a list or mapping as a key; keys must be plain words"),
    (f"{STUDY}---\n{STUDY}", "line 2: not YAML: expected a single document"),
    ("samples: {n3: {locks: 3}", "line [12]: not YAML: "),
    ("", "samples: missing; it must name at least one, unless structures or earthquakes does"),
    ("---\n...\n", "samples: missing"),
]


VALUES = [  # that YAML, or its writing, makes a difference to; others: cases/refused_studies.yaml
    ("geometry: {a: %s}" % ("9" * 5000), "geometry.a: '9999.*' is not a number; it must be "),
    ("samples: {n3: {locks: 1%s}}" % ("0" * 400), "samples.n3.locks: '1000.*' is not a number"),
    ("geometry: {a: 1e999}", "geometry.a: '1e999' is not a number; .* greater than 0 .m."),
    ("geometry: {a: .inf}", "geometry.a: inf is not allowed"),
    ("geometry: {a: 2024-01-01}", "geometry.a: '2024-01-01' is not a number"),
    ("geometry: {a: 1:30}", "geometry.a: '1:30' is not a number"),
    ("geometry: {a: 010}", "geometry.a: '010' is not a number"),
    ("eccentricities: [yes]", "eccentricities.1: 'yes' is not allowed; .*, or torsion"),
    ("geometry: {a: 1_000}", "geometry.a: '1_000' is not a number"),
    ("geometry: {a: [1]}", "geometry.a: a list is not a number"),
    ("dem:", "dem: null is not allowed; it must be a mapping"),
    ("eccentricities: [.nan]", "eccentricities.1: nan is not allowed"),
    (f"eccentricities: [{'9' * 5000}]", "eccentricities.1: '999.* is not allowed"),
    (f"{'x' * 500}: 1", "'xxxx.*...': unknown key; allowed keys: results, samples, "),
    ('"a\\nb": 1', r"'a\\nb': unknown key"),
    ('"\\0": 1', r"'\\x00': unknown key"),
    (
        "samples: {%s: {locks: 3}}" % ("n" * 300),
        "samples: 'nnn.*' is not allowed as a name; .* at most 64",
    ),
    ('results: "a\\0b"', r"results: 'a\\x00b' is not allowed; .* must be made of letters"),
    ("results: ~/x", "results: '~/x' is not allowed"),
    ("results: out/..", "results: .* is not allowed; .* and not be /, . or .."),
    ("results: ' '", "results: ' ' is not allowed; .*"),
    ("results: true", "results: true is not allowed"),
    ("meshes: [1e-300]", "meshes: 1e-300 m is too fine"),
    ("overrides: {[x]: {}}", "line 2: a list or mapping as a key"),
]


WITH_VALUES = [(t if t.startswith("samples") else STUDY + t, message) for t, message in VALUES]
REFUSED = [*NASTY, *WITH_VALUES]


@pytest.mark.parametrize(("text", "message"), REFUSED, ids=range(len(REFUSED)))
def test_what_is_no_study_is_refused_in_one_line(
    tmp_path: Path, text: str | bytes, message: str
) -> None:
    path = written(tmp_path, text)
    with pytest.raises(ConfigError, match=f"^{path}: {message}") as error:
        read_study_file(path)
    (line,) = str(error.value).splitlines()
    assert len(line) < LETTERS


# --- files ---------------------------------------------------------------------------------------
def test_a_path_that_is_no_file_is_refused(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    for path, message in (
        (tmp_path, "not a file"),
        (tmp_path / "missing.yaml", "No such file or directory"),
        (tmp_path / "pipe", "not a file"),
        (Path("/dev/zero"), "not a file"),
        (tmp_path / ("x" * 300), "File name too long"),
    ):
        with pytest.raises(ConfigError, match=message):
            read_study_file(path)


def test_a_results_folder_may_be_absolute_above_or_yet_to_be_made(tmp_path: Path) -> None:
    path = written(tmp_path, STUDY)
    for name in (str(tmp_path / "new/below"), "../beside", "a b", "é", "2024"):
        assert read_study_file(path, name).results == name


# --- values that are allowed ---------------------------------------------------------------------
def test_numbers_may_be_written_as_people_write_them(tmp_path: Path) -> None:
    for text in ("0.06", "6e-2", ".06", "+0.06", "'0.06'", "6.E-2"):
        path = written(tmp_path, f"{STUDY}geometry: {{a: {text}}}")
        assert read_study_file(path).joint("n3").a == 0.06
    assert yaml.safe_load("6e-2") == "6e-2"  # as other readers see it
    assert read_study({**yaml.safe_load(STUDY), "geometry": {"a": "6e-2"}}).geometry.a == 0.06
    assert read_study({**yaml.safe_load(STUDY), "geometry": {"a": np.float64(0.06)}})


def test_words_that_yaml_took_for_other_things_are_names(tmp_path: Path) -> None:
    text = "samples: {no: {locks: 3}, 3: {locks: 3}, null: {locks: 5}, 0.10: {locks: 3}}"
    assert [*read_study_file(written(tmp_path, text)).samples] == ["no", "3", "null", "0.10"]


def test_an_alias_stands_for_what_it_names(tmp_path: Path) -> None:
    text = "samples: {n3: &s {locks: 3}, again: *s}\nmeshes: &m [0.02]\nvariants: {v: {meshes: *m}}"
    study = read_study_file(written(tmp_path, text))
    assert study.samples["again"] == study.samples["n3"]
    assert study.variants["v"].meshes == (0.02,)


def test_torsion_is_an_infinite_eccentricity_and_zero_has_no_sign(tmp_path: Path) -> None:
    study = read_study_file(written(tmp_path, f"{STUDY}eccentricities: [-0.0, torsion]"))
    assert study.eccentricities == (0.0, math.inf)
    assert math.copysign(1.0, study.eccentricities[0]) == 1.0
    again = read_study_file(written(tmp_path, f"{STUDY}eccentricities: [0, .inf]"))
    assert again.eccentricities == study.eccentricities
    assert Study.model_validate_json(study.model_dump_json()) == study


def test_changes_are_made_section_by_section(tmp_path: Path) -> None:
    path = written(tmp_path, f"{STUDY}dem: {{engines: [yade], numerics: {{ranks: 2}}}}")
    changes = {"results": "out", "dem": {"engines": [], "numerics": {"damping": "0.3"}}}
    config = load_configuration(path, changes)
    assert config == {
        "samples": {"n3": {"locks": 3}},
        "results": "out",
        "dem": {"engines": [], "numerics": {"ranks": 2, "damping": "0.3"}},
    }
    assert read_study(config).dem.numerics.damping == 0.3


@pytest.mark.long
def test_commands_end_with_the_line_and_no_traceback(tmp_path: Path) -> None:
    path = written(tmp_path, f"{STUDY}geometry: {{a: true}}")
    found = python("-m", "workflow", "study", path)
    assert found.returncode == 1
    assert found.stderr.startswith(f"{path}: geometry.a: true is not a number;")
    assert len(found.stderr.splitlines()) == 1

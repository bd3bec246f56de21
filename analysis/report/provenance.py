"""Origin of a report: sizes of joints, versions of programs, the configuration as YAML."""

import platform
import subprocess
import tomllib
from collections.abc import Callable, Iterator, Mapping
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any

import pandas as pd
import yaml

from analysis.published import read_published
from sidmacib.engines import ENGINES
from sidmacib.joint.joint import Joint
from workflow.schema import Study

CHECKOUT = Path(__file__).parents[2]
PACKAGES = ("numpy", "scipy", "cvxpy", "pandas", "plotly", "snakemake")
MILLI, KILO, GIGA = 1e3, 1e-3, 1e-9
FEATURES: tuple[tuple[str, float, Callable[[Joint], float]], ...] = (
    ("friction", 1.0, lambda joint: joint.dry.friction),
    ("a (mm)", MILLI, lambda joint: joint.a),
    ("b (mm)", MILLI, lambda joint: joint.b),
    ("h (mm)", MILLI, lambda joint: joint.h),
    ("H (mm)", MILLI, lambda joint: joint.H),
    ("T0 (N)", 1.0, lambda joint: joint.T0),
)


def sizes_of(study: Study) -> list[dict[str, Any]]:
    """Sizes of each sample for the page's script, in SI units."""
    joints = {name: study.joint(name) for name in study.samples}
    return [
        {
            **{"sample": name, "locks": joint.locks, "a_m": joint.a, "b_m": joint.b},
            "T0_N": float(f"{joint.T0:.6g}"),
            "friction": joint.dry.friction,
        }
        for name, joint in joints.items()
    ]


def sample_words(study: Study) -> dict[str, str]:
    """Each sample in a few words: its locks, and of its sizes those that tell it from others."""
    joints = {name: study.joint(name) for name in study.samples}
    words = {name: f"{joint.locks} locks" for name, joint in joints.items()}
    published = read_published()
    for title, factor, read in FEATURES:
        values = {name: read(joint) for name, joint in joints.items()}
        if len(set(words.values())) < len(words) and len(set(values.values())) > 1:
            words = {n: f"{words[n]}, {title} {factor * values[n]:.4g}" for n in words}
            if title == "friction":
                printed = [n for n in published.samples(study) if published.as_printed(study, n)]
                words |= {name: f"{words[name]} as printed" for name in printed}
    return {name: f"{name}: {told}" for name, told in words.items()}


def size_table(study: Study) -> dict[str, Any]:
    """Sizes and materials of each sample as a table to be read: ``columns`` and ``rows``."""
    columns = (
        *("joint", "locks", "a (mm)", "b (mm)", "h (mm)", "H (mm)", "T0 (N)"),
        *("cohesion (kPa)", "tensile strength (kPa)"),
    )
    rows = []
    for name in study.samples:
        joint = study.joint(name)
        lengths = [MILLI * length for length in (joint.a, joint.b, joint.h, joint.H)]
        strengths = [KILO * s for s in (joint.inner.cohesion, joint.inner.tensile_strength)]
        faces = (joint.inner, joint.dry)
        stiffnesses = [GIGA * k for f in faces for k in (f.normal_stiffness, f.shear_stiffness)]
        numbers = [joint.locks, *lengths, joint.T0, *strengths, *stiffnesses, joint.dry.friction]
        rows.append([name, *(f"{number:.4g}" for number in numbers)])
    stiffness = [f"{k}, {face} faces (N/mm³)" for face in ("inner", "dry") for k in ("Kn", "Ks")]
    more = (*stiffness, "friction of dry faces")
    return {"columns": [*columns, *more], "rows": rows}


def versions_of(tables: Mapping[str, pd.DataFrame]) -> list[tuple[str, str]]:
    """Versions of the program, of engines by the records of cases, of Python and its packages."""
    project = tomllib.loads((CHECKOUT / "pyproject.toml").read_text())["project"]
    return [
        (project["name"], f"{project['version']}{commit()}"),
        *_engines(tables),
        ("Python", platform.python_version()),
        *((package, version(package)) for package in PACKAGES),
    ]


def commit(checkout: Path = CHECKOUT) -> str:
    """The commit of a checkout, and whether files differ from it; empty without Git."""
    if not (checkout / ".git").exists():  # a folder above may be another project's
        return ""
    command = ("git", "-C", str(checkout), "describe", "--always", "--dirty=, changed since")
    try:
        found = subprocess.run(command, capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return ""
    return f", commit {found.stdout.strip()}"


def _engines(tables: Mapping[str, pd.DataFrame]) -> Iterator[tuple[str, str]]:
    """Names and versions of the engines that cases of these tables were run with."""
    told = [tables[name]["versions"].dropna() for name in ("cases", "structures") if name in tables]
    texts = {text for column in told for text in column if text}
    for text in sorted(part.strip() for each in texts for part in str(each).split(",")):
        name, _, number = text.partition(" ")
        if name in ENGINES:
            yield ENGINES[name].label, number


def provenance(study: Study | None, tables: Mapping[str, pd.DataFrame]) -> dict[str, Any]:
    """Sizes, versions, and the paper with its DOI, each None if there are none; for the page."""
    published = read_published()
    paper, doi = None, None
    if study is not None and published.samples(study):
        paper, _, doi = str(published.numbers["source"]).partition(", doi:")
    return {
        "sizes": None if study is None else size_table(study),
        "versions": versions_of(tables),
        "date": f"{datetime.now(UTC):%Y-%m-%d}",
        "source": paper,
        "doi": doi,
    }


def as_yaml(configuration: Mapping[str, Any]) -> str:
    """The ``configuration`` as YAML that a study can be started with, without what has no value."""
    samples = {
        name: {key: value for key, value in sample.items() if value != {}}
        for name, sample in _known(configuration.get("samples", {})).items()
    }
    whole = _known(configuration) | {"samples": samples}
    text = yaml.safe_dump(whole, sort_keys=False, allow_unicode=True, width=100)
    return "# A study of multilock, with all defaults.\n" + text


def _known(value: Any) -> Any:
    """Nested values without those that are None."""
    if isinstance(value, Mapping):
        return {key: _known(each) for key, each in value.items() if each is not None}
    return value

"""The cases of a study: one engine, one joint, one mesh, one direction of loading each."""

import argparse
import difflib
import math
import sys
from collections.abc import Iterator
from pathlib import Path

from pydantic import BaseModel, ConfigDict

from sidmacib.joint import Direction, Joint
from sidmacib.loading import Loading
from workflow.study import (
    ConfigError,
    Dem,
    Numerics,
    NumericsChange,
    Study,
    Variant,
    read_study_file,
)

REFERENCE = "reference"  # the variant that is held against the published numbers


class Case(BaseModel):
    """One run of an engine. ``mesh`` in m."""

    model_config = ConfigDict(extra="forbid", frozen=True, ser_json_inf_nan="strings")

    name: str
    engine: str
    variant: str
    sample: str
    joint: Joint
    mesh: float
    loading: Loading
    numerics: Numerics

    @property
    def direction(self) -> Direction:
        """Direction of loading in the (V, M) plane."""
        return Direction.at_eccentricity(self.loading.eccentricity, self.joint.a)


def cases_of(study: Study) -> dict[tuple[str, str], Case]:
    """All cases of ``study`` by engine and name; raises `ConfigError` for unknown overrides."""
    cases: dict[tuple[str, str], Case] = {}
    for case in _cases(study):
        if (case.engine, case.name) in cases:
            raise ConfigError(f"variants.{case.variant}: got {case.name} twice, allowed is once")
        cases[case.engine, case.name] = case
    names = {name for _, name in cases}
    for name in study.overrides:
        if name not in names:
            raise ConfigError(f"overrides: got {name}, {_allowed(name, names)}")
    return cases


def _cases(study: Study) -> Iterator[Case]:
    for engine in study.dem.engines:
        for variant, change in {REFERENCE: Variant(), **study.variants}.items():
            dem = _changed(study.dem, change)
            for sample in study.samples:
                joint = study.model_copy(update={"dem": dem}).joint(sample)
                for mesh in change.meshes or study.meshes:
                    for ratio in change.eccentricities or study.eccentricities:
                        name = case_name(sample, mesh, ratio, variant)
                        numerics = _replaced(
                            dem.numerics, study.overrides.get(name, NumericsChange())
                        )
                        loading = Loading(ratio * joint.a, dem.load_share, dem.push)
                        yield Case(
                            name=name,
                            engine=engine,
                            variant=variant,
                            sample=sample,
                            joint=joint,
                            mesh=mesh,
                            loading=loading,
                            numerics=numerics,
                        )


def case_name(sample: str, mesh: float, ratio: float, variant: str = REFERENCE) -> str:
    """Name of a case, ``ratio`` being e / a."""
    direction = "torsion" if math.isinf(ratio) else f"e{ratio:g}a"
    name = f"{sample}-mesh{mesh:g}-{direction}"
    return name if variant == REFERENCE else f"{name}-{variant}"


def _changed(dem: Dem, change: Variant) -> Dem:
    keys = ("failure", "load_share", "upper_body", "push")
    update = {key: getattr(change, key) for key in keys if getattr(change, key) is not None}
    return dem.model_copy(update={**update, "numerics": _replaced(dem.numerics, change.numerics)})


def _replaced(numerics: Numerics, change: NumericsChange) -> Numerics:
    return numerics.model_copy(update=change.model_dump(exclude_none=True))


def _allowed(name: str, names: set[str]) -> str:
    """The names that are allowed: those close to ``name``, or else all."""
    close = difflib.get_close_matches(name, names)
    if close:
        return f"allowed are cases of the study, such as {', '.join(close)}"
    return f"allowed are cases: {', '.join(sorted(names))}"


def case_folder(results: str, engine: str, case: str) -> str:
    """Where the results of a case are."""
    return f"{results}/cases/{engine}/{case}"


def main() -> None:
    """Command line: prints the folder of a case of a study."""
    parser = argparse.ArgumentParser(description="Print the folder of a case.")
    parser.add_argument("config", type=Path)
    parser.add_argument("engine")
    parser.add_argument("case")
    parser.add_argument("results", nargs="?")
    arguments = parser.parse_args()
    study = read_study_file(arguments.config, arguments.results)
    try:
        cases = cases_of(study)
    except ConfigError as error:
        sys.exit(f"{arguments.config}: {error}")
    engines = {engine for engine, _ in cases}
    if arguments.engine not in engines:
        sys.exit(f"ENGINE: got {arguments.engine}, allowed are: {', '.join(sorted(engines))}")
    names = {name for engine, name in cases if engine == arguments.engine}
    if arguments.case not in names:
        sys.exit(f"CASE: got {arguments.case}, {_allowed(arguments.case, names)}")
    print(case_folder(study.results, arguments.engine, arguments.case))


if __name__ == "__main__":
    main()

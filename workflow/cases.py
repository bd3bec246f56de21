"""The cases of a study: one model, one joint, one mesh, one direction of loading each."""

import argparse
import difflib
import math
import sys
from collections.abc import Iterator
from pathlib import Path

from pydantic import BaseModel, ConfigDict

from sidmacib.joint import Direction, Joint
from sidmacib.loading import Loading
from sidmacib.mechanics.assembly import Failure
from workflow.configuration import ConfigError, read_study_file
from workflow.engines import ENGINES
from workflow.solvers import SOLVERS
from workflow.study import Assembly, Numerics, NumericsChange, Study, Variant

REFERENCE = "reference"  # the variant that is held against the published numbers


class Case(BaseModel):
    """One run of a model of the joint's pieces. ``mesh`` in m; ``numerics``: of engines only."""

    model_config = ConfigDict(extra="forbid", frozen=True, ser_json_inf_nan="strings")

    name: str
    model: str
    variant: str
    sample: str
    joint: Joint
    mesh: float
    loading: Loading
    numerics: Numerics | None

    @property
    def direction(self) -> Direction:
        """Direction of loading in the (V, M) plane."""
        return self.loading.direction

    @property
    def eccentricity_m(self) -> float:
        """E in m; ``inf`` is pure torsion."""
        return self.direction.eccentricity * self.joint.a


def cases_of(study: Study) -> dict[tuple[str, str], Case]:
    """All cases of ``study`` by model and name; raises `ConfigError` for unknown overrides."""
    cases: dict[tuple[str, str], Case] = {}
    for case in _cases(study):
        if (case.model, case.name) in cases:
            raise ConfigError(f"variants.{case.variant}: got {case.name} twice, allowed is once")
        cases[case.model, case.name] = case
    if not study.overrides:
        return cases
    # Engines that are left out, because they are not installed, have these cases too.
    every = study.model_copy(update={"dem": study.dem.model_copy(update={"engines": (*ENGINES,)})})
    names = {case.name for case in _cases(every) if case.model in ENGINES}
    for name in study.overrides:
        if name not in names:
            raise ConfigError(f"overrides: got {name}, {_allowed(name, names)}")
    return cases


def _cases(study: Study) -> Iterator[Case]:
    for model in (*study.dem.engines, *study.models):
        for variant, change in {REFERENCE: Variant(), **study.variants}.items():
            assembly = change.assembly(study.assembly)
            if not _runs(model, variant, assembly, study):
                continue
            for sample in study.samples:
                joint = study.joint(sample, assembly)
                for mesh in change.meshes or study.meshes:
                    for ratio in change.eccentricities or study.eccentricities:
                        name = case_name(sample, mesh, ratio, variant)
                        numerics = _replaced(study.dem.numerics, change.numerics)
                        numerics = _replaced(numerics, study.overrides.get(name, NumericsChange()))
                        if model in ENGINES and not ENGINES[model].shares_out:
                            numerics = numerics.model_copy(update={"ranks": 1})
                        yield Case(
                            name=name,
                            model=model,
                            variant=variant,
                            sample=sample,
                            joint=joint,
                            mesh=mesh,
                            loading=Loading(Direction(ratio), assembly.load_share, assembly.push),
                            numerics=numerics if model in ENGINES else None,
                        )


def _runs(model: str, variant: str, assembly: Assembly, study: Study) -> bool:
    """Whether ``model`` knows how ``variant`` fails, and can tell something new of it."""
    engine = ENGINES.get(model)
    brittle_only = engine.brittle_only if engine else SOLVERS[model].brittle
    if brittle_only and assembly.failure is not Failure.BRITTLE:
        return False
    return engine is not None or variant == REFERENCE or assembly != study.assembly


def case_name(sample: str, mesh: float, ratio: float, variant: str = REFERENCE) -> str:
    """Name of a case, ``ratio`` being e / a."""
    direction = "torsion" if math.isinf(ratio) else f"e{ratio:g}a"
    name = f"{sample}-mesh{mesh:g}-{direction}"
    return name if variant == REFERENCE else f"{name}-{variant}"


def _replaced(numerics: Numerics, change: NumericsChange) -> Numerics:
    return numerics.model_copy(update=change.model_dump(exclude_none=True))


def _allowed(name: str, names: set[str]) -> str:
    """The names that are allowed: those close to ``name``, or else all."""
    close = difflib.get_close_matches(name, names)
    if close:
        return f"allowed are cases of the study, such as {', '.join(close)}"
    return f"allowed are cases: {', '.join(sorted(names))}"


def case_folder(results: str, model: str, case: str) -> str:
    """Where the results of a case are."""
    return f"{results}/cases/{model}/{case}"


def main() -> None:
    """Command line: prints the folder of a case of a study."""
    parser = argparse.ArgumentParser(description="Print the folder of a case.")
    parser.add_argument("config", type=Path)
    parser.add_argument("case")
    parser.add_argument("--model", help="the first that is installed if not given")
    parser.add_argument("--results")
    arguments = parser.parse_args()
    study = read_study_file(arguments.config, arguments.results)
    try:
        cases = cases_of(study)
    except ConfigError as error:
        sys.exit(f"{arguments.config}: {error}")
    there = [m for m in study.references if m not in ENGINES or not ENGINES[m].missing()]
    model = arguments.model or (there or study.references)[0]
    models = {model for model, _ in cases}
    if model not in models:
        sys.exit(f"MODEL: got {model}, allowed are: {', '.join(sorted(models))}")
    names = {name for own, name in cases if own == model}
    if arguments.case not in names:
        sys.exit(f"CASE: got {arguments.case}, {_allowed(arguments.case, names)}")
    print(case_folder(study.results, model, arguments.case))


if __name__ == "__main__":
    main()

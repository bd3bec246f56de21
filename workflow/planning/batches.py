"""The cases of a study by the job that runs them: alone in an engine, in a batch, or elsewhere."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from sidmacib.engines import ENGINES
from sidmacib.mechanics.assembly import Failure
from sidmacib.model import Ability
from sidmacib.models import MODELS, REFERENCE_MODEL, RETURNED, SOLVED
from workflow.joints.case import Case, CaseId, case_name
from workflow.planning.cases import cases_of, second_mesh
from workflow.planning.resources import solved_resources
from workflow.schema import Study
from workflow.threedec import RETURNED as PRINTED
from workflow.threedec import deck_folder, decks

# A batch, on average, is at most so large: start-up counts little then, and little is lost with it.
BATCH, BATCH_TIME = 512, 120.0  # cases, s


@dataclass(frozen=True)
class CaseJobs:
    """The cases of a study by the job that finds their results.

    ``cases``: those of the study itself. ``batches``: by model and name of the batch, together with
    cases of the static model that engines are compared with. ``decks``: cases that 3DEC may solve,
    by name.
    """

    cases: Mapping[CaseId, Case]
    engines: Mapping[CaseId, Case]
    batches: Mapping[tuple[str, str], tuple[Case, ...]]
    returned: Mapping[CaseId, Case]
    decks: Mapping[str, Case]


def case_jobs(study: Study) -> CaseJobs:
    """All cases of ``study``; results returned from 3DEC count like those of any other model."""
    cases = cases_of(study)
    of_decks = decks(study, cases.values())
    cases |= {
        case.id: case
        for name, case in of_decks.items()
        if Path(study.results, deck_folder(name), PRINTED).is_file()
    }
    engines: dict[CaseId, Case] = {}
    returned: dict[CaseId, Case] = {}
    solved: dict[str, list[Case]] = {}
    for case in (*cases.values(), *reference_cases(cases.values())):
        if case.model in ENGINES:
            engines[case.id] = case
        elif case.model in SOLVED:
            solved.setdefault(case.model, []).append(case)
        elif case.model in RETURNED:
            returned[case.id] = case
    in_batches = {
        (model, name): tuple(batch)
        for model, model_cases in solved.items()
        for name, batch in batches(model_cases).items()
    }
    return CaseJobs(cases, engines, in_batches, returned, of_decks)


def reference_cases(cases: Iterable[Case]) -> list[Case]:
    """Cases of the static model that the study lacks, to compare every engine's case with.

    They are on the same nodes; where an engine has one mesh only, a second one is added.
    """
    cases = list(cases)
    known = {case.physics() for case in cases if case.model == REFERENCE_MODEL}
    series: dict[str, dict[float, Case]] = {}
    able = MODELS[REFERENCE_MODEL].abilities
    for case in cases:
        ductile = case.joint.failure is Failure.DUCTILE
        if case.model not in ENGINES or (ductile and Ability.DUCTILE not in able):
            continue
        reference = replace(case, model=REFERENCE_MODEL, numerics=None)
        series.setdefault(case.series(), {}).setdefault(case.mesh, reference)
    for by_mesh in series.values():
        (case, *_) = by_mesh.values()
        if other := second_mesh(case.joint, by_mesh, case.nodes):
            name = case_name(case.sample, other, case.direction.eccentricity, case.variant)
            by_mesh[other] = replace(case, mesh=other, name=name)
    every = {case.physics(): case for by_mesh in series.values() for case in by_mesh.values()}
    return [case for physics, case in every.items() if physics not in known]


def batches(cases: list[Case]) -> dict[str, list[Case]]:
    """Cases in batches, by the first bits of their digests.

    So adding or changing a case moves no other case to another batch, unless there is so much to do
    that another bit is needed.
    """
    bits, time = 0, solved_resources(cases).time
    while len(cases) > BATCH << bits or time > BATCH_TIME * 2**bits:
        bits += 1
    found: dict[str, list[Case]] = {}
    for case in cases:
        found.setdefault(_batch_name(case.digest(), bits), []).append(case)
    return dict(sorted(found.items()))


def _batch_name(digest: str, bits: int) -> str:
    """A name made from the first ``bits`` of a hexadecimal ``digest``."""
    if bits == 0:
        return "batch"
    digits = -(-bits // 4)
    number = int(digest[:digits], 16) >> (4 * digits - bits)
    return f"batch-{number:0{digits}x}"

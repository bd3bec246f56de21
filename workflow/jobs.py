"""The jobs that find the results of a study's cases, and what each asks of a cluster.

A case is alone in an engine, in a batch that is solved, or comes from elsewhere. Memory and time
are rounded up from what jobs took in the published study and in `make locks`; the `benchmarks` of a
results folder have what each job took. A job that was killed for lack of either asks for twice as
much the next time.
"""

import math
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from sidmacib.engines import ENGINES
from sidmacib.models import REFERENCE_MODEL, RETURNED, SOLVED
from workflow.case import (
    Case,
    EarthquakeCase,
    JointCase,
    JointSubject,
    StructureCase,
    StructureSubject,
    case_name,
)
from workflow.cases import cases_of, earthquake_cases, second_mesh, structure_cases
from workflow.consistency import node_estimate
from workflow.schema import Study
from workflow.threedec import PRINTED, deck_folder, decks

# A batch, on average, is at most so large: start-up counts little then, and little is lost with it.
BATCH, BATCH_TIME = 512, 120.0  # cases, s
MARGIN = 4.0  # of time: nodes of a cluster may be slow, and shared
START = 60.0  # s: to begin at all
LEAST_MB = 600  # a process with this package and its libraries
ENGINE_NODE = 0.012  # s, for each node of an engine's case, of 40 ramp periods
ENGINE_NODE_MB = 0.1
SOLVED_NODE = 3e-4  # s, for each node of a case of rigid pieces that is solved in this process
ELASTIC = 50.0  # times that, of elastic pieces
FEW_NODES = 200
SAMPLED_JOINT = 4.0  # s, of a joint of a sampling
OF_STRUCTURE, OF_STRUCTURE_MB = 300.0, 3 * LEAST_MB  # s and MB, of a case of a structure
SHORT = 600.0  # s: jobs that take less may share one of the cluster's


@dataclass(frozen=True)
class CaseJobs:
    """The cases of a study by the job that finds their results, which is named by its folder.

    ``joints`` and ``structures``: those of the study itself. ``engines`` and ``returned``: a case
    each. ``batches``: of one model, together with cases of the static model that engines are
    compared with; all loads and variants of a structure are one. ``earthquakes``: all factors on a
    record are one. ``decks``: cases that 3DEC may solve, by name.
    """

    joints: Mapping[str, JointCase]
    structures: Mapping[str, StructureCase]
    earthquakes: Mapping[str, tuple[EarthquakeCase, ...]]
    engines: Mapping[str, Case[Any]]
    batches: Mapping[str, tuple[Case[Any], ...]]
    returned: Mapping[str, JointCase]
    decks: Mapping[str, JointCase]


def case_jobs(study: Study) -> CaseJobs:
    """All cases of ``study``; results returned from 3DEC count like those of any other model."""
    joints = cases_of(study)
    of_decks = decks(study, joints.values())
    joints |= {
        case.folder: case
        for name, case in of_decks.items()
        if Path(study.results, deck_folder(name), PRINTED).is_file()
    }
    of_structures = sorted(structure_cases(study), key=lambda case: case.model in SOLVED)
    structures = {case.folder: case for case in of_structures}
    every = [*joints.values(), *reference_cases(joints.values())]
    both: list[Case[Any]] = [*every, *of_structures]
    solved: dict[str, tuple[Case[Any], ...]] = {
        f"{JointSubject.kind}/{model}/{name}": tuple(batch)
        for model in SOLVED
        for name, batch in batches([case for case in every if case.model == model]).items()
    }
    for case in of_structures:
        if case.model in SOLVED:
            folder = f"{StructureSubject.kind}/{case.model}/{case.subject.structure}"
            solved[folder] = (*solved.get(folder, ()), case)
    earthquakes: dict[str, tuple[EarthquakeCase, ...]] = {}
    for each in earthquake_cases(study):
        of = each.subject
        folder = f"{of.kind}/{each.model}/{of.structure}-{of.record}"
        earthquakes[folder] = (*earthquakes.get(folder, ()), each)
    return CaseJobs(
        joints,
        structures,
        earthquakes,
        {case.folder: case for case in both if case.model in ENGINES},
        solved,
        {case.folder: case for case in every if case.model in RETURNED},
        of_decks,
    )


def reference_cases(cases: Collection[JointCase]) -> list[JointCase]:
    """Cases of the static model that the study lacks, to compare every engine's case with.

    They are on the same nodes; where an engine has one mesh only, a second one is added.
    """
    series: dict[str, dict[float, JointCase]] = {}
    for case in cases:
        if case.model in ENGINES:
            reference = replace(case, model=REFERENCE_MODEL, numerics=None)
            by_mesh = series.setdefault(case.subject.series(), {})
            by_mesh.setdefault(case.subject.mesh, reference)
    for by_mesh in series.values():
        (case, *_) = by_mesh.values()
        subject = case.subject
        if other := second_mesh(subject.joint, by_mesh, subject.nodes):
            ratio = subject.direction.eccentricity
            name = case_name(subject.sample, other, ratio, case.variant)
            by_mesh[other] = replace(case, name=name, subject=replace(subject, mesh=other))
    known = {case.physics() for case in cases if case.model == REFERENCE_MODEL}
    every = {case.physics(): case for by_mesh in series.values() for case in by_mesh.values()}
    return [case for physics, case in every.items() if physics not in known]


def batches(cases: list[JointCase]) -> dict[str, list[JointCase]]:
    """Cases in batches, by the first bits of their digests.

    So adding or changing a case moves no other case to another batch, unless there is so much to do
    that another bit is needed.
    """
    bits, time = 0, solved_resources(cases).time
    while len(cases) > BATCH << bits or time > BATCH_TIME * 2**bits:
        bits += 1
    found: dict[str, list[JointCase]] = {}
    for case in cases:
        number = int(case.digest(), 16) >> (256 - bits)
        name = f"batch-{number:0{math.ceil(bits / 4)}x}" if bits else "batch"
        found.setdefault(name, []).append(case)
    return dict(sorted(found.items()))


@dataclass(frozen=True)
class Resources:
    """Memory (MB), and time (s) on one core of this machine."""

    memory: int
    time: float

    @property
    def short(self) -> bool:
        """Whether a separate job would mostly wait in the queue."""
        return self.time < SHORT

    def minutes(self, attempt: int) -> int:
        """Time to request, with a margin; doubled at each further ``attempt``."""
        return math.ceil((START + MARGIN * self.time) * 2 ** (attempt - 1) / 60.0)

    def megabytes(self, attempt: int) -> int:
        """Memory to request; doubled at each further ``attempt``."""
        return int(self.memory * 2 ** (attempt - 1))


def engine_resources(case: Case[Any], time_limit: float) -> Resources:
    """Resources of one case in an engine, which is ended at ``time_limit`` (s)."""
    if not isinstance(case.subject, JointSubject):
        return Resources(OF_STRUCTURE_MB, min(OF_STRUCTURE, time_limit))
    assert case.numerics is not None, f"{case.name}: an engine needs numerics"
    nodes = nodes_of(case.subject)
    time = ENGINE_NODE * nodes * max(case.numerics.ramp_periods / 40.0, 1.0)
    return Resources(math.ceil(LEAST_MB + ENGINE_NODE_MB * nodes), min(time, time_limit))


def solved_resources(cases: Iterable[Case[Any]]) -> Resources:
    """Resources of cases that are solved one after the other in this process."""
    time, memory = 0.0, 0.0
    for case in cases:
        if isinstance(case.subject, JointSubject):
            nodes = max(nodes_of(case.subject), FEW_NODES)
            time += SOLVED_NODE * nodes * (1.0 if case.subject.joint.elastic is None else ELASTIC)
            memory = max(memory, 2 * LEAST_MB + nodes)
        else:
            time += OF_STRUCTURE
            memory = max(memory, OF_STRUCTURE_MB)
    return Resources(math.ceil(memory), time)


def nodes_of(subject: JointSubject) -> float:
    """About how many contact nodes a joint has."""
    return node_estimate(subject.joint, subject.mesh, subject.nodes)


def sampling_resources(joints: int) -> Resources:
    """Resources of a batch of a sampling's joints."""
    return Resources(2 * LEAST_MB, SAMPLED_JOINT * joints)

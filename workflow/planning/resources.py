"""Cluster resources of a job: memory and time, from the size of its cases.

The numbers are rounded up from what jobs took in the published study and in `make locks`; the
`.times` of a results folder have what each job took. A job that was killed for lack of either asks
for twice as much the next time.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from workflow.case import Case, JointSubject
from workflow.consistency import node_estimate

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
class Resources:
    """Memory (MB), and time (s) on one core of this machine."""

    memory: int = 2 * LEAST_MB
    time: float = 120.0

    @property
    def short(self) -> bool:
        """Whether a separate job would mostly wait in the queue."""
        return self.time < SHORT

    def minutes(self, attempt: int = 1) -> int:
        """Time to request, with a margin; doubled at each further ``attempt``."""
        return math.ceil((START + MARGIN * self.time) * 2 ** (attempt - 1) / 60.0)

    def megabytes(self, attempt: int = 1) -> int:
        """Memory to request; doubled at each further ``attempt``."""
        return int(self.memory * 2 ** (attempt - 1))


def engine_resources(case: Case[Any], time_limit: float) -> Resources:
    """Resources of one case in an engine, which is ended at ``time_limit`` (s)."""
    if not isinstance(case.subject, JointSubject):
        return Resources(OF_STRUCTURE_MB, min(OF_STRUCTURE, time_limit))
    nodes = nodes_of(case.subject)
    ramps = case.numerics.ramp_periods / 40.0 if case.numerics else 1.0
    time = ENGINE_NODE * nodes * max(ramps, 1.0)
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

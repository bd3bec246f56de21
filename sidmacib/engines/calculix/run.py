"""The first failure of an assembly of elastic pieces, by finite elements in CalculiX.

Its tied contacts do not break, so the load rises beyond the first failure, in steps that know
nothing of where it is, until the strength of a node is exceeded. CalculiX is stopped then: its
results are read while it runs. Between the last two states nodes are taken to move in proportion to
the load.
"""

import math
import os
import re
import subprocess
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from time import sleep

from ..scripts.assembly import GivenAssembly, Vector, dot, length, plus, utilisation
from ..scripts.children import ENDS_WITH_PARENT
from ..scripts.records import (
    FALLS_ALONE,
    FIRST_FAILURE,
    EngineOutcome,
    EnginePeak,
    History,
    NoAnswerError,
    NodeForce,
)
from .deck import JOB, CalculixDeck

COMMAND = "ccx"
WAIT = 0.1  # s, until results are looked for again
NUMBER = 12  # characters of a number in the .frd file
END, DISPLACEMENT = "\n -3\n", "\n -4  DISP "  # of a block; where displacements begin
STATE = re.compile(r"^ +100CL +\d+ *([-+.\dEe]+) ", re.MULTILINE)
Displacements = dict[int, tuple[float, float, float]]  # m, by node
GROWTH = 0.25  # of the load, a step where that is more than the first one
LARGEST_LOAD = 1e6  # over the first step
LARGEST_UNBALANCED = 0.05  # mean force left on a piece over the load; found up to 0.007
HALVINGS = 50  # to find where between two states the strength is reached


@dataclass(frozen=True)
class CalculixState:
    """An equilibrium: its load (N), the nodes' jumps (m) and the displacement it does work on."""

    load: float
    jumps: Sequence[Vector]  # below less above
    displacement: float


def find_first_failure(
    title: str, assembly: GivenAssembly, first_increment_N: float, tolerance: float
) -> None:
    """Look for it and write ``history.csv``, ``nodes.csv`` and, at the end, ``result.json``.

    ``first_increment_N``: the first step of the load; ``tolerance``: of the load.
    """
    loads = raised(first_increment_N)
    deck = CalculixDeck(assembly)
    Path(f"{JOB}.inp").write_text(deck.text(title, loads))
    weights = [deck.jump_weights(number) for number in range(len(assembly.nodes))]
    history = History(assembly)
    before: CalculixState | None = None
    engine = CalculixProcess(JOB)
    for time, moved in engine.states():
        history.time_steps += 1
        history.attempts = history.time_steps
        along = math.fsum(force * moved[node][k - 1] for (node, k), force in deck.variable.items())
        if not math.isfinite(along):
            raise SystemExit(f"the computation has diverged: displacement {along} m")
        jumps = [jump(weight, moved) for weight in weights]
        state = CalculixState(load_at(time, loads), jumps, along)
        used = most_used(assembly, jumps)
        over = not used <= 1.0
        print(f"{state.load:12.4f} N uses {100 * used:.2f} % of the strength", flush=True)
        if not over:
            record(history, state, EngineOutcome.EQUILIBRIUM.value)
            before = state
            continue
        engine.stop()
        if before is None:
            raise NoAnswerError(FALLS_ALONE)
        record(history, state, "overstressed")
        failing = at_strength(assembly, before, state)
        forces = record(history, failing, EngineOutcome.EQUILIBRIUM.value)
        # Pieces that slide off are carried as far as one likes, as friction has no tangent there.
        if not max(row["unbalanced_ratio"] for row in history.rows[-2:]) <= LARGEST_UNBALANCED:
            raise NoAnswerError(
                f"no first failure: {in_words(assembly, before)}, and beyond it the "
                "displacements from "
                "CalculiX are not in equilibrium"
            )
        load = failing.load
        peak = EnginePeak(load, load * (1.0 + tolerance), load, FIRST_FAILURE, forces)
        history.write(peak, "calculix", engine.version())
        return
    if before is None:
        raise SystemExit(f"CalculiX finds no equilibrium under permanent loads: {engine.why()}")
    why = f"CalculiX stopped: {engine.why()}"
    if before.load >= loads[-1] * (1.0 - 1e-9):
        why = "the load grows without a failure"
    raise SystemExit(f"no first failure: {in_words(assembly, before)}, and {why}")


def in_words(assembly: GivenAssembly, state: CalculixState) -> str:
    """A state in words."""
    used = 100 * most_used(assembly, state.jumps)
    return f"at {state.load:g} N {used:.3g} % of the strength is used"


def raised(first: float) -> list[float]:
    """Loads (N) that the load is raised to, one after another, whatever the assembly carries."""
    loads = [first]
    while loads[-1] < LARGEST_LOAD * first:
        loads.append(loads[-1] + max(first, GROWTH * loads[-1]))
    return loads


def load_at(time: float, loads: Sequence[float]) -> float:
    """The load (N) at a ``time``: 1 is the end of permanent loads, then comes 1 for each load."""
    if time <= 1.0:
        return 0.0
    step = min(math.ceil(time - 1.0 - 1e-9), len(loads))
    low = loads[step - 2] if step > 1 else 0.0
    return low + (loads[step - 1] - low) * (time - step)


def jump(weights: dict[int, float], moved: Displacements) -> list[float]:
    """Displacement of below less above at a contact node."""
    found = [0.0, 0.0, 0.0]
    for node, weight in weights.items():
        found = plus(found, moved[node], weight)
    return found


def node_force(assembly: GivenAssembly, number: int, moved: Vector) -> NodeForce:
    """Force at a contact node for its jump; friction has no history here."""
    node = assembly.nodes[number]
    face = assembly.faces[node.face]
    law = face.material
    closed = dot(moved, face.normal)
    normal = law.normal_stiffness * node.area_m2 * closed
    stiffness = law.shear_stiffness * node.area_m2
    shear = [stiffness * each for each in plus(moved, face.normal, -closed)]
    if face.cohesive:
        return NodeForce(normal, shear, True)
    normal = max(normal, 0.0)
    size, most = length(shear), law.friction * normal
    if size > most:
        shear = [each * most / size for each in shear]
    return NodeForce(normal, shear, False)


def most_used(assembly: GivenAssembly, jumps: Sequence[Vector]) -> float:
    """The largest part of its strength that a node of an inner face carries."""
    used = [0.0]
    for number, node in enumerate(assembly.nodes):
        face = assembly.faces[node.face]
        if face.cohesive:
            force = node_force(assembly, number, jumps[number])
            whole = plus(force.shear, face.normal, force.normal)
            used.append(utilisation(whole, face.normal, face.material, node.area_m2))
    return max(used)


def at_strength(
    assembly: GivenAssembly, before: CalculixState, after: CalculixState
) -> CalculixState:
    """The state between two where the first node reaches its strength."""

    def between(share: float) -> CalculixState:
        return CalculixState(
            before.load + share * (after.load - before.load),
            [
                plus(one, plus(other, one, -1.0), share)
                for one, other in zip(before.jumps, after.jumps, strict=True)
            ],
            before.displacement + share * (after.displacement - before.displacement),
        )

    low, high = 0.0, 1.0
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        if most_used(assembly, between(middle).jumps) > 1.0:
            high = middle
        else:
            low = middle
    return between(low)


def record(history: History, state: CalculixState, stage: str) -> list[NodeForce]:
    """Add a state to the history; the forces at its nodes."""
    assembly = history.assembly
    forces = [node_force(assembly, number, moved) for number, moved in enumerate(state.jumps)]
    share = unbalanced(assembly, forces, state.load)
    history.record(state.load, stage, state.displacement, share, forces)
    return forces


def unbalanced(assembly: GivenAssembly, forces: Sequence[NodeForce], load: float) -> float:
    """Mean unbalanced force on a piece over the load, or over the permanent loads if larger.

    It shows how well these node forces represent CalculiX's contacts.
    """
    left = [plus([0.0, 0.0, 0.0], piece.force_N) for piece in assembly.pieces]
    for point_load in assembly.loads:
        left[point_load.piece] = plus(left[point_load.piece], point_load.force, load)
    for force, node in zip(forces, assembly.nodes, strict=True):
        face = assembly.faces[node.face]
        whole = plus(force.shear, face.normal, force.normal)
        left[face.above] = plus(left[face.above], whole)
        left[face.below] = plus(left[face.below], whole, -1.0)
    free = assembly.free
    total = math.fsum(length(left[i]) for i in free)
    return total / len(free) / max(load, assembly.permanent_N, 1e-300)


class CalculixProcess:
    """CalculiX on the deck ``job``.inp, until it ends or is stopped."""

    def __init__(self, job: str) -> None:
        self.log = Path(f"{job}.log")
        self.results = Path(f"{job}.frd")
        self.results.unlink(missing_ok=True)
        with self.log.open("w") as stream:
            self.process = subprocess.Popen(
                [*ENDS_WITH_PARENT, COMMAND, job],
                stdin=subprocess.DEVNULL,
                stdout=stream,
                stderr=subprocess.STDOUT,
                env={**os.environ, "OMP_NUM_THREADS": "1"},
            )

    def states(self) -> Iterator[tuple[float, Displacements]]:
        """Times and displacements of all increments, each as soon as it is complete."""
        position, pending = 0, ""
        while True:
            ended = self.process.poll() is not None
            if self.results.exists():
                with self.results.open() as stream:
                    stream.seek(position)
                    pending += stream.read()
                    position = stream.tell()
            *blocks, pending = pending.split(END)
            for block in blocks:
                if DISPLACEMENT in block:
                    yield read_state(block)
            if ended:
                return
            sleep(WAIT)

    def stop(self) -> None:
        """End it, whatever it does."""
        self.process.kill()
        self.process.wait()

    def version(self) -> str:
        """The version of CalculiX, such as 2.20, from its results."""
        with self.results.open() as stream:
            found = re.search(r"^ +1UVERSION +Version ([\w.]+)", stream.read(4096), re.MULTILINE)
        if not found:
            raise SystemExit("CalculiX: its output states no version")
        return found[1]

    def why(self) -> str:
        """Its last error, or how it ended."""
        lines = [line.strip() for line in self.log.read_text(errors="replace").splitlines()]
        errors = [line for line in lines if line.startswith("*ERROR")]
        return errors[-1] if errors else f"CalculiX ended with exit code {self.process.returncode}"


def read_state(block: str) -> tuple[float, Displacements]:
    """Time and displacements in the part of an .frd file that ends with a state's last line."""
    found = STATE.findall(block)
    if not found:
        raise SystemExit("CalculiX's results are not understood: displacements without a time")
    lines = block[block.rindex(DISPLACEMENT) :].splitlines()
    moved: Displacements = {}
    for line in lines:
        if line.startswith(" -1"):
            x, y, z = (float(line[13 + NUMBER * k : 13 + NUMBER * (k + 1)]) for k in range(3))
            moved[int(line[3:13])] = x, y, z
    return float(found[-1]), moved

"""Other programs, for `make bench`: times for a point of the published joint, and an armadillo.

HiGHS as SciPy has it solves the same linear programme. `compas_cra` and `compas_lmgc90` (the extra
``peers``; left out where they are not installed) know rigid blocks that touch with friction, but no
strength of a lock: their points are the joint's pieces at rest, and no capacity. The armadillo is a
sample of compas_cra.
"""

import importlib.util
import io
import resource
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import redirect_stdout
from functools import partial
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import linprog

from benchmarks import seconds
from sidmacib.contact_points import OPTIONS
from sidmacib.contact_points.programme import Sidmacib, SupportFunction, capacities
from sidmacib.joint import Direction, Joint
from sidmacib.joint.loading import Loading, posed
from sidmacib.joint.pieces import cut_pieces
from sidmacib.mechanics.assembly import FaceMaterial, Floats
from sidmacib.mechanics.limit import limit_load
from sidmacib.mechanics.static import static_peak
from sidmacib.structure.blocks import Block, box
from sidmacib.structure.files.compas import read_compas, read_compas_interfaces
from sidmacib.structure.loads import acceleration
from sidmacib.structure.structure import structure

DIRECTIONS = 200
STEPS = 100  # of compas_lmgc90 to rest
PATIENCE = 120.0  # s of processor time that compas_cra may take for the armadillo
ARMADILLO_FRICTION = 0.84  # compas_cra's default

BY_CRA = """
import sys, time
import compas
from compas_cra import equilibrium
from compas_cra.algorithms import assembly_interfaces_numpy
path, name, friction = sys.argv[1:]
assembly = compas.json_load(path)
assembly_interfaces_numpy(assembly, nmax=10, amin=1e-2, tmax=1e-2)
start = time.process_time()
getattr(equilibrium, f"{name}_solve")(assembly, mu=float(friction))
print(time.process_time() - start)
"""


def peer_times(joint: Joint) -> Iterator[tuple[str, float]]:
    """Names of programs with the time (ms of processor time) that each takes for one point."""
    model = Sidmacib(joint, OPTIONS["option4"])
    angles = np.linspace(0.0, 2.0 * np.pi, DIRECTIONS, endpoint=False)
    directions = [Direction(0.01 * number) for number in range(DIRECTIONS)]
    yield "SiDMACIB, one point", _each(lambda: capacities(model, directions), DIRECTIONS)
    programme = standard_form(model)
    ways = [np.array([np.cos(angle), np.sin(angle)]) for angle in angles]
    yield (
        "the same programme, HiGHS of SciPy",
        _each(lambda: [furthest_by_highs(programme, way) for way in ways], DIRECTIONS),
    )
    problem = posed(joint, Loading(Direction(0.0)), 0.02)
    yield "static model, mesh 0.02 m, one point", _each(lambda: static_peak(*problem), 1)
    for name, solve in (("compas_cra", at_rest_by_cra), ("compas_lmgc90", at_rest_by_lmgc90)):
        if importlib.util.find_spec(name):
            yield f"{name}, the pieces at rest", _each(partial(solve, joint), 1)


def armadillo_figures() -> Iterator[tuple[str, str, float]]:
    """The armadillo of compas_cra, 399 blocks: forces at rest by that program, a limit load here.

    Lines for `make bench`: what was measured, its unit and its value. Nothing where compas_cra is
    not installed, which has the blocks.
    """
    if not importlib.util.find_spec("compas_cra"):
        return
    path = Path(str(files("compas_cra"))) / "data/samples/armadillo_cra.json"
    blocks = read_compas(path, 1.0)
    law = FaceMaterial(1e10, 1e10, ARMADILLO_FRICTION, 0.0, 0.0)
    ours = structure(blocks, law, regions=read_compas_interfaces(path, blocks))
    loads = acceleration(ours, (1.0, 0.0, 0.0))
    spent = seconds(lambda: limit_load(ours, loads, friction=True))
    yield "armadillo: limit analysis", "CPU-s", spent
    for name in ("rbe", "cra"):
        what = f"armadillo at rest: compas_cra, {name.upper()}"
        by_cra = seconds_by_cra(path, name, ARMADILLO_FRICTION, PATIENCE)
        if by_cra is None:
            yield f"{what}, stopped without an answer", "CPU-s", PATIENCE
        else:
            yield what, "CPU-s", by_cra


def _each(work: Callable[[], object], count: int) -> float:
    """Processor time (ms) of each of ``count`` points, the least of three times."""
    work()
    return 1e3 * min(seconds(work) for _ in range(3)) / count


# --- HiGHS ---------------------------------------------------------------------------------------
def standard_form(model: Sidmacib) -> dict[str, Any]:
    """The feasible set of ``model`` as `scipy.optimize.linprog` takes it, in the model's units.

    ``loads``: which unknowns are V and M.
    """
    furthest = SupportFunction(model)
    costs = []
    for way in np.eye(2):
        furthest.normal.value = way
        data, _, _ = furthest.problem.get_problem_data("HIGHS")
        costs.append(data["c"])
    equal = data["dims"].zero
    return {
        "A_eq": data["A"][:equal],
        "b_eq": data["b"][:equal],
        "A_ub": data["A"][equal:],
        "b_ub": data["b"][equal:],
        "loads": [int(np.flatnonzero(cost)[0]) for cost in costs],
    }


def furthest_by_highs(programme: dict[str, Any], way: Floats) -> Floats:
    """V and M (in the model's units) that lie furthest along ``way``."""
    cost = np.zeros(programme["A_eq"].shape[1])
    cost[programme["loads"]] = -way
    given = {name: value for name, value in programme.items() if name != "loads"}
    found = linprog(cost, **given, bounds=(None, None), method="highs")
    return np.asarray(found.x[programme["loads"]])


# --- rigid blocks --------------------------------------------------------------------------------
def surface(block: Block) -> tuple[list[list[float]], list[list[int]]]:
    """Corners (m) and sides of a block."""
    return [[*corner] for corner in block.vertices], [[*side] for side in block.faces]


def at_rest_by_cra(joint: Joint) -> object:
    """Forces between the pieces under their weight, by coupled rigid-block analysis.

    Kao et al. 2022, doi:10.1016/j.cad.2022.103216.
    """
    from compas_assembly.datastructures import Block as Datastructure
    from compas_cra.algorithms import assembly_interfaces_numpy
    from compas_cra.datastructures import CRA_Assembly
    from compas_cra.equilibrium import cra_solve

    assembly = CRA_Assembly()
    pieces = cut_pieces(joint)
    for number, piece in enumerate(pieces):
        solid = box(piece.name, piece.low, piece.high, 1.0)
        assembly.add_block(Datastructure.from_vertices_and_faces(*surface(solid)), node=number)
    assembly.set_boundary_conditions([n for n, piece in enumerate(pieces) if piece.fixed])
    assembly_interfaces_numpy(assembly, nmax=len(pieces), amin=1e-9, tmax=1e-6)
    with redirect_stdout(io.StringIO()):  # it prints its progress
        return cra_solve(assembly, mu=joint.dry.friction, density=joint.density)


def seconds_by_cra(path: Path, name: str, friction: float, limit: float) -> float | None:
    """Processor time (s) of compas_cra's solver ``name`` on an assembly, interfaces left out.

    In a separate process; None if it takes more than ``limit`` (s).
    """
    ended = subprocess.run(
        [sys.executable, "-c", BY_CRA, str(path), name, str(friction)],
        check=False,
        capture_output=True,
        text=True,
        preexec_fn=partial(resource.setrlimit, resource.RLIMIT_CPU, (int(limit), int(limit))),
    )
    return float(ended.stdout.split()[-1]) if ended.returncode == 0 else None


def at_rest_by_lmgc90(joint: Joint) -> object:
    """The pieces after some time steps under their weight, by non-smooth contact dynamics."""
    pieces = cut_pieces(joint)
    solids = [box(piece.name, piece.low, piece.high, 1.0) for piece in pieces]
    fixed = [piece.fixed for piece in pieces]
    return lmgc90_steps(solids, fixed, joint.dry.friction, joint.density, 1e-4, STEPS)


def lmgc90_steps(
    solids: Sequence[Block],
    fixed: Sequence[bool],
    friction: float,
    density: float,
    step: float,
    count: int,
) -> object:
    """Where compas_lmgc90 has blocks after some time steps (s) under their weight."""
    from compas_lmgc90.solver import Solver

    solver = Solver(dt=step, density=density)
    solver.geometry_from_v_f([{"vertices": v, "faces": f} for v, f in map(surface, solids)])
    solver.supports = list(fixed)
    for number, held in enumerate(fixed):
        if held:
            solver.v_drvdof[number] = {axis: np.zeros(6) for axis in range(1, 7)}
    solver.contact_law("IQS_CLB_g0", friction)
    solver.preprocess()
    solver.run(nb_steps=count)
    return solver.last_result

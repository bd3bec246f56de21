"""Memory is asked for before it is needed."""

import math
import tracemalloc

import numpy as np
import pytest

from sidmacib.errors import CapacityError
from sidmacib.joint import Direction, Elastic, Joint, UpperBody
from sidmacib.joint.loading import Loading, lateral_load
from sidmacib.joint.pieces import assemble
from sidmacib.mechanics.elastic import solver
from sidmacib.mechanics.elastic.solver import ElasticSolver, memory_needed
from sidmacib.mechanics.static import static_peak


def joint(locks: int, body: UpperBody = UpperBody.COLUMNS) -> Joint:
    return Joint(locks, elastic=Elastic(1e10, 0.2), upper_body=body)


def test_elastic_pieces_that_no_machine_holds_are_refused_before_anything_is_allocated() -> None:
    nine_locks = joint(9)
    assembly = assemble(nine_locks, 0.002)
    loads = lateral_load(nine_locks, assembly, Loading(Direction(0.0)))
    tracemalloc.start()
    words = r"[\d,]+ components .* need [\d.]+ GiB of memory or more, and this machine has [\d.]+ "
    with pytest.raises(CapacityError, match=f"^elastic pieces with {words}GiB; .* coarser mesh$"):
        static_peak(assembly, loads)
    assert tracemalloc.get_traced_memory()[1] < 1e9
    tracemalloc.stop()


@pytest.mark.parametrize("body", [UpperBody.COLUMNS, UpperBody.MONOLITHIC])
def test_the_memory_that_is_asked_for_is_a_close_bound(body: UpperBody) -> None:
    three_locks = joint(3, body)
    assembly = assemble(three_locks, 0.02)
    loads = lateral_load(three_locks, assembly, Loading(Direction(0.0)))
    tracemalloc.start()
    static_peak(assembly, loads)
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    needed = memory_needed(assembly, np.asarray(ElasticSolver(assembly, loads).kept))
    assert 0.4 * most < needed < 1.2 * most


def test_the_memory_of_a_machine_is_that_of_its_container_if_that_is_less(
    monkeypatch: pytest.MonkeyPatch, tmp_path
) -> None:
    limit = tmp_path / "memory.max"
    monkeypatch.setattr(solver, "CGROUP", limit)
    whole = solver.memory()
    assert 1e8 < whole < math.inf
    limit.write_text("max\n")
    assert solver.memory() == whole
    limit.write_text("1000000\n")
    assert solver.memory() == 1e6

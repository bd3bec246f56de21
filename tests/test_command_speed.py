"""What the command loads before it answers."""

import os
import subprocess
import sys

import pytest
from conftest import ROOT

SOLVERS = {"cvxpy", "numba", "matplotlib", "pandas", "scipy"}


@pytest.mark.parametrize(
    ("arguments", "seconds", "allowed"),
    [
        (["--help"], 0.4, set()),
        (["capacity", "-m", "safe", "-m", "law"], 1.0, {"scipy", "numba"}),
    ],
)
def test_a_quick_answer_loads_no_solver_of_others(
    arguments: list[str], seconds: float, allowed: set[str]
) -> None:
    code = (
        "import sys, time\nfrom sidmacib.command.main import main\n"
        "try: main(sys.argv[1:])\nexcept SystemExit as end: assert not end.code\n"
        "print(time.process_time(), *{m.partition('.')[0] for m in sys.modules}, file=sys.stderr)"
    )
    found = subprocess.run(
        [sys.executable, "-c", code, *arguments],
        env=os.environ | {"PYTHONPATH": str(ROOT), "OPENBLAS_NUM_THREADS": "1"},
        check=True,
        capture_output=True,
        text=True,
    )
    time, *loaded = found.stderr.split()
    assert SOLVERS & {*loaded} <= allowed
    assert float(time) < 4.0 * seconds  # a busy machine takes longer

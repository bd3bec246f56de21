"""No run of an engine can be reached over a network."""

import contextlib
import subprocess
import time
from pathlib import Path

import pytest
from campaigns.faults import descendants
from joints import loaded, sawn

from sidmacib import Elastic
from sidmacib.engines import ENGINES, Numerics
from sidmacib.engines.render import write_script
from sidmacib.engines.scripts.children import PRIVATE_NETWORK

pytestmark = [
    pytest.mark.engine,
    pytest.mark.skipif(not Path("/proc/net/tcp6").exists(), reason="needs /proc/net"),
]
LISTENS = "0A"
ENOUGH = 12.0  # s: engines open what they open at their start


def listeners(pid: int) -> set[str]:
    """Addresses at which processes of this machine listen."""
    sockets = set()
    with contextlib.suppress(OSError):
        if Path(f"/proc/{pid}/ns/net").readlink() != Path("/proc/self/ns/net").readlink():
            return set()
        sockets = {str(fd.readlink()) for fd in Path(f"/proc/{pid}/fd").iterdir()}
    rows = [
        row.split()
        for table in ("tcp", "tcp6")
        for row in Path(f"/proc/net/{table}").read_text().splitlines()[1:]
    ]
    return {row[1] for row in rows if row[3] == LISTENS and f"socket:[{row[9]}]" in sockets}


def seen_while(process: subprocess.Popen[bytes]) -> set[str]:
    """Where a process and its children listen, until it ends or for as long as is enough to see."""
    seen: set[str] = set()
    until = time.monotonic() + ENOUGH
    while process.poll() is None and time.monotonic() < until:
        for pid in (process.pid, *descendants(process.pid)):
            seen |= listeners(pid)
        time.sleep(0.01)
    return seen


def test_the_watcher_sees_a_listener_of_the_run_and_no_other(tmp_path: Path) -> None:
    listen = "import socket, time; s = socket.socket(); s.bind(('127.0.0.1', 0)); s.listen(); "
    other = subprocess.Popen(["python3", "-c", listen + "time.sleep(60)"])
    try:
        process = subprocess.Popen(["sh", "-c", f'python3 -c "{listen}time.sleep(1)"; true'])
        assert len(seen_while(process)) == 1
        quiet = subprocess.Popen(["sleep", "0.5"])
        assert not seen_while(quiet)
    finally:
        other.kill()
        other.wait()


MORE = [(name, 2) for name, engine in ENGINES.items() if "ranks" in engine.reads]


@pytest.mark.parametrize(("name", "ranks"), [*((name, 1) for name in ENGINES), *MORE])
def test_a_run_listens_nowhere(name: str, ranks: int, tmp_path: Path) -> None:
    if ranks > 1 and subprocess.run([*PRIVATE_NETWORK, "true"], check=False).returncode:
        pytest.skip("this system allows no private network")
    engine = ENGINES[name]
    joint = sawn(2, elastic=Elastic(1e10) if engine.elastic else None)
    write_script(engine, *loaded(joint), Numerics(ranks=ranks), "case", tmp_path)
    with (tmp_path / "log").open("w") as log:
        process = subprocess.Popen(
            [*engine.command, engine.script], cwd=tmp_path, stdout=log, stderr=log
        )
        assert seen_while(process) == set()
        assert process.poll() in (None, 0), (tmp_path / "log").read_text()
        process.kill()
        process.wait()

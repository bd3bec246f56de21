"""A study through SLURM: on this one machine, which is set up for it and cleaned up afterwards."""

import contextlib
import os
import shutil
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
import yaml
from campaigns.counts import tables_of
from processes import started
from small import BOTH, COARSE

CONFIGURATION = Path("/etc/slurm/slurm.conf")  # jobs look for it nowhere else
STUDY = COARSE | BOTH
# The whole of a cluster: a controller and a node, both here.
SLURM = """
ClusterName=local
SlurmctldHost={host}(127.0.0.1)
CommunicationParameters=NoInAddrAny
AuthType=auth/munge
SlurmUser=root
SlurmdUser=root
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SwitchType=switch/none
ReturnToService=2
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SchedulerParameters=sched_interval=2
NodeName={host} NodeAddr=127.0.0.1 CPUs={cores} RealMemory=8000 State=UNKNOWN
PartitionName=local Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""
pytestmark = [
    pytest.mark.machine,
    pytest.mark.skipif(
        "MULTILOCK_MACHINE" not in os.environ, reason="make test-slurm sets SLURM up"
    ),
    pytest.mark.skipif(os.geteuid() != 0, reason="SLURM is set up by root"),
    pytest.mark.skipif(shutil.which("slurmctld") is None, reason="SLURM is not installed"),
]


def lines_of(*command: str) -> list[str]:
    """Words that a command prints, whether it ends well or not."""
    return subprocess.run(command, capture_output=True, text=True, check=False).stdout.split()


class Cluster:
    """SLURM's daemons on this machine."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.node = ["slurmd"]

    def start(self) -> None:
        host = socket.gethostname().partition(".")[0]
        CONFIGURATION.parent.mkdir(parents=True, exist_ok=True)
        text = SLURM.format(host=host, folder=self.folder, cores=os.cpu_count())
        CONFIGURATION.write_text(text)
        subprocess.run(
            ["install", "-d", "-o", "munge", "-g", "munge", "-m", "0755", "/run/munge"], check=True
        )
        subprocess.run(
            ["su", "-s", "/bin/sh", "munge", "-c", "/usr/sbin/munged --force"], check=True
        )
        subprocess.run(["slurmctld"], check=True)
        subprocess.run(self.node, check=True)
        self.wait_until_idle()

    def wait_until_idle(self) -> None:
        for _ in range(60):
            states = lines_of("sinfo", "-h", "-o", "%T")
            if states and states[0] in ("idle", "mixed", "allocated"):
                return
            time.sleep(0.5)
        pytest.fail(f"SLURM has no node: {states}")

    def jobs(self) -> list[str]:
        return lines_of("squeue", "-h", "-o", "%T")

    def pid(self, daemon: str) -> int:
        return int((self.folder / f"{daemon}.pid").read_text())

    def stop(self) -> None:
        subprocess.run(["scancel", "--user=root"], capture_output=True, check=False)
        for daemon in ("slurmd", "slurmctld"):
            with contextlib.suppress(OSError, ValueError):
                os.kill(self.pid(daemon), signal.SIGTERM)
        with contextlib.suppress(OSError, ValueError):
            os.kill(int(Path("/run/munge/munged.pid").read_text()), signal.SIGTERM)
        CONFIGURATION.unlink(missing_ok=True)


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[Cluster]:
    if CONFIGURATION.exists():
        pytest.skip(f"{CONFIGURATION} is there: this machine is part of a cluster")
    found = Cluster(tmp_path / "slurm")
    found.folder.mkdir()
    try:
        found.start()
        yield found
    finally:
        found.stop()


def study(folder: Path, name: str, *options: str, **environment: str) -> subprocess.Popen[str]:
    """A running study, in a separate folder."""
    path = folder / f"{name}.yaml"
    path.write_text(yaml.safe_dump(STUDY))
    command = (sys.executable, "-m", "workflow", "study", path, f"--results={folder / name}")
    env = {**os.environ, "OPENBLAS_NUM_THREADS": "1", **environment}
    return started(*command, *options, env=env)


def test_a_cluster_makes_the_same_tables_as_a_node_fails(cluster: Cluster, tmp_path: Path) -> None:
    local = study(tmp_path, "local")
    output, _ = local.communicate(timeout=300)
    assert local.returncode == 0, output
    remote = study(tmp_path, "remote", "--profile=slurm")
    deadline = time.monotonic() + 120.0
    while "RUNNING" not in cluster.jobs():
        assert time.monotonic() < deadline, "no job has begun"
        assert remote.poll() is None, remote.communicate()[0]
        time.sleep(0.5)
    os.kill(cluster.pid("slurmd"), signal.SIGKILL)
    time.sleep(3.0)
    subprocess.run(cluster.node, check=True)
    output, _ = remote.communicate(timeout=540)
    assert remote.returncode == 0, output
    assert tables_of(tmp_path / "remote") == tables_of(tmp_path / "local")
    assert cluster.jobs() == []

"""A SLURM of one node in a folder of its own, with ports, keys and daemons of its own."""

import os
import shutil
import signal
import socket
import subprocess
import time
from pathlib import Path

PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "squeue", "scancel", "scontrol", "srun")
CORES = 4  # that it believes to have: jobs of the tests sleep more than they work
# A requeued job waits for cred_expire seconds; SLURM takes anything below 5 for its default, 120.
CONFIGURATION = """\
ClusterName=test
SlurmctldHost=localhost(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket,cred_expire=5
CredType=cred/munge
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldPort={controller}
SlurmdPort={node}
SlurmdParameters=config_overrides
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
MpiDefault=none
ReturnToService=2
KillWait=2
SchedulerParameters=batch_sched_delay=0,sched_interval=1
GresTypes=gpu
NodeName=localhost NodeAddr=127.0.0.1 CPUs={cores} RealMemory=2000 Gres=gpu:2 State=UNKNOWN
PreemptType=preempt/partition_prio
PreemptMode=REQUEUE
PartitionName=work Nodes=localhost Default=YES MaxTime=INFINITE State=UP PriorityTier=1
PartitionName=urgent Nodes=localhost MaxTime=INFINITE State=UP PriorityTier=2 PreemptMode=OFF
PartitionName=closed Nodes=localhost MaxTime=INFINITE State=DOWN
"""


def unavailable_reason() -> str | None:
    """Why no SLURM can be started here, or None."""
    if os.geteuid() != 0:
        return "SLURM's daemons must be started as root"
    missing = [name for name in PROGRAMS if shutil.which(name, path=_path()) is None]
    if missing:
        return (
            f"{', '.join(missing)} not found: "
            "apt-get install --no-install-recommends slurmctld slurmd slurm-client munge"
        )
    return None


class Cluster:
    """Its daemons, in the foreground, logging into `folder`."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.daemons = folder, []
        self.environment = {
            **os.environ,
            "PATH": _path(),
            "SLURM_CONF": str(folder / "slurm.conf"),
        }

    def start(self) -> None:
        """Until its node takes jobs; raises TimeoutError with the logs if it does not."""
        for name in ("state", "spool"):
            (self.folder / name).mkdir()
        paths = {"folder": self.folder, "controller": _free_port(), "node": _free_port()}
        (self.folder / "slurm.conf").write_text(CONFIGURATION.format(cores=CORES, **paths))
        for number, device in enumerate(("null", "zero")):  # SLURM takes any device for a GPU
            (self.folder / f"gpu{number}").symlink_to(f"/dev/{device}")
        (self.folder / "gres.conf").write_text(f"Name=gpu File={self.folder}/gpu[0-1]\n")
        key = self.folder / "munge.key"
        key.write_bytes(os.urandom(128))
        key.chmod(0o400)
        files = [
            f"--{name}-file={self.folder}/munge.{name}" for name in ("key", "pid", "seed", "log")
        ]
        socket_file = self.folder / "munge.socket"
        self._daemon("munged", "--force", "--foreground", f"--socket={socket_file}", *files)
        self._wait(socket_file.exists, "munged made no socket")
        self._daemon("slurmctld", "-D")
        self._daemon("slurmd", "-D", "-N", "localhost")
        self._wait(lambda: "idle" in self.run("sinfo", "-h", "-o", "%T"), "no node is idle")

    def run(self, *command: str) -> str:
        """What `command` prints."""
        process = subprocess.run(command, env=self.environment, capture_output=True, text=True)
        return process.stdout

    def stop(self) -> None:
        """End all jobs, then the daemons."""
        self.run("scancel", "--signal=KILL", "--full", "-u", "root")
        self.run("scancel", "-u", "root")
        self._wait(lambda: not self.run("squeue", "-h").strip(), "jobs do not end")
        for daemon in reversed(self.daemons):
            daemon.send_signal(signal.SIGTERM)
            daemon.wait(20)

    def _daemon(self, *command: str) -> None:
        log = (self.folder / f"{command[0]}.out").open("w")
        with log:
            self.daemons.append(
                subprocess.Popen(command, env=self.environment, stdout=log, stderr=log)
            )

    def _wait(self, ready, what: str) -> None:
        until = time.monotonic() + 30
        while not ready():
            if time.monotonic() > until:
                logs = "\n".join(p.read_text()[-2000:] for p in self.folder.glob("*.out"))
                raise TimeoutError(f"{what}:\n{logs}")
            time.sleep(0.1)


def _path() -> str:
    return f"{os.environ['PATH']}:/usr/sbin:/sbin"


def _free_port() -> int:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return free.getsockname()[1]

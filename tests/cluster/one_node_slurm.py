# SPDX-License-Identifier: Apache-2.0
"""A Slurm of one node: Debian's munge, slurmctld and slurmd with a configuration, ports and files of their own in a
folder. No systemd, and no root needed; whoever started it ends it."""
import os
import pathlib
import pwd
import shutil
import socket
import subprocess
import time

PROGRAMS = ["munged", "mungekey", "slurmctld", "slurmd", "sbatch", "scontrol", "squeue", "scancel"]
PATIENCE_S = 120

CONFIGURATION = """\
ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={controller_port}
SlurmdPort={node_port}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
CryptoType=crypto/munge
AuthInfo=socket={folder}/munge.socket
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
MpiDefault=none
SwitchType=switch/none
ReturnToService=2
SlurmdParameters=config_overrides
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=batch_sched_delay=0,sched_interval=1,sched_min_interval=100000
KillWait=5
NodeName=node NodeHostname={host} NodeAddr=127.0.0.1 CPUs={cores} State=UNKNOWN
PartitionName=all Nodes=node Default=YES MaxTime=INFINITE State=UP
"""


class NoSlurm(Exception):
    """Why there is none here, in one line."""


def program(name):
    return shutil.which(name) or shutil.which(name, path="/usr/sbin:/sbin")


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    try:
        for one in sockets:
            one.bind(("127.0.0.1", 0))
        return [one.getsockname()[1] for one in sockets]
    finally:
        for one in sockets:
            one.close()


class OneNodeSlurm:
    """Use it with "with": its daemons end with the block."""

    def __init__(self, folder, cores=4):
        missing = [name for name in PROGRAMS if not program(name)]
        if missing:
            raise NoSlurm(f"{', '.join(missing)} not installed (Debian: slurmctld slurmd slurm-client munge)")
        self.folder = pathlib.Path(folder)
        self.cores = cores
        self.daemons = []
        self.environment = {**os.environ, "SLURM_CONF": str(self.folder / "slurm.conf")}

    def __enter__(self):
        try:
            self.start()
        except BaseException as error:
            self.stop()
            if not isinstance(error, (OSError, subprocess.SubprocessError)):
                raise
            print(self.logs())
            raise NoSlurm(f"Slurm does not start here: {error}") from error
        return self

    def __exit__(self, *_):
        self.stop()

    def start(self):
        for name in ("state", "spool"):
            (self.folder / name).mkdir()
        controller_port, node_port = free_ports(2)
        (self.folder / "slurm.conf").write_text(CONFIGURATION.format(
            host=socket.gethostname().split(".")[0], user=pwd.getpwuid(os.getuid()).pw_name, folder=self.folder,
            controller_port=controller_port, node_port=node_port, cores=self.cores), encoding="utf-8")
        key = self.folder / "munge.key"
        subprocess.run([program("mungekey"), "--create", f"--keyfile={key}"], check=True)
        # --force: the folder may be one that others can write to.
        self.daemon("munged", "--foreground", "--force", f"--key-file={key}", f"--socket={self.folder}/munge.socket",
                    f"--pid-file={self.folder}/munged.pid", f"--seed-file={self.folder}/munge.seed",
                    f"--log-file={self.folder}/munged.log")
        self.wait_for("munge's socket", (self.folder / "munge.socket").exists)
        self.daemon("slurmctld", "-D", "-i")
        self.daemon("slurmd", "-D")
        self.wait_for("the node", lambda: self.node_state() == "IDLE")

    def daemon(self, name, *arguments):
        with open(self.folder / f"{name}.out", "wb") as out:
            self.daemons.append(subprocess.Popen([program(name), *arguments], env=self.environment, stdout=out,
                                                 stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL))

    def stop(self):
        if (self.folder / "slurm.conf").exists() and len(self.daemons) == 3:
            self.command("scancel", "--user", pwd.getpwuid(os.getuid()).pw_name, check=False)
            self.wait_for("the end of all jobs", lambda: not self.queue(), check=False)
        for daemon in reversed(self.daemons):
            daemon.terminate()
        for daemon in reversed(self.daemons):
            try:
                daemon.wait(20)
            except subprocess.TimeoutExpired:
                daemon.kill()
                daemon.wait()
        self.daemons = []

    def logs(self):
        return "\n".join(f"--- {path.name}\n{path.read_text(errors='replace')[-3000:]}"
                         for pattern in ("*.log", "*.out") for path in sorted(self.folder.glob(pattern)))

    def wait_for(self, what, condition, check=True):
        """Polls. Throws TimeoutError after two minutes, or when a daemon has ended."""
        end = time.monotonic() + PATIENCE_S
        while not condition():
            ended = [daemon.args[0] for daemon in self.daemons if daemon.poll() is not None]
            if ended or time.monotonic() > end:
                if check:
                    raise TimeoutError(f"{what} did not come" + (f", {ended[0]} has ended" if ended else ""))
                return
            time.sleep(0.1)

    def command(self, name, *arguments, check=True):
        return subprocess.run([program(name), *map(str, arguments)], env=self.environment, check=check,
                              stdin=subprocess.DEVNULL, capture_output=True, text=True).stdout

    def node_state(self):
        shown = self.command("scontrol", "--oneliner", "show", "node", "node", check=False)
        return shown.partition(" State=")[2].partition(" ")[0]

    def queue(self):
        """{task of its array: (state, number of its own job)} of what is not finished. While others of its array wait,
        some commands take a running task by that number alone."""
        shown = self.command("squeue", "--noheader", "--array", "--format=%K %T %A", check=False)
        return {int(task): (state, job) for task, state, job in map(str.split, shown.splitlines()) if task.isdigit()}

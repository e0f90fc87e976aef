# SPDX-License-Identifier: Apache-2.0
"""tools/cluster: an array of eight shards on a Slurm of one node, whose tasks are ended in all ways while they work, and
the same shards with GNU parallel. What they make together is what one run makes.

usage: slurm_test.py DISPARITYCTL
"""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import one_node_slurm

CLUSTER = pathlib.Path(__file__).resolve().parents[2] / "tools" / "cluster"
SHARDS = 8
OPTIONS = ["--disparities", "16"]
# The order of the bytes gives each shard a short one first, then a long one, in which it is ended.
SHORT = [f"scene:vga?frames=2&width=96&height=64&seed={seed}" for seed in range(SHARDS)]
LONG = [f"scene:vga?frames=500&width=192&height=112&seed={seed}" for seed in range(SHARDS)]
PROGRAM = ""


class Shards(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory(prefix="cluster")
        cls.addClassCleanup(cls.temporary.cleanup)
        cls.folder = pathlib.Path(cls.temporary.name)
        cls.list = cls.folder / "list"
        cls.list.write_text("\n".join(SHORT + LONG) + "\n", encoding="utf-8")
        cls.ctl("process", "--list", cls.list, "-o", cls.folder / "whole", *OPTIONS)

    @classmethod
    def ctl(cls, *arguments):
        done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise AssertionError(f"{arguments}: {done.returncode}\n{done.stdout[-2000:]}\n{done.stderr[-2000:]}")

    def expect_whole(self, out):
        self.ctl("verify", out, "--against", self.folder / "whole")
        self.assertEqual(len(list(out.iterdir())), len(SHORT + LONG))

    def test_slurm(self):
        slurm_folder = self.folder / "slurm"
        slurm_folder.mkdir()
        try:
            slurm = one_node_slurm.OneNodeSlurm(slurm_folder, cores=2)
            with slurm:
                Array(self, slurm, self.folder / "array").run()
        except one_node_slurm.NoSlurm as reason:
            self.skipTest(str(reason))
        self.expect_whole(self.folder / "array")

    @unittest.skipUnless(shutil.which("parallel"), "GNU parallel is not installed (Debian: parallel)")
    def test_parallel(self):
        hosts = self.folder / "hosts"
        hosts.write_text(":\n", encoding="utf-8")
        out = self.folder / "parallel"
        command = [CLUSTER / "over-ssh", hosts, "3", self.list, out, *OPTIONS, "--workers", "1"]
        environment = {**os.environ, "DISPARITYCTL": PROGRAM, "HOME": str(self.folder)}
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.expect_whole(out)
        refused = subprocess.run([*command[:1], "hosts"], capture_output=True, text=True, check=False)
        self.assertEqual((refused.returncode, refused.stdout), (2, ""))


    @unittest.skipUnless(shutil.which("parallel"), "GNU parallel is not installed (Debian: parallel)")
    def test_ranges_by_parallel(self):
        hosts, one, out = (self.folder / name for name in ("hosts of ranges", "one source", "ranges"))
        hosts.write_text(":\n", encoding="utf-8")
        one.write_text(LONG[0] + "\n", encoding="utf-8")
        options = [*OPTIONS, "--no-trust", "--no-adaptive-noise"]
        self.ctl("process", "--list", one, "-o", self.folder / "whole source", *options)
        command = [CLUSTER / "over-ssh", hosts, "4", one, out, *options, "--split", "--workers", "1"]
        environment = {**os.environ, "DISPARITYCTL": PROGRAM, "HOME": str(self.folder)}
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.ctl("verify", out, "--against", self.folder / "whole source")
        self.assertEqual(list(out.glob("range-*")), [], done.stdout + done.stderr)


class Array:
    """The array, and what befalls its tasks."""

    def __init__(self, test, slurm, out):
        self.test = test
        self.slurm = slurm
        self.out = out
        self.logs = slurm.folder / "tasks"
        self.logs.mkdir()
        self.job = ""

    def run(self):
        self.slurm.environment["DISPARITYCTL"] = PROGRAM
        said = self.slurm.command("sbatch", f"--array=0-{SHARDS - 1}", "--cpus-per-task=1", "--mem=0",
                                  f"--output={self.logs}/%a", CLUSTER / "slurm-array", SHARDS, Shards.list, self.out,
                                  *OPTIONS)
        self.job = said.split()[-1]
        # Each ending is tried on the next task where one came too late.
        endings = [self.time_is_over, self.killed, self.requeued]
        for task in range(SHARDS - 1):
            if endings and endings[0](task):
                endings.pop(0)
        self.test.assertEqual(endings, [], self.told())
        self.drain()
        self.slurm.wait_for("the end of the array", self.ended)
        for task in range(SHARDS):
            last = self.told(task).strip().splitlines()[-1]
            self.test.assertRegex(last, rf"\Ashard {task}/8 on node: exit status 0, 0 failed, \d finished, 0 left; "
                                        r"\d+ frames in [\d.]+ s, [\d.]+ frames/s, [\d.]+ frames/s per core of 1\Z")

    def told(self, task="*"):
        return "\n".join(path.read_text() for path in sorted(self.logs.glob(str(task))))

    def states(self):
        return {task: state for task, (state, _) in self.slurm.queue().items()}

    def signal(self, name, task):
        _, job = self.slurm.queue().get(task, ("", ""))
        if job:
            self.slurm.command("scancel", f"--signal={name}", f"{job}.0", check=False)

    def within_long_source(self, task):
        """Waits until a task has begun its long source; false: it has ended before that was seen."""
        begun = self.out / LONG[task] / ".manifest.json.part"
        self.slurm.wait_for(f"task {task}", lambda: begun.exists() or task not in self.states())
        return begun.exists()

    def time_is_over(self, task):
        """As Slurm does 120 s before the end of --time."""
        if not self.within_long_source(task):
            return False
        self.signal("TERM", task)
        self.slurm.wait_for(f"the end of task {task}", lambda: "exit status" in self.told(task))
        if "exit status 75, 0 failed, 1 finished, 1 left" not in self.told(task):
            return False
        self.slurm.wait_for(f"task {task} in the queue again", lambda: self.states().get(task) == "PENDING")
        return True

    def killed(self, task):
        if not self.within_long_source(task):
            return False
        self.signal("KILL", task)
        self.slurm.wait_for(f"the end of task {task}", lambda: task not in self.states())
        if "exit status 137" not in self.told(task):
            return False
        self.slurm.command("scontrol", "requeue", f"{self.job}_{task}")
        return True

    def requeued(self, task):
        if not self.within_long_source(task):
            return False
        self.slurm.command("scontrol", "requeue", f"{self.job}_{task}", check=False)
        self.slurm.wait_for(f"task {task} in the queue again", lambda: self.states().get(task) in ("PENDING", None))
        return task in self.states()

    def drain(self):
        """Nothing starts on a node that is drained."""
        self.slurm.command("scontrol", "update", "nodename=node", "state=drain", "reason=test")
        self.slurm.wait_for("a drained node", lambda: self.slurm.node_state() == "IDLE+DRAIN")
        self.begin_at_once()
        self.test.assertEqual(set(self.states().values()), {"PENDING"})
        self.slurm.command("scontrol", "update", "nodename=node", "state=resume")

    def begin_at_once(self):
        """What is requeued would wait for two minutes."""
        for task, state in self.states().items():
            if state == "PENDING":
                self.slurm.command("scontrol", "update", f"JobId={self.job}_{task}", "StartTime=now", check=False)

    def ended(self):
        self.begin_at_once()
        return not self.states()


if __name__ == "__main__":
    PROGRAM = str(pathlib.Path(sys.argv.pop(1)).resolve())
    result = unittest.main(exit=False).result
    for _, why in result.skipped:
        print(f"skipped: {why}")
    sys.exit(1 if not result.wasSuccessful() else 77 if len(result.skipped) == result.testsRun else 0)

# SPDX-License-Identifier: Apache-2.0
"""tools/benchmarks --against in a repository made for it, whose programs print made-up times."""
import os
import pathlib
import select
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest

PROJECT = pathlib.Path(__file__).resolve().parents[2]
AUTHOR = ["-c", "user.name=A", "-c", "user.email=a@example.org", "-c", "commit.gpgsign=false"]
# Programs are scripts, so that nothing is compiled.
CMAKE = """cmake_minimum_required(VERSION 3.22)
project(made LANGUAGES NONE)
add_custom_target(cpu_kernels_check COMMAND ${CMAKE_COMMAND} -E copy ${CMAKE_SOURCE_DIR}/kernels.sh
  ${CMAKE_BINARY_DIR}/bin/cpu_kernels_check)
"""


def kernels(**times):
    rows = "\n".join(f"echo '{name}   9.000   {time:.3f}'" for name, time in times.items())
    return f"#!/bin/sh\necho 'kernel  D  reference  SET'\n{rows}\n"


@unittest.skipUnless(all(map(shutil.which, ("git", "cmake", "ninja"))), "git, cmake or ninja is not installed")
class BenchmarkGate(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name).resolve()
        (self.root / "tools").mkdir()
        shutil.copy(PROJECT / "tools" / "benchmarks", self.root / "tools")
        shutil.copytree(PROJECT / "tools" / "setup", self.root / "tools" / "setup")
        (self.root / ".gitignore").write_text("/build/\n", encoding="utf-8")
        (self.root / "CMakeLists.txt").write_text(CMAKE, encoding="utf-8")
        self.write_kernels(kernels(census=1.0, median=2.0))
        self.git("init", "--quiet")
        self.git("add", ".")
        self.git("commit", "--quiet", "--message", "Before")

    def git(self, *arguments):
        command = ["git", "-C", str(self.root), *AUTHOR, *arguments]
        return subprocess.run(command, check=True, capture_output=True, text=True).stdout

    def write_kernels(self, script):
        path = self.root / "kernels.sh"
        path.write_text(script, encoding="utf-8")
        path.chmod(0o755)

    def command(self, *arguments):
        return ["bash", str(self.root / "tools" / "benchmarks"), "--against", *arguments]

    def hear(self, pipe, gate):
        """What a program writes into a pipe; fails when the gate ends before."""
        reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
        try:
            while gate.poll() is None:
                if select.select([reader], [], [], 0.1)[0]:
                    return os.read(reader, 100).decode()
        finally:
            os.close(reader)
        return self.fail(f"the gate ended with {gate.returncode}")

    def run_gate(self, *arguments):
        ran = subprocess.run(self.command(*arguments), capture_output=True, check=False, text=True)
        self.check_nothing_is_left()
        return ran.returncode, ran.stdout, ran.stderr

    def check_nothing_is_left(self):
        self.assertEqual(len(self.git("worktree", "list").splitlines()), 1)
        self.assertFalse((self.root / "build" / "against" / "source").exists())

    def test_equal_times_pass(self):
        status, output, errors = self.run_gate("HEAD", "--rounds", "2")
        self.assertEqual((status, errors), (0, ""), output)
        self.assertIn("0 of 2 are more than 5 % slower", output)
        self.assertIn("disparity-bench is left out: there is none in before and after", output)

    def test_a_slower_kernel_fails_and_is_named(self):
        self.write_kernels(kernels(census=1.2, median=2.0, speckle=1.0))  # not committed
        status, output, _ = self.run_gate("HEAD", "--rounds", "3")
        self.assertEqual(status, 1, output)
        self.assertRegex(output, r"census SET +1 +1\.2 +1\.200  SLOWER\n")
        self.assertRegex(output, r"speckle SET .* new: not judged\n")
        self.assertIn("1 of 2 are more than 5 % slower:\n  census SET: 20.0 %\n", output)
        self.assertEqual(self.run_gate("HEAD", "--rounds", "1", "--limit", "25")[0], 0)
        self.assertEqual(self.run_gate("HEAD", "--rounds", "1", "--kernels", "median")[0], 0)

    def test_mistakes_are_told(self):
        for arguments, status, text in (
            (["none"], 2, "found 'none', allowed: a commit, branch or tag"),
            (["HEAD", "--rounds", "0"], 2, "found '0', allowed"),
            (["HEAD", "--limit", "x"], 2, "found 'x', allowed"),
            (["HEAD", "--kernels", "nothing", "--rounds", "2"], 2, "is in no kernel's name"),
        ):
            with self.subTest(arguments=arguments):
                got, _, errors = self.run_gate(*arguments)
                self.assertEqual(got, status, errors)
                self.assertIn(text, errors)

    def test_a_build_that_fails_names_its_log(self):
        (self.root / "CMakeLists.txt").write_text("message(FATAL_ERROR no)\n", encoding="utf-8")
        status, _, errors = self.run_gate("HEAD")
        self.assertEqual(status, 1)
        self.assertIn("after: configuring failed, see build/against/after.txt", errors)

    def test_an_interrupt_leaves_nothing(self):
        told = self.root / "told"
        os.mkfifo(told)
        # The program says its number, then never ends by itself.
        self.write_kernels(f"#!/bin/sh\necho $$ >{told}\nexec sleep infinity\n")
        for number in (signal.SIGINT, signal.SIGTERM):
            # What a shell starts in the background ignores Ctrl-C, and so does what that starts.
            with self.subTest(signal=number), subprocess.Popen(
                    self.command("HEAD"), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                    preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL)) as gate:
                program = int(self.hear(told, gate))
                gate.send_signal(number)
                _, errors = gate.communicate()
                self.assertEqual(gate.returncode, 130, errors)
                self.assertIn("interrupted", errors)
                with self.assertRaises(ProcessLookupError):
                    os.kill(program, 0)
                self.check_nothing_is_left()

    def test_two_at_a_time_are_refused(self):
        told, end = self.root / "told", self.root / "end"
        os.mkfifo(told)
        os.mkfifo(end)
        self.write_kernels(f"#!/bin/sh\necho here >{told}\nread line <{end}\n" + kernels(census=1.0)[10:])
        with subprocess.Popen(self.command("HEAD", "--rounds", "1"), stdout=subprocess.PIPE, text=True) as first:
            self.hear(told, first)
            second = subprocess.run(self.command("HEAD"), capture_output=True, check=False, text=True)
            end.write_text("go on\n", encoding="utf-8")
            output, _ = first.communicate()
        self.assertEqual(second.returncode, 1)
        self.assertIn("another comparison runs", second.stderr)
        self.assertEqual(first.returncode, 0, output)


if __name__ == "__main__":
    sys.exit(unittest.main())

# SPDX-License-Identifier: Apache-2.0
"""Programs that the soak test starts: how they are asked to end, what they say, what they use of the system."""
import os
import pathlib
import select
import signal
import subprocess
import time

# How long the test waits for what must come: far longer than a busy machine needs.
PATIENCE_S = 60


class Failure(Exception):
    """The daemon, or a program beside it, does not do what it must. The text is one line."""


def wait_for(what, condition, patience=PATIENCE_S):
    """Asks until the answer is true, and returns it. Raises Failure with `what` when it never is."""
    deadline = time.monotonic() + patience
    while True:
        answer = condition()
        if answer:
            return answer
        if time.monotonic() > deadline:
            raise Failure(f"{what} did not come in {patience} s")
        time.sleep(0.02)


class Child:
    """A program with a pipe as standard input and output; standard error goes to a file."""

    def __init__(self, name, command, log, environment=None):
        self.name = name
        self.log = pathlib.Path(log)
        with self.log.open("ab") as errors:
            self.process = subprocess.Popen([str(word) for word in command], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                            stderr=errors, env={**os.environ, **(environment or {})})
        self._unread = b""

    @property
    def pid(self):
        return self.process.pid

    def line(self, patience=PATIENCE_S):
        """Returns the next line of its output, without the end of the line."""
        deadline = time.monotonic() + patience
        while b"\n" not in self._unread:
            ready, _, _ = select.select([self.process.stdout], [], [], max(0, deadline - time.monotonic()))
            got = os.read(self.process.stdout.fileno(), 65536) if ready else b""
            if not got:
                raise Failure(f"{self.name}: {'ended' if ready else 'silent'}: {self.last_words()}")
            self._unread += got
        text, _, self._unread = self._unread.partition(b"\n")
        return text.decode("utf-8", "replace")

    def last_words(self):
        """The end of what it has written to standard error, in one line."""
        words = self.log.read_text("utf-8", "replace").strip().splitlines()
        return words[-1] if words else "nothing in its log"

    def send(self, number):
        self.process.send_signal(number)

    def ask_to_end(self):
        """Programs of this test end when their standard input does."""
        self.process.stdin.close()

    def status(self, patience=PATIENCE_S):
        """Returns its exit status, once it has ended."""
        try:
            return self.process.wait(patience)
        except subprocess.TimeoutExpired:
            raise Failure(f"{self.name} has not ended in {patience} s: {self.last_words()}") from None

    def rest(self):
        """What is left of the output of a program that has ended, without the lines that were read before."""
        return (self._unread + self.process.stdout.read()).decode("utf-8", "replace")

    def kill(self):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGKILL)
        self.process.wait()
        self.close()

    def close(self):
        for pipe in (self.process.stdin, self.process.stdout):
            pipe.close()


class Use:
    """What a process has of the system at one instant."""

    def __init__(self, pid):
        root = pathlib.Path(f"/proc/{pid}")
        self.descriptors = len(os.listdir(root / "fd"))
        self.threads = len(os.listdir(root / "task"))
        self.memory_mib = 0.0
        for line in (root / "status").read_text("ascii", "replace").splitlines():
            # The process's own memory: not its files, not the shared memory that it serves.
            if line.startswith("RssAnon:"):
                self.memory_mib = int(line.split()[1]) / 1024


def open_files(pid):
    """Returns what the descriptors of a process lead to, for a message."""
    found = []
    for entry in os.scandir(f"/proc/{pid}/fd"):
        try:
            found.append(os.readlink(entry.path))
        except FileNotFoundError:
            pass
    return sorted(found)

# SPDX-License-Identifier: Apache-2.0
"""Clients of all kinds: each comes, reads, and leaves in order or is killed. `leave()` returns the client's account."""
import json
import os
import signal

import pages
from children import PATIENCE_S, Child, Failure, wait_for

# What a client is told once when a reload takes away what it has subscribed to (docs/protocol.md).
ALLOWED_REFUSALS = ("a subscribed product is no longer served since the daemon was reconfigured",)


class Reader:
    """A program that says "frame" at its first frame, ends when its standard input does, and then prints its account."""

    def __init__(self, kind, command, course, daemon, environment=None):
        self.kind = kind
        self.child = Child(f"{kind} at {daemon.name}", command, course.folder / f"reader-{course.next_number()}-log", environment)
        try:
            if (line := self.child.line()) != "frame":
                raise Failure(f"{self.child.name} says {line}")
        except Failure:
            self.child.kill()
            raise

    def leave(self):
        self.child.ask_to_end()
        status = self.child.status(2 * PATIENCE_S)
        said = self.child.rest()
        self.child.close()
        if status != 0:
            raise Failure(f"{self.child.name} ended with {status}: {self.child.last_words()}")
        account = json.loads(said) if said else {"frames": 0, "skipped": 0, "first": 0, "last": -1, "age_ms": [], "refusals": []}
        if account["frames"] + account["skipped"] != account["last"] - account["first"] + 1:
            raise Failure(f"{self.child.name}: frames are neither seen nor counted as missed: {account}")
        for refusal in account["refusals"]:
            if not any(words in refusal for words in ALLOWED_REFUSALS):
                raise Failure(f"{self.child.name} was refused: {refusal}")
        return account

    def vanish(self):
        self.child.kill()


class Watch:
    """disparityctl watch: a line each second."""

    def __init__(self, course, daemon, arguments):
        self.kind = "disparityctl watch"
        self._output = course.folder / f"watch-{course.next_number()}"
        command = [course.programs / "disparityctl", "watch", "--json", *arguments]
        # A file takes whatever it says; a pipe that nobody reads would stop it.
        self.child = Child(f"{self.kind} at {daemon.name}", ["/bin/sh", "-c", f'exec "$@" >{self._output}', "sh", *command],
                           course.folder / f"{self._output.name}-log")
        self._wait_for_line()

    def _lines(self):
        return self._output.read_text("utf-8", "replace").splitlines() if self._output.exists() else []

    def _wait_for_line(self):
        before = len(self._lines())

        def more():
            if self.child.process.poll() is not None:
                raise Failure(f"{self.child.name} ended with {self.child.process.returncode}: {self.child.last_words()}")
            return len(self._lines()) > before
        wait_for(f"a line of {self.child.name}", more)

    def leave(self):
        self._wait_for_line()
        self.child.send(signal.SIGINT)
        status = self.child.status()
        self.child.close()
        if status != 0:
            raise Failure(f"{self.child.name} ended with {status}: {self.child.last_words()}")
        lines = [json.loads(line) for line in self._lines()]
        self._output.unlink()
        return {"frames": len(lines), "age_ms": []}

    def vanish(self):
        self.child.kill()
        self._output.unlink(missing_ok=True)


def socket_reader(manner):
    def come(course, daemon):
        address = course.random.choice([daemon.tcp, daemon.unix])
        return Reader(f"C++, {manner}", [course.test_programs / "soak_reader", address, manner], course, daemon)
    return come


def memory_reader(manner):
    def come(course, daemon):
        return Reader(f"C++, {manner} of shared memory", [course.test_programs / "soak_reader", daemon.shm, manner], course, daemon)
    return come


def wire(manner):
    def come(course, daemon):
        address = course.random.choice([daemon.tcp, daemon.unix])
        return Reader(f"bare socket, {manner}", [course.test_programs / "soak_wire", address, manner], course, daemon)
    return come


def c_reader(course, daemon):
    address = course.random.choice([daemon.tcp, daemon.unix, daemon.shm])
    return Reader("C", [course.test_programs / "soak_c_reader", address], course, daemon)


def python_reader(course, daemon):
    address = course.random.choice([daemon.tcp, daemon.unix, daemon.shm])
    path = os.pathsep.join(filter(None, [str(course.python), os.environ.get("PYTHONPATH")]))
    return Reader("Python", [course.interpreter, "-B", course.here / "soak_reader.py", address], course, daemon, {"PYTHONPATH": path})


def watch(course, daemon):
    return Watch(course, daemon, course.random.choice([["--socket", daemon.unix], ["--socket", daemon.tcp],
                                                       ["--name", daemon.shared_memory, "--socket", daemon.unix]]))


def of_web(kind):
    def come(course, daemon):
        visitor = kind(course.webs[daemon.name])
        visitor.kind = {"Page": "page", "LosslessPage": "page, lossless", "Viewer": "Foxglove viewer", "Stream": "MJPEG stream",
                        "Silent": "half a request"}[kind.__name__]
        return visitor
    return come


def kinds(with_python):
    """Returns what makes a client of each kind."""
    all_kinds = [socket_reader("raw"), socket_reader("everything"), socket_reader("zstd"), socket_reader("region"),
                 memory_reader("copy"), memory_reader("borrow"), wire("account"), wire("slow"), wire("torn"), c_reader, watch,
                 *map(of_web, (pages.Page, pages.LosslessPage, pages.Viewer, pages.Stream, pages.Silent))]
    return all_kinds + [python_reader] if with_python else all_kinds

# SPDX-License-Identifier: Apache-2.0
"""disparityd and disparity-web as the soak test starts them, configures them anew and asks them."""
import http.client
import json
import pathlib
import re
import signal
import subprocess

from children import PATIENCE_S, Child, Failure, wait_for

SERVING = re.compile(r"serving .*: \d+ x \d+")
REFUSED = "nothing is changed, the new configuration is refused"


class Daemon:
    """A daemon with a folder of its own for configuration, sockets and recordings."""

    def __init__(self, name, programs, folder, source):
        self.name = name
        self.programs = programs
        self.folder = folder / name
        self.recordings = self.folder / "recordings"
        self.recordings.mkdir(parents=True)
        self.source = source
        self.shared_memory = f"soak-{folder.name}-{name}"
        self.unix = f"unix:{self.folder}/socket"
        self.config = self.folder / "disparityd.toml"
        self.write_config({})
        self.child = Child(f"disparityd ({name})", [programs / "disparityd", "--print-address", "--config", self.config],
                           self.folder / "log")
        addresses = []
        while (line := self.child.line()) != "ready":
            addresses.append(line)
        self.tcp = next(address for address in addresses if address.startswith("tcp:"))
        self.reloads = 0
        self.faults = 0

    @property
    def shm(self):
        return f"shm:{self.shared_memory}"

    @property
    def shared_memory_file(self):
        return pathlib.Path("/dev/shm") / f"disparityd.{self.shared_memory}"

    def write_config(self, changes):
        """Writes the configuration: small images, of which `changes` ("section.key": value) may change anything."""
        keys = {"source.uri": self.source, "source.loop": True, "rectify.width": 160, "rectify.height": 88, "match.method": "census",
                "match.disparities": 32, "pipeline.workers": 1, "shared_memory.name": self.shared_memory,
                "socket.tcp": "127.0.0.1:0", "socket.unix": self.unix.removeprefix("unix:"), "socket.idle_timeout_s": 5,
                "record.directory": str(self.recordings), "record.keep_free_mb": 0, **changes}
        sections = {}
        for key, value in keys.items():
            section, _, name = key.partition(".")
            sections.setdefault(section, []).append(f"{name} = {json.dumps(value)}")
        self._put("".join(f"[{section}]\n" + "\n".join(lines) + "\n" for section, lines in sections.items()))

    def _put(self, text):
        """In one step: the daemon may be about to read the file."""
        new = self.config.with_suffix(".new")
        new.write_text(text)
        new.replace(self.config)

    def log_lines(self):
        return self.child.log.read_text("utf-8", "replace").splitlines()

    def _count(self, wanted):
        return sum(1 for line in self.log_lines() if wanted(line))

    def reload(self, changes, text=None):
        """Loads a configuration, or `text` in its place. Returns whether it was taken."""
        self.write_config(changes)
        if text is not None:
            self._put(text)
        taken, refused = self._count(SERVING.search), self._count(lambda line: REFUSED in line)
        self.child.send(signal.SIGHUP)
        wait_for(f"{self.child.name}: an answer to SIGHUP",
                 lambda: self._count(SERVING.search) > taken or self._count(lambda line: REFUSED in line) > refused)
        self.reloads += 1
        return self._count(SERVING.search) > taken

    def reload_and_run(self, changes):
        if not self.reload(changes):
            raise Failure(f"{self.child.name} refuses {changes}: {self.child.last_words()}")
        self.wait_until_running()

    def control(self, *arguments, patience=PATIENCE_S):
        """Runs disparityctl for this daemon, and returns what it did."""
        try:
            return subprocess.run([self.programs / "disparityctl", *arguments, "--socket", self.unix], capture_output=True, text=True,
                                  check=False, timeout=patience, stdin=subprocess.DEVNULL)
        except subprocess.TimeoutExpired:
            raise Failure(f"disparityctl {' '.join(arguments)} has not ended in {patience} s") from None

    def status(self):
        if self.child.process.poll() is not None:
            raise Failure(f"{self.child.name} has ended with {self.child.process.returncode}: {self.child.last_words()}")
        answer = self.control("status", "--json")
        if answer.returncode != 0:
            raise Failure(f"disparityctl status: {answer.stderr.strip()}")
        return json.loads(answer.stdout)

    def wait_for_state(self, state):
        return wait_for(f"{self.child.name}: the state {state}", lambda: self.status()["state"] == state)

    def wait_until_running(self):
        wait_for(f"{self.child.name}: a frame",
                 lambda: (status := self.status())["state"] == "running" and status["published"] > 0)

    def wait_for_frames(self, count):
        """Waits until so many more have been published by the same configuration."""
        end = self.status()["published"] + count
        wait_for(f"{self.child.name}: {count} frames", lambda: self.status()["published"] >= end, PATIENCE_S + count)

    def stop(self):
        """Ends it as systemd does."""
        self.child.send(signal.SIGTERM)
        status = self.child.status()
        self.child.close()
        return status


class Web:
    """disparity-web beside a daemon."""

    def __init__(self, daemon):
        self.daemon = daemon
        self.child = None
        self.port = 0
        self.starts = 0
        self.start()

    def start(self):
        self.child = Child(f"disparity-web ({self.daemon.name})",
                           [self.daemon.programs / "disparity-web", "--socket", self.daemon.unix, "--listen", "127.0.0.1:0",
                            "--allow-control"], self.daemon.folder / "web-log")
        self.port = int(re.search(r":(\d+)/?$", self.child.line().strip()).group(1))
        self.starts += 1
        wait_for(f"{self.child.name}: the daemon's status", lambda: self.ask("GET", "/healthz")[0] == 200)

    def stop(self, number=signal.SIGTERM):
        self.child.send(number)
        status = self.child.status()
        self.child.close()
        return status

    def ask(self, method, target, body=None):
        """Returns the status and the body of the answer to a request."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=PATIENCE_S)
        try:
            connection.request(method, target, body, {"Content-Type": "application/json"} if body else {})
            answer = connection.getresponse()
            return answer.status, answer.read()
        except (OSError, http.client.HTTPException) as error:
            raise Failure(f"{self.child.name}: {method} {target}: {error!r}") from None
        finally:
            connection.close()

    def counts(self):
        """Returns the samples of /metrics that have no labels."""
        status, text = self.ask("GET", "/metrics")
        if status != 200:
            raise Failure(f"{self.child.name}: /metrics answers {status}")
        return {name: float(value) for name, value in re.findall(r"^(\w+) (\S+)$", text.decode(), re.MULTILINE)}

# SPDX-License-Identifier: Apache-2.0
"""disparityd as a child of a program that measures it: started, asked for its status, looked at, ended."""
import json
import os
import pathlib
import signal
import subprocess
import sys
import time

TICKS = os.sysconf("SC_CLK_TCK")
START_LIMIT_S = 300
STOP_LIMIT_S = 10


def fail(text):
    sys.exit(f"lab/{pathlib.Path(sys.argv[0]).name}: error: {text}")


def processor_seconds(stat):
    """utime + stime of a stat file; the name before them may hold anything but ends with the last bracket."""
    fields = pathlib.Path(stat).read_text(encoding="ascii", errors="replace").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / TICKS


class MeasuredDaemon:
    """The socket and the log lie in the folder; `number` tells several apart there. `settings`: KEY=VALUE, as disparityd has it."""

    def __init__(self, programs, folder, source, settings, number=0, cores=""):
        self.control = f"{programs}/disparityctl"
        self.socket = f"unix:{folder}/socket-{number}"
        self.log = pathlib.Path(folder, f"log-{number}")
        command = ["taskset", "--cpu-list", cores] if cores else []
        command += [f"{programs}/disparityd", "--source", source, "--name", f"measured-{os.getpid()}-{number}"]
        for setting in [f"socket.unix={folder}/socket-{number}", "socket.tcp=", *settings]:
            command += ["--set", setting]
        with self.log.open("w", encoding="utf-8") as log:
            try:
                self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=log, stderr=log)
            except OSError as error:
                fail(f"{command[0]}: {error.strerror}")

    def log_text(self):
        return self.log.read_text(encoding="utf-8").strip()

    def status(self):
        """None where it does not answer."""
        answer = subprocess.run([self.control, "status", "--json", "--socket", self.socket],
                                capture_output=True, text=True, check=False)
        return json.loads(answer.stdout) if answer.returncode == 0 else None

    def wait_until_running(self):
        """Until the first frame, or until it is idle: nobody wants frames yet."""
        deadline = time.monotonic() + START_LIMIT_S
        while True:
            if self.process.poll() is not None:
                fail(f"disparityd ended with status {self.process.returncode}: {self.log_text()}")
            status = self.status()
            if status and (status["state"] == "idle" or status["state"] == "running" and status["published"] > 0):
                return
            if time.monotonic() > deadline:
                fail(f"no frame after {START_LIMIT_S} s: {self.log_text()}")
            time.sleep(0.5)

    def snapshot(self):
        """Time, processor time of the process, status."""
        return {"time": time.monotonic(), "processor": processor_seconds(f"/proc/{self.process.pid}/stat"), "status": self.status()}

    def end(self):
        self.process.send_signal(signal.SIGTERM)
        try:
            self.process.wait(STOP_LIMIT_S)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()

# SPDX-License-Identifier: Apache-2.0
"""The course of a soak test: clients come and go, things happen, and from time to time everybody leaves and all is counted."""
import pathlib
import random
import re
import shutil
import subprocess
import time

import events
import visitors
from children import PATIENCE_S, Failure, Use, open_files, wait_for
from daemons import Daemon, Web

SOURCE = "scene:vga@10?width=320&height=176&loop=8"
RECORDED_FRAMES = 30
MOST_VISITORS = 10

# Lines of level error that the events provoke.
EXPECTED_ERRORS = (
    r"nothing is changed, the new configuration is refused: ",
    r"the source failed: .*damaged\.mkv",
)
ERROR_LINE = re.compile(r"^\S+ error\s+(.*)")
WARNING_LINE = re.compile(r"^\S+ warning\s+(.*)")


class Rest:
    """What a process had of the system while nobody but the test was there."""

    def __init__(self, seconds, use):
        self.seconds = seconds
        self.use = use


class Course:
    def __init__(self, options, folder):
        self.random = random.Random(options.seed)
        self.folder = folder
        self.programs = options.bin
        self.test_programs = options.bin
        self.python = options.python
        self.interpreter = options.interpreter
        self.here = pathlib.Path(__file__).resolve().parent
        self.seconds = options.seconds
        self.growth = options.growth
        self.kinds = visitors.kinds(options.with_python)
        self.began = time.monotonic()
        self.steps = 0
        self._number = 0
        self.visitors = []  # each with the name of its daemon
        self.seen = {}  # by kind: visits, frames, missed, ages, killed
        self.happened = {}  # by event: how often
        self.rests = {}  # by program: what it had when everybody had left
        self.readings = []  # lines for people
        self.recorded_frames = RECORDED_FRAMES
        self.recording = folder / "recording.mkv"
        self.small_disks = {}
        self.daemons = {}
        self.webs = {}

    # What the events use.

    def next_number(self):
        self._number += 1
        return self._number

    def small_disk(self, daemon):
        return self.small_disks[daemon.name]

    # The life of the test.

    def start(self):
        done = subprocess.run([self.programs / "disparityctl", "record", self.recording, "--source", SOURCE, "--frames",
                               str(RECORDED_FRAMES)], capture_output=True, text=True, check=False, timeout=5 * PATIENCE_S)
        if done.returncode != 0:
            raise Failure(f"disparityctl record: {done.stderr.strip()}")
        for name, source in (("live", SOURCE), ("replay", str(self.recording))):
            self.daemons[name] = Daemon(name, self.programs, self.folder, source)
            self.small_disks[name] = events.mount_small_disk(self.daemons[name].recordings / "small")
            self.webs[name] = Web(self.daemons[name])

    def run(self):
        """Until the time is over. The first rest is after every kind of client and event was there once."""
        for kind in self.kinds:
            for daemon in self.daemons.values():
                self._come(kind, daemon)
                if len(self.visitors) >= MOST_VISITORS:
                    self._go()
        for event in events.EVENTS:
            for daemon in self.daemons.values():
                self._happen(event, daemon)
        self.rest()
        # Short tests rest often enough to see a trend, long ones let leaks grow.
        interval = max(40, self.seconds / 12)
        next_rest = time.monotonic() + interval
        while time.monotonic() - self.began < self.seconds:
            self._step()
            if time.monotonic() > next_rest:
                self.rest()
                next_rest = time.monotonic() + interval
        self.rest()

    def _step(self):
        self.steps += 1
        daemon = self.random.choice(list(self.daemons.values()))
        what = self.random.random()
        if what < 0.4 and len(self.visitors) < MOST_VISITORS:
            self._come(self.random.choice(self.kinds), daemon)
        elif what < 0.7 and self.visitors:
            self._go()
        elif what < 0.85:
            daemon.wait_for_frames(self.random.randint(2, 15))
        else:
            event, = self.random.choices(list(events.EVENTS), list(events.EVENTS.values()))
            self._happen(event, daemon)

    def _happen(self, event, daemon):
        self.happened[event.__name__] = self.happened.get(event.__name__, 0) + 1
        try:
            event(self, daemon)
        except Failure as failure:
            raise Failure(f"{event.__name__} at {daemon.name}: {failure}") from None

    def _come(self, kind, daemon):
        self.visitors.append((daemon.name, kind(self, daemon)))

    def _go(self):
        self._end(self.visitors.pop(self.random.randrange(len(self.visitors)))[1], self.random.random() < 0.3)

    def _end(self, visitor, killed):
        seen = self.seen.setdefault(visitor.kind, {"visits": 0, "killed": 0, "frames": 0, "skipped": 0, "age_ms": []})
        seen["visits"] += 1
        if killed:
            seen["killed"] += 1
            visitor.vanish()
            return
        account = visitor.leave()
        seen["frames"] += account["frames"]
        seen["skipped"] += account.get("skipped", 0)
        if account["age_ms"]:
            seen["age_ms"].append(account["age_ms"])

    def end_web_visitors(self, name):
        leaving = [visitor for where, visitor in self.visitors if where == name and hasattr(visitor, "web")]
        self.visitors = [(where, visitor) for where, visitor in self.visitors if visitor not in leaving]
        for visitor in leaving:
            self._end(visitor, True)

    # Counting.

    def rest(self):
        """Everybody leaves. What each program has of the system is what it needs by itself."""
        while self.visitors:
            self._end(self.visitors.pop()[1], False)
        for daemon in self.daemons.values():
            daemon.reload_and_run({})
            self.check_pipeline(daemon, 4)
            self._look_at(daemon.child)
        self._look_at(self.webs["live"].child)

    def _unaccounted(self, daemon):
        """Returns how many captured frames are neither published nor dropped nor damaged, and the counts as a text."""
        counts = self.webs[daemon.name].counts()
        captured, *ended = (int(counts[f"disparityd_frames_{name}_total"]) for name in ("captured", "published", "dropped", "damaged"))
        return captured - sum(ended), f"{captured} frames captured, {ended[0]} published, {ended[1]} dropped, {ended[2]} damaged"

    def check_pipeline(self, daemon, slots):
        """The stages have no more frames at the moment than they have slots, and one may wait for a slot."""
        under_way, counts = self._unaccounted(daemon)
        if not 0 <= under_way <= slots + 1:
            raise Failure(f"{daemon.child.name}: {counts}: {under_way} are unaccounted for, allowed: 0 to {slots + 1}")

    def check_ended_pipeline(self, daemon):
        """Nothing is under way. disparity-web learns of the end a little later."""
        wait_for(f"{daemon.child.name}: an account of all frames, after the end of its source ({self._unaccounted(daemon)[1]}),",
                 lambda: self._unaccounted(daemon)[0] == 0)

    def _look_at(self, child):
        """Descriptors and threads must be as few as when everybody had left for the first time."""
        rests = self.rests.setdefault(child.name, [])
        if rests:
            first = rests[0].use
            now = Use(child.pid)
            wait_for(f"{child.name}: {first.descriptors} descriptors and {first.threads} threads, as at the first rest; found "
                     f"{now.descriptors} and {now.threads}, open were {open_files(child.pid)}; fewer",
                     lambda: (now := Use(child.pid)).descriptors <= first.descriptors and now.threads <= first.threads)
        rests.append(Rest(time.monotonic() - self.began, Use(child.pid)))

    def check_memory(self):
        """Compares the least of the first rests with the least of the last ones: what a reload leaves behind varies."""
        for name, rests in self.rests.items():
            memory = [rest.use.memory_mib for rest in rests]
            third = max(1, len(memory) // 3)
            early, late = min(memory[:third]), min(memory[-third:])
            if late > early * (1 + self.growth / 100) + 4:
                raise Failure(f"{name}: {early:.1f} MiB at first, {late:.1f} MiB at the end; allowed: {self.growth} % and 4 MiB more "
                              f"({', '.join(f'{mib:.1f}' for mib in memory)} at the rests)")

    # The end.

    def latencies(self):
        """Returns the times of the whole way of a frame, from capture to publication, by daemon."""
        found = {}
        for name, daemon in self.daemons.items():
            total = next(step for step in daemon.status()["steps"] if step["name"] == "total")
            found[name] = [total[f"{part}_us"] / 1000 for part in ("p50", "p90", "p99", "max")]
        return found

    def finish(self):
        """Ends the programs in order. They must leave nothing behind."""
        for web in self.webs.values():
            if (status := web.stop()) != 0:
                raise Failure(f"{web.child.name} ended with {status}: {web.child.last_words()}")
        for daemon in self.daemons.values():
            if (status := daemon.stop()) != 0:
                raise Failure(f"{daemon.child.name} ended with {status}: {daemon.child.last_words()}")
            for left in (daemon.shared_memory_file, pathlib.Path(daemon.unix.removeprefix("unix:")),
                         *daemon.recordings.glob("*.mkv"), *daemon.recordings.glob("small/*")):
                if left.exists():
                    raise Failure(f"{daemon.child.name} has left {left}")

    def check_logs(self):
        for daemon in self.daemons.values():
            for line in daemon.log_lines():
                error = ERROR_LINE.match(line)
                if error and not any(re.search(expected, error.group(1)) for expected in EXPECTED_ERRORS):
                    raise Failure(f"{daemon.child.name} says: {line}")

    def clean_up(self):
        """Also after a failure."""
        for _, visitor in self.visitors:
            visitor.vanish()
        for program in (*self.webs.values(), *self.daemons.values()):
            program.child.kill()
        for daemon in self.daemons.values():
            daemon.shared_memory_file.unlink(missing_ok=True)  # a daemon that was killed has left it
        for name, mounted in self.small_disks.items():
            if mounted:
                subprocess.run(["umount", str(self.folder / name / "recordings" / "small")], check=False)

    def keep_logs(self, where):
        """Copies what tells why it failed."""
        where.mkdir(parents=True, exist_ok=True)
        for path in (*self.folder.glob("*-log"), *self.folder.glob("*/*log"), *self.folder.glob("*/*.toml")):
            shutil.copy(path, where / str(path.relative_to(self.folder)).replace("/", "-"))

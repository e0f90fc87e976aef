# SPDX-License-Identifier: Apache-2.0
"""Decides, over a socket, how many frames may be on their way to a program, and which are still fresh when they come.

It is plain arithmetic, the same as clients/cpp/frame_flow.h and daemon_clock.h: the caller brings the times, in ns.
"""
from __future__ import annotations

import collections
import math
import typing

_MILLISECOND = 1_000_000

# More the daemon does not keep.
_MOST_AHEAD = 16
# A program that waits looks at the socket at least this often, with some time for a machine that is busy.
_WATCHED = 100 * _MILLISECOND
# A frame may have lain for so long where the interval is shorter, which a busy machine takes now and then, or is not
# known.
_LEAST_ALLOWED, _UNKNOWN_INTERVAL = 20 * _MILLISECOND, 500 * _MILLISECOND
# A daemon may send any times: longer intervals and ways are none.
_LONGEST = 10**9 * _MILLISECOND
# An interval that is this many times the one before is a gap of the source, and changes the estimate by no more.
_MOST_GROWTH = 2
# Two clocks drift apart by less than one part in so many: an old answer bounds less.
_DRIFT = 5000
# So many answers about the clock are kept.
_ANSWERS = 16


class DaemonClock:
    """Bounds how far the daemon's CLOCK_MONOTONIC is ahead of this program's, from questions that the daemon has answered
    with its clock."""

    def __init__(self) -> None:
        # When an answer came, and by how much the daemon's clock is ahead: at least, at most.
        self._answers: collections.deque[tuple[int, int, int]] = collections.deque(maxlen=_ANSWERS)

    def add(self, before: int, daemon: int, after: int) -> None:
        """The daemon's clock showed `daemon` between two instants of this program's clock."""
        self._answers.append((after, daemon - after, daemon - before))

    def latest(self, now: int) -> int:
        """Returns what the daemon's clock shows at most when this program's shows `now`: an age that is counted up to it
        is never too small. Where the bounds allow that both have the same clock, as on one machine, it is that clock."""
        least = max(low - max(now - at, 0) // _DRIFT for at, low, _ in self._answers)
        most = min(high + max(now - at, 0) // _DRIFT for at, _, high in self._answers)
        return now if least <= 0 <= most else now + most

    def round_trip(self) -> int:
        """Returns the shortest time that an answer took, there and back."""
        return min(high - low for _, low, high in self._answers)


class Arrival(typing.NamedTuple):
    """Describes a frame that has come. captured, sent: by the daemon's clock. now: that clock now, at most. unwatched:
    since the socket was seen empty; the frame has lain there no longer. round_trip: the shortest one known."""

    publish_index: int
    captured: int
    sent: int
    now: int
    unwatched: int
    round_trip: int


class FrameFlow:
    """Is of one subscription at one connection, which begins with nothing on its way.

    A program that keeps up has a frame on order when the daemon publishes it, so that it is sent at once: it orders as it
    begins to wait, with as many more as its work and the way to the daemon and back need. One that works longer than an
    interval has none on order while it works, and gets the daemon's newest when it reads.
    """

    def __init__(self, max_rate: float = 0.0) -> None:
        self._least_interval = int(min(1e9 / max_rate, 1.0 * _LONGEST)) if max_rate > 0 else 0
        self._published = 0  # between two frames that the daemon publishes; 0 = not known
        self._last: tuple[int, int] | None = None  # index and capture of the last frame
        self._way: int | None = None  # from the daemon to here, that of fast frames
        self._round_trip = 0
        self._given: int | None = None  # when the program got the frame that it works on
        self._work = 0  # how long it worked on the last one
        self._waited = False  # the program, since it began to read
        self._on_the_way = 0  # frames asked for that have not come
        self._suspects = 0  # of them, those that were asked for before one that was not fresh
        self._refused = False  # the last frame was not fresh

    def reads(self, now: int) -> None:
        """The program has begun to read."""
        self._waited = False
        if self._given is not None:
            self._work, self._given = now - self._given, None

    def given(self, now: int) -> None:
        """The program has been given a frame, and works on it from now on."""
        self._given = now

    def interval(self) -> int:
        """Returns the time from one frame to the next as the program gets them; 0 = not known yet."""
        return max(self._published, self._least_interval)

    def patience(self) -> int:
        """Returns how long a frame that is asked for now may take to come, if the daemon has one."""
        return min(max(3 * max(self._way or 0, self._round_trip), 5 * _MILLISECOND), 200 * _MILLISECOND)

    def ask(self, waiting: bool) -> int:
        """Returns how many frames the daemon may send more, and counts them as asked for. waiting: the program waits for
        one now."""
        self._waited = self._waited or waiting
        more = max(0, self._wanted(waiting) - self._on_the_way)
        self._on_the_way += more
        return more

    def arrived(self, frame: Arrival) -> None:
        """Counts a frame that has come."""
        self._on_the_way = max(0, self._on_the_way - 1)
        self._round_trip = frame.round_trip
        if self._last is not None:
            frames, time = frame.publish_index - self._last[0], frame.captured - self._last[1]
            if frames > 0 and time > 0:
                interval, before = min(time // frames, _LONGEST), self._published
                changed = before + int((min(interval, _MOST_GROWTH * before) - before) / 4)
                self._published = interval if before == 0 else changed
        self._last = frame.publish_index, frame.captured

    def fresh(self, frame: Arrival) -> bool:
        """Returns whether that frame may be given: it has lain no longer than an interval, or it was asked for since the
        last one that was not fresh and has come while the program waited."""
        way = min(max(0, frame.now - frame.sent), _LONGEST)
        suspect = self._suspects > 0
        self._suspects -= int(suspect)
        allowed = max(self.interval(), _LEAST_ALLOWED) if self.interval() else _UNKNOWN_INTERVAL
        if self._way is not None and way - self._way <= allowed:
            # The measure falls at once and rises slowly: a frame that waited is not its measure.
            self._way = way if way < self._way else self._way + (way - self._way) // 16
            self._refused = False
            return True
        if (self._way is None or self._refused) and not suspect and frame.unwatched <= _WATCHED:
            self._way = way  # the first frame, or the link has become slower
            self._refused = False
            return True
        self._refused = True
        self._suspects = self._on_the_way
        return False

    def _wanted(self, waiting: bool) -> int:
        """Returns how many frames may be on order. The program orders when it begins to wait, as many as come before it
        waits again: an order that was sent while a frame is given would make that frame late. Where the link itself is
        what limits the rate, more frames would only wait on it for each other."""
        interval = self.interval()
        if interval == 0 or self._way is None:
            return 1
        if self._work > interval:
            return int(waiting)
        transfer = max(0.0, self._way - self._round_trip / 2)
        if transfer >= 0.9 * interval:
            needed = 1 + math.floor(self._round_trip / transfer)
        else:
            until_next_wait = self._work if self._waited else interval
            needed = math.ceil((transfer + self._round_trip + until_next_wait) / interval + 0.25) - int(not waiting)
        return min(max(0, needed), _MOST_AHEAD)

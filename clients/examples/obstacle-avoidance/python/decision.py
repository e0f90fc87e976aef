# SPDX-License-Identifier: Apache-2.0
"""Decides how fast a robot may drive straight ahead, from obstacle scans and from what is missing.

Reads no clock and does no I/O: the caller says what came and when. cpp/decision.hpp is the same in C++, with more
comments. Lengths are metres, times seconds, angles degrees, speeds m/s. Distances count from the origin
of the scan, which is in the middle of the robot's width.
"""
import dataclasses
import math

DRIVE, SLOW, BRAKE = "DRIVE", "SLOW", "BRAKE"

# As the package disparity has them; this file needs nothing of it.
_OCCUPIED = 2
_DISCONTINUITY = 8
_SYNTHETIC = 16

_DOUBTS = {0x100: "dark", 0x200: "saturated", 0x400: "blurred", 0x800: "dirty-eye", 0x1000: "covered-eye",
           0x2000: "misaligned", 0x4000: "too-near", 0x8000: "noisy"}
_TRUST_SHIFT = 24

# Edges of sectors have steps of 0.01 degrees: those that are nearer than this are the same.
_EDGE_STEP_DEG = 0.005

# Below this speed the robot stands still.
LEAST_SPEED_MPS = 0.05

# Trust in a frame, 1 .. 255: below the first the robot brakes, from the second on it may drive at full speed. Of a
# sector: below the first it is unknown, from the second on all counts that it says, from the third on with a doubt.
LEAST_TRUST, FULL_TRUST, FULL_TRUST_IN_DOUBT = 30, 150, 255

# The floor contradicts a mounting that is off by more: the daemon's own limits.
OTHER_HEIGHT_M, OTHER_HEIGHT_SHARE, OTHER_PITCH_DEG = 0.08, 0.15, 6


@dataclasses.dataclass
class Options:
    """Describes the robot, and how careful it is."""

    width_m: float = 0.5  # of the corridor: the robot's width with some room on both sides
    margin_m: float = 0.5  # the robot stands still this far before an obstacle
    smallest_m: float = 0.1  # width of the smallest obstacle that may hide where nothing is known
    speed_mps: float = 1.0  # on a free way
    deceleration_mps2: float = 1.0  # of a full brake
    reaction_s: float = 0.2  # from a decision until the brakes work
    max_age_s: float = 0.25  # an older frame is danger
    good_frames: int = 3  # so many in a row end a brake
    camera_height_m: float = 0.0  # above the floor, as [scan] has it; 0: any
    camera_pitch_deg: float = 0.0  # the same, where the height is told; positive looks down
    synthetic: bool = False  # frames that no camera saw count, too: for tests


@dataclasses.dataclass(frozen=True)
class Decision:
    state: str = BRAKE
    speed_mps: float = 0.0  # the robot may drive this fast now
    cause: str = "start"  # why the robot brakes: start, daemon, age, frame, gap, trust, mounting, view or stop
    reason: str = "no frame yet"
    ahead_m: float = math.nan  # the way is free so far; NaN: not known

    def line(self):
        """Returns the line that people read."""
        speed = "" if self.state == BRAKE else f"{self.speed_mps:.2f} m/s, "
        return f"{self.state} {speed}{self.reason}"


def is_change(before, now):
    """Returns whether `now` is worth a line after `before`."""
    return now.state != before.state or (now.state == BRAKE and now.cause != before.cause)


def _at_bearing(bearing_deg):
    return f", bearing {math.floor(bearing_deg + 0.5)} deg"


def _is_near(sector):
    """Tells whether a sector shows what is nearer than can be measured."""
    return sector[2] == _OCCUPIED and sector[5] == 0


def _trust_text(what, trust, doubts):
    names = " ".join(name for bit, name in _DOUBTS.items() if doubts & bit)
    return f"{what} is {trust} of 255" + (f": {names}" if names else "")


def _what_limits(state, distance_m, free_m, pixels, obstacle, short):
    """obstacle: the sector shows one that is in the corridor. short: (trust, doubts) of a sector that loses by them."""
    if _is_near((0, 0, state, distance_m, free_m, pixels)):
        return f"obstacle at most {distance_m:.2f} m away"
    if short:
        return _trust_text("trust in the way", *short)
    return f"obstacle at {distance_m:.2f} m" if obstacle and free_m >= distance_m else f"unknown beyond {free_m:.2f} m"


def limit_of(from_deg, to_deg, state, distance_m, free_m, pixels, options, short=None):
    """Returns (metres ahead, reason): how far the corridor is free in a sector; None where it does not limit it.

    At the bearing b a ray leaves the corridor at the distance width / 2 / sin |b|. What is farther away does not
    matter. A sector whose part of the corridor lies within the margin counts only where it shows an obstacle: a camera
    sees little so near to its side.
    """
    half = options.width_m / 2
    start, end = math.radians(max(from_deg, -90.0)), math.radians(min(to_deg, 90.0))
    if start >= end:
        return None  # behind
    ahead = start <= 0 <= end
    inner, outer = sorted((abs(start), abs(end)))
    reach = math.inf if ahead else half / math.sin(inner)
    if free_m >= reach:
        return None
    obstacle = state == _OCCUPIED and distance_m < reach
    leaves_at = math.inf if ahead else half / math.tan(inner)
    if not obstacle and leaves_at <= options.margin_m:
        return None
    widest = math.asin(half / free_m) if free_m > half else math.pi / 2
    what = _what_limits(state, distance_m, free_m, pixels, obstacle, short)
    return free_m * math.cos(min(outer, widest)), what + _at_bearing((from_deg + to_deg) / 2)


def _trusted(sector, trust, doubts, options, slow):
    """Returns (sector, (trust, doubts) or None): its free_m as far as it is believed, and why that is less.

    The rule for sectors in doubt: with less than LEAST_TRUST a sector is unknown, so that the robot stops before it as
    before all that is unknown. With more, only a share of the room beyond the margin counts (slow): the robot becomes
    slower, and never stands for that alone.
    """
    share = 1.0
    if 0 < trust < LEAST_TRUST:
        share = 0.0
    elif trust > 0 and slow:
        share = min(1.0, trust / (FULL_TRUST_IN_DOUBT if doubts else FULL_TRUST))
    if share == 1.0:
        return sector, None
    free_m = sector[4]
    believed_m = min(free_m, options.margin_m + share * (free_m - options.margin_m)) if share > 0 else 0.0
    return (*sector[:4], believed_m, sector[5]), (trust, doubts)


def _hidden_from(sectors, number, options):
    """Returns how far nothing hides in a sector, which is farther than its free_m where its neighbours know more.

    Beside each thing is a strip that one eye does not see, too narrow for an obstacle nearby. Unknown sectors in a row
    hide an obstacle from the distance on at which it is as wide as they are together. What lies beyond the scan's
    sectors is unknown, and beside what is too near to be measured nothing is narrow.
    """
    _, _, state, distance_m, own_free_m, _ = sectors[number]
    most = distance_m if state == _OCCUPIED else math.inf
    if _is_near(sectors[number]) or options.smallest_m <= 0:
        return own_free_m
    free, first, last = own_free_m, number, number
    while free < most:
        if first == 0 or last + 1 == len(sectors):
            return free
        right, left = sectors[first - 1], sectors[last + 1]
        if (right[1] < sectors[first][0] - _EDGE_STEP_DEG or left[0] > sectors[last][1] + _EDGE_STEP_DEG
                or _is_near(left) or _is_near(right)):
            return free
        wide = (sectors[last][1] - sectors[first][0]) * math.pi / 180
        nearer = min(right[4], left[4])
        if options.smallest_m <= wide * max(free, nearer):
            return min(most, max(free, options.smallest_m / wide))
        free = max(free, nearer)
        first -= right[4] <= free
        last += left[4] <= free
    return min(free, max(own_free_m, most))


def uncovered(scan, options):
    """Returns the first bearing of the corridor that no sector covers, from the margin on; None when all are."""
    end = math.atan2(options.width_m / 2, options.margin_m) * 180 / math.pi
    covered = -end
    for start, to in zip(scan.from_deg, scan.to_deg):
        if start <= covered + _EDGE_STEP_DEG and to > covered:
            covered = float(to)
    return covered if covered < end else None


def way_ahead(scan, options, slow=False):
    """Returns (metres ahead, reason): what limits the corridor. Sectors that are not there limit it at 0. slow: only
    the part of the way that they are trusted for."""
    bearing = uncovered(scan, options)
    if bearing is not None:
        return 0.0, "no sector" + _at_bearing(bearing)
    nearest = (math.inf, "")
    told = zip(scan.from_deg, scan.to_deg, scan.state, scan.distance_m, scan.free_m, scan.pixels)
    sectors, short = zip(*(_trusted(tuple(map(float, sector)), int(trust), int(doubts), options, slow)
                           for sector, trust, doubts in zip(told, scan.trust, scan.doubts)))
    for number, (start, to, state, distance_m, _, pixels) in enumerate(sectors):
        limit = limit_of(start, to, state, distance_m, _hidden_from(sectors, number, options), pixels, options,
                         short[number])
        if limit is not None and limit[0] < nearest[0]:
            nearest = limit
    return nearest


def trust_limit(flags, options):
    """Returns (m/s, reason): how fast trust in a frame lets the robot drive, and why no faster. A daemon that tells no
    trust limits nothing."""
    trust = flags >> _TRUST_SHIFT
    if trust == 0 or trust >= FULL_TRUST:
        return math.inf, ""
    reason = _trust_text("trust in the frame", trust, flags)
    return 0.0 if trust < LEAST_TRUST else options.speed_mps * trust / FULL_TRUST, reason


def way_trust_limit(scan, options):
    """Returns (m/s, reason) of the sectors in the way: the speed for that part of the way which they are trusted for."""
    ahead_m, reason = way_ahead(scan, options, slow=True)
    return max(LEAST_SPEED_MPS, speed_for(ahead_m - options.margin_m, options)), reason


def contradiction(scan, options):
    """Returns what the floor that the camera sees says against the mounting that is told; None where it agrees, or was
    not found. A scan of a wrong mounting has wrong distances."""
    seen = scan.mounting
    if seen is None or options.camera_height_m <= 0:
        return None
    height_off = abs(seen.height_m - options.camera_height_m)
    if (height_off <= max(OTHER_HEIGHT_M, OTHER_HEIGHT_SHARE * options.camera_height_m)
            and abs(seen.pitch_deg - options.camera_pitch_deg) <= OTHER_PITCH_DEG):
        return None
    return (f"the floor shows a camera {seen.height_m:.2f} m above it, pitch {seen.pitch_deg:.1f} deg; "
            f"told are {options.camera_height_m:.2f} m, {options.camera_pitch_deg:.1f} deg")


def delay_s(options):
    """Returns the time that passes before the brakes work: what a frame shows may be as old as the limit."""
    return options.reaction_s + options.max_age_s


def stopping_distance(speed_mps, options):
    """Returns the way that the robot needs to stop."""
    return speed_mps * delay_s(options) + speed_mps * speed_mps / (2 * options.deceleration_mps2)


def speed_for(room_m, options):
    """Returns the speed from which the robot stops within room_m with half of its deceleration, at most that on a free
    way. The other half is what a full brake has left for what appears suddenly."""
    deceleration, delay = options.deceleration_mps2 / 2, delay_s(options)
    speed = deceleration * (math.sqrt(delay * delay + 2 * max(0.0, room_m) / deceleration) - delay)
    return min(speed, options.speed_mps)


class Decider:
    """Three states: drive, slow, brake. One bad event brakes; several good frames in a row end a brake. now_s is of a
    steady clock."""

    def __init__(self, options):
        self.decision = Decision()
        self._options = options
        self._has_frame = False
        self._age_s = 0.0  # of the newest frame when it was read
        self._arrived_s = 0.0  # when that was
        self._good = 0  # good frames in a row since the brake began

    def patience_s(self, now_s):
        """Returns how long the caller may wait for the next frame before it calls wait()."""
        if self.decision.state == BRAKE:
            return self._options.max_age_s
        return max(0.0, self._options.max_age_s - self._newest_age_s(now_s))

    def see(self, age_s, flags, scan, now_s):
        """A frame has been read. age_s: its age then. scan: a disparity.Scan, or None where the frame has none."""
        if self._has_frame:
            self.wait(now_s)  # the frame before may have become too old while nobody asked
        self._has_frame, self._age_s, self._arrived_s = True, age_s, now_s
        if not age_s >= 0:
            return self._brake("frame", "frame has a negative age")
        if age_s > self._options.max_age_s:
            return self._too_old(now_s)
        if flags & _SYNTHETIC and not self._options.synthetic:
            return self._brake("frame", "frame is synthetic: no camera saw it; --synthetic accepts it")
        if scan is None:
            return self._brake("frame", "no scan: set enabled = true in [scan] of the daemon's configuration")
        if flags & _DISCONTINUITY:
            return self._brake("gap", "gap in the frames: the source was interrupted")
        wrong = contradiction(scan, self._options)
        if wrong is not None:
            return self._brake("mounting", wrong)
        trust_mps, trust_reason = trust_limit(flags, self._options)
        if trust_mps < LEAST_SPEED_MPS:
            return self._brake("trust", trust_reason)
        trust = min((trust_mps, trust_reason), way_trust_limit(scan, self._options), key=lambda limit: limit[0])
        return self._judge(*way_ahead(scan, self._options), *trust)

    def wait(self, now_s):
        """No frame has arrived for a while."""
        if self._has_frame and self._newest_age_s(now_s) > self._options.max_age_s:
            return self._too_old(now_s)
        return self.decision

    def gone(self, why):
        """There is no daemon."""
        return self._brake("daemon", f"no daemon: {why}")

    def fail(self, why):
        """The daemon refuses, or sends what cannot be read."""
        return self._brake("frame", f"no scan: {why}")

    def stop(self):
        """The program ends."""
        return self._brake("stop", "stopped by a signal")

    def _newest_age_s(self, now_s):
        return self._age_s + (now_s - self._arrived_s)

    def _too_old(self, now_s):
        return self._brake("age", f"frame is {self._newest_age_s(now_s) * 1000:.0f} ms old")

    def _brake(self, cause, reason, ahead_m=math.nan):
        self._good = 0
        self.decision = Decision(cause=cause, reason=reason, ahead_m=ahead_m)
        return self.decision

    def _judge(self, ahead_m, reason, trust_mps, trust_reason):
        """Judges a frame that can be trusted so far. Brakes when the robot cannot stop before the limit at the speed
        that it was allowed."""
        options = self._options
        room = ahead_m - options.margin_m
        speed_of_way = speed_for(room, options)
        speed = min(speed_of_way, trust_mps)
        if speed < LEAST_SPEED_MPS or room < stopping_distance(self.decision.speed_mps, options):
            return self._brake("view", reason, ahead_m)
        if self.decision.state == BRAKE:
            self._good += 1
            if self._good < options.good_frames:
                self.decision = dataclasses.replace(self.decision, ahead_m=ahead_m)
                return self.decision
        if speed >= options.speed_mps:
            self.decision = Decision(DRIVE, speed, "", f"free up to {ahead_m:.1f} m", ahead_m)
        else:
            self.decision = Decision(SLOW, speed, "", trust_reason if speed < speed_of_way else reason, ahead_m)
        return self.decision

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Says how fast a robot may drive straight ahead, and brakes when it does not know. See docs/howto/avoid-obstacles.md.

Reads obstacle scans of disparityd: of the daemon NAME ("default") of this machine, or from a socket, tcp:HOST:PORT,
tls:HOST:PORT or unix:PATH. Prints a line for each change of state.
"""
import argparse
import json
import math
import re
import signal
import sys
import time

import disparity

import decision

PROGRAM = "avoid.py"
# A read takes no longer, so that a signal is obeyed soon.
LONGEST_READ_S = 0.2
# The robot brakes while the program connects: to wait for it does no harm.
CONNECT_TIMEOUT_S = 1.0


class Stopped(BaseException):
    """SIGINT or SIGTERM has come. No "except Exception" of another module takes it."""


def stop(*_):
    # The second one must not interrupt what the first one has begun.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    raise Stopped


class Parser(argparse.ArgumentParser):
    def error(self, message):
        self.exit(2, f"{PROGRAM}: error: {message}\n")


def number(least, most, kind=float):
    """Returns a type for argparse: a number from least to most."""

    def convert(text):
        try:
            value = kind(text)
        except ValueError:
            value = math.nan
        if not least <= value <= most:
            whole = "whole numbers " if kind is int else ""
            raise argparse.ArgumentTypeError(f'found "{text}", allowed: {whole}{least:g} .. {most:g}')
        return value

    return convert


def check_source(text):
    """Raises ArgumentTypeError for a source that cannot be right."""
    if text.startswith(("tcp:", "tls:", "unix:")):
        host, _, port = text[4:].rpartition(":")
        if text == "unix:" or text.startswith(("tcp:", "tls:")) and not (
            host and port.isascii() and port.isdigit() and 1 <= int(port) <= 65535
        ):
            raise argparse.ArgumentTypeError(f'"{text}": expected tcp:HOST:PORT, tls:HOST:PORT or unix:PATH')
    elif not re.fullmatch(r"[A-Za-z0-9._-]{1,64}", text):
        raise argparse.ArgumentTypeError(
            f'shared memory name "{text}": 1 to 64 characters are allowed, of A-Z a-z 0-9 . _ -'
        )
    return text


def parse_arguments():
    parser = Parser(prog=PROGRAM, description=__doc__, allow_abbrev=False,
                    formatter_class=argparse.RawDescriptionHelpFormatter)
    usual = decision.Options()
    for name, default, kind, text in (
        ("--width-m", usual.width_m, number(0.01, 10), "width of the corridor"),
        ("--margin-m", usual.margin_m, number(0.05, 10),
         "the robot stands still this far before an obstacle, counted from the scan's origin"),
        ("--smallest-m", usual.smallest_m, number(0, 1),
         "width of the smallest obstacle that may hide where nothing is known"),
        ("--speed-mps", usual.speed_mps, number(0.05, 20), "speed on a free way"),
        ("--deceleration-mps2", usual.deceleration_mps2, number(0.05, 20), "of a full brake"),
        ("--reaction-s", usual.reaction_s, number(0, 10), "from a decision until the brakes work"),
        ("--max-age-ms", usual.max_age_s * 1000, number(10, 10000), "brake when the newest frame is older"),
        ("--good-frames", usual.good_frames, number(1, 1000, int), "so many in a row end a brake"),
        ("--camera-height-m", usual.camera_height_m, number(0, 100),
         "brake where the floor shows another height of the camera; 0: any"),
        ("--camera-pitch-deg", usual.camera_pitch_deg, number(-45, 45), "the same of its pitch, where the height is told"),
    ):
        parser.add_argument(name, default=default, type=kind, metavar="N", help=f"{text} ({default:g})")
    parser.add_argument("--synthetic", action="store_true", help="accept frames that no camera saw: for tests")
    parser.add_argument("--json", action="store_true",
                        help="print a line of JSON for each frame, and whenever none came")
    parser.add_argument("source", nargs="?", default="default", type=check_source)
    return parser.parse_args()


class Output:
    """Prints decisions. This is the place where a robot's program commands its motors."""

    def __init__(self, as_json):
        self._json = as_json
        self._last = None

    def show(self, now, sequence=None):
        """Prints a line for a change, or for each decision in JSON. sequence: the frame's; None: no frame came."""
        if self._json:
            print(json.dumps({
                "state": now.state,
                "speed_mps": round(now.speed_mps, 3),
                "ahead_m": round(now.ahead_m, 3) if math.isfinite(now.ahead_m) else None,
                "sequence": sequence,
                "reason": now.reason,
            }), flush=True)
        elif self._last is None or decision.is_change(self._last, now):
            print(now.line(), flush=True)
        self._last = now


def judge(decider, frame):
    """Judges a frame that has just been read. Its age is what it is now, whatever it took on the way."""
    read_s = time.monotonic()
    try:
        scan = frame.scan if disparity.SCAN in frame.planes else None
    except disparity.DisparityError as error:
        decider.fail(str(error))
    else:
        decider.see(frame.age_ns / 1e9, frame.flags, scan, read_s)


def step(daemon, decider):
    """Waits for what comes next. Returns the sequence of the frame that came, or None where none did."""
    try:
        frame = daemon.read(min(decider.patience_s(time.monotonic()), LONGEST_READ_S))
    except disparity.Gone as error:
        decider.gone(error)
    except (disparity.DisparityError, ValueError) as error:
        decider.fail(str(error))
    else:
        if frame is not None:
            judge(decider, frame)
            return frame.sequence
        decider.wait(time.monotonic())
    return None


def run(daemon, decider, output):
    while True:
        sequence = step(daemon, decider)
        output.show(decider.decision, sequence)


def main():
    arguments = parse_arguments()
    options = decision.Options(
        arguments.width_m, arguments.margin_m, arguments.smallest_m, arguments.speed_mps, arguments.deceleration_mps2, arguments.reaction_s,
        arguments.max_age_ms / 1000, arguments.good_frames, arguments.camera_height_m, arguments.camera_pitch_deg,
        arguments.synthetic,
    )
    decider, output = decision.Decider(options), Output(arguments.json)
    try:
        signal.signal(signal.SIGINT, stop)
        signal.signal(signal.SIGTERM, stop)
        output.show(decider.decision)  # brakes until frames say something else
        with disparity.connect(arguments.source, [disparity.SCAN], may_be_absent=True, client_name=PROGRAM,
                               timeout=CONNECT_TIMEOUT_S) as daemon:
            run(daemon, decider, output)
    except Stopped:
        output.show(decider.stop())


if __name__ == "__main__":
    try:
        main()
    except (disparity.DisparityError, OSError, ValueError) as error:
        sys.exit(f"{PROGRAM}: error: {error}")

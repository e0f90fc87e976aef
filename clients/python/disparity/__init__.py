# SPDX-License-Identifier: Apache-2.0
"""Client of disparityd: depth frames over a socket or shared memory, as numpy arrays.

    import disparity

    with disparity.connect("default", [disparity.LEFT, disparity.DISPARITY]) as daemon:
        for frame in daemon:  # goes on when the daemon has been started again
            print(frame.sequence, frame.age_ns / 1e6, "ms", frame.left.shape, frame.points()[0, 0])

Where the package disparity_matcher is installed, too, its names are here as well: match, Matcher, open and what belongs to them
match images without a daemon.
"""
import sys
import typing

from .client import Client, connect
from .connection import ConnectOptions
from .disparity_pb2 import (CONFIDENCE, DEPTH, DEPTH_ERROR, DISPARITY, LEFT, LEFT_COLOUR, RAW_LEFT, RAW_RIGHT, RIGHT, RIGHT_COLOUR,
                            SCAN)
from .errors import DisparityError, Gone, Refused
from .frame import (BLURRED, COVERED_EYE, DARK, DIRTY_EYE, DISCONTINUITY, DROPPED_BEFORE, EXPOSURE_CENTRE, INTERPOLATED,
                    MISALIGNED, NOISY, SATURATED, SYNTHETIC, TOO_NEAR, UNRECTIFIED, Frame, doubt_names)
from .inertial import InertialCalibration, inertial_calibration
from .scan import (FREE, GROUND_AUTOPILOT, GROUND_CONFIGURED, GROUND_FITTED, GROUND_GRAVITY, GROUND_HELD, MASKED, OCCUPIED,
                   UNKNOWN, Scan)
from .shared_memory import SharedMemoryReader
from .socket_client import SocketClient

if typing.TYPE_CHECKING:
    from disparity_matcher import (Calibration, Match, Matcher, Rectifier, Source, SourceFrame, StereoSGM, StereoSGM_create,
                                   load_calibration, match, open)

# Not in __all__: the client does not need the matcher, which is looked for when one of its names is asked for.
_OF_THE_MATCHER = frozenset({"Calibration", "Match", "Matcher", "Rectifier", "Source", "SourceFrame", "StereoSGM", "StereoSGM_create",
                             "load_calibration", "match", "open"})

__all__ = [
    "BLURRED",
    "CONFIDENCE",
    "COVERED_EYE",
    "Client",
    "ConnectOptions",
    "DARK",
    "DEPTH",
    "DEPTH_ERROR",
    "DIRTY_EYE",
    "DISCONTINUITY",
    "DISPARITY",
    "DROPPED_BEFORE",
    "DisparityError",
    "EXPOSURE_CENTRE",
    "FREE",
    "Frame",
    "GROUND_AUTOPILOT",
    "GROUND_CONFIGURED",
    "GROUND_FITTED",
    "GROUND_GRAVITY",
    "GROUND_HELD",
    "Gone",
    "INTERPOLATED",
    "InertialCalibration",
    "LEFT",
    "LEFT_COLOUR",
    "MASKED",
    "MISALIGNED",
    "NOISY",
    "OCCUPIED",
    "RAW_LEFT",
    "RAW_RIGHT",
    "RIGHT",
    "RIGHT_COLOUR",
    "Refused",
    "SATURATED",
    "SCAN",
    "Scan",
    "SharedMemoryReader",
    "SocketClient",
    "SYNTHETIC",
    "TOO_NEAR",
    "UNKNOWN",
    "UNRECTIFIED",
    "connect",
    "doubt_names",
    "inertial_calibration",
]


def __getattr__(name: str) -> typing.Any:
    if name not in _OF_THE_MATCHER:
        raise AttributeError(f"module 'disparity' has no attribute '{name}'")
    try:
        import disparity_matcher
    except ModuleNotFoundError as error:
        if error.name != "disparity_matcher":
            raise
        # What hasattr() takes; "from disparity import ..." would put a line of its own in the place of that.
        kind = ImportError if sys._getframe(1).f_code.co_name == "_handle_fromlist" else AttributeError
        raise kind(f"disparity.{name} is part of the matcher, which is not installed: install the package "
                   "python3-disparity-matcher, as docs/python.md says") from None
    return getattr(disparity_matcher, name)

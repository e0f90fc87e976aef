# SPDX-License-Identifier: Apache-2.0
"""Client of disparityd: depth frames over a socket or shared memory, as numpy arrays.

    import disparity

    with disparity.SocketClient("tcp:127.0.0.1:9876") as client:
        client.subscribe([disparity.DISPARITY, disparity.DEPTH])
        for frame in client:  # goes on when the daemon has been started again
            print(frame.sequence, frame.age_ns / 1e6, "ms", frame.depth.shape)

    with disparity.SharedMemoryReader("default") as reader:
        frame = reader.read(timeout=1.0)
"""
from .connection import ConnectOptions
from .disparity_pb2 import CONFIDENCE, DEPTH, DEPTH_ERROR, DISPARITY, LEFT, LEFT_COLOUR, RIGHT, SCAN
from .errors import DisparityError, Gone, Refused
from .frame import DISCONTINUITY, DROPPED_BEFORE, INTERPOLATED, SYNTHETIC, UNRECTIFIED, Frame
from .scan import FREE, GROUND_CONFIGURED, GROUND_FITTED, GROUND_GRAVITY, GROUND_HELD, OCCUPIED, UNKNOWN, Scan
from .shared_memory import SharedMemoryReader
from .socket_client import SocketClient

__all__ = [
    "CONFIDENCE",
    "ConnectOptions",
    "DEPTH",
    "DEPTH_ERROR",
    "DISCONTINUITY",
    "DISPARITY",
    "DROPPED_BEFORE",
    "DisparityError",
    "FREE",
    "Frame",
    "GROUND_CONFIGURED",
    "GROUND_FITTED",
    "GROUND_GRAVITY",
    "GROUND_HELD",
    "Gone",
    "INTERPOLATED",
    "LEFT",
    "LEFT_COLOUR",
    "OCCUPIED",
    "RIGHT",
    "Refused",
    "SCAN",
    "Scan",
    "SharedMemoryReader",
    "SocketClient",
    "SYNTHETIC",
    "UNKNOWN",
    "UNRECTIFIED",
]

# SPDX-License-Identifier: Apache-2.0
"""Reads one frame over shared memory and one over a socket, and says how large the depth is: read_frame.py NAME ADDRESS"""
import importlib.metadata
import sys

import disparity

assert importlib.metadata.version("disparity")  # as pip sees it

with disparity.SharedMemoryReader(sys.argv[1], may_be_absent=True) as reader:
    frame = next(iter(reader))
with disparity.SocketClient(sys.argv[2], client_name="read_frame.py") as client:
    client.subscribe([disparity.DEPTH])
    assert next(iter(client)).depth.shape == frame.depth.shape
print(f"depth of {frame.depth.shape[1]}x{frame.depth.shape[0]}")

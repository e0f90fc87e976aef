#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints the nearest measured depth of each frame. Goes on when the daemon has been started again.

    nearest.py [tcp:HOST:PORT | tls:HOST:PORT | unix:PATH | shm:NAME]
"""
import sys

import disparity


def open_source(address):
    if address.startswith("shm:"):
        return disparity.SharedMemoryReader(address[4:], may_be_absent=True)
    client = disparity.SocketClient(address, client_name="nearest.py")
    client.subscribe([disparity.DEPTH, disparity.CONFIDENCE])
    return client


def main():
    with open_source(sys.argv[1] if len(sys.argv) > 1 else "tcp:127.0.0.1:9876") as source:
        for frame in source:  # waits while there is no daemon
            # Confidence 0 marks pixels that were rejected or filled in, depth 0 those without a depth.
            measured = frame.depth[(frame.confidence > 0) & (frame.depth > 0)]
            nearest = f"{measured.min()} mm" if measured.size else "unknown"
            print(f"frame {frame.sequence}  {frame.age_ns / 1e6:.1f} ms old  nearest {nearest}", flush=True)


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        pass
    except (disparity.DisparityError, ValueError, KeyError) as error:
        sys.exit(f"nearest.py: error: {error}")

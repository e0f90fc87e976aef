#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints the nearest measured point of each frame. Waits for the daemon when it is not there.

    nearest.py [NAME | unix:PATH | tcp:HOST:PORT | tls:HOST:PORT]
"""
import sys

import disparity


def main():
    where = sys.argv[1] if len(sys.argv) > 1 else ""
    with disparity.connect(where, [disparity.DISPARITY, disparity.CONFIDENCE], may_be_absent=True) as daemon:
        for frame in daemon:  # waits while there is no daemon
            # Confidence 0 marks pixels that were rejected or filled in.
            points = frame.points()[frame.confidence > 0]
            points = points[points[:, 2] > 0]
            x, _, z = points[points[:, 2].argmin()] if len(points) else [float("nan")] * 3
            print(f"frame {frame.sequence}  {frame.age_ns / 1e6:.1f} ms old  nearest {z:.3f} m, {x:.3f} m to the right",
                  flush=True)


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        pass
    except (disparity.DisparityError, ValueError, KeyError) as error:
        sys.exit(f"nearest.py: error: {error}")

# SPDX-License-Identifier: Apache-2.0
"""soak_reader.py shm:NAME|tcp:HOST:PORT|unix:PATH: reads frames with the Python client until its standard input ends, then one
more, and prints its account. The first frame is announced by the line "frame"."""
import json
import select
import sys
import time

import disparity

TURN_S = 0.2
LONGEST_WAIT_S = 60


class Account:
    def __init__(self):
        self.frames = self.skipped = self.first = self.last = 0
        self.ages_ms = []

    def add(self, frame):
        if self.frames == 0:
            self.first = frame.publish_index
        elif frame.publish_index != self.last + 1 + frame.skipped:
            raise AssertionError(f"frame {frame.publish_index} with {frame.skipped} skipped came after {self.last}")
        else:
            self.skipped += frame.skipped
        self.frames += 1
        self.last = frame.publish_index
        self.ages_ms.append(frame.age_ns / 1e6)
        for product, plane in frame.planes.items():
            if product != disparity.SCAN and plane.shape[:2] != (frame.height, frame.width):
                raise AssertionError(f"frame {frame.publish_index}: product {product} has the shape {plane.shape}")

    def to_json(self):
        ages = sorted(self.ages_ms)
        return json.dumps({"frames": self.frames, "skipped": self.skipped, "first": self.first, "last": self.last,
                           "age_ms": [ages[(len(ages) - 1) * percent // 100] for percent in (50, 99, 100)], "refusals": []})


def opened(address):
    if address.startswith("shm:"):
        return disparity.SharedMemoryReader(address[4:])
    client = disparity.SocketClient(address, "soak python")
    client.subscribe([disparity.DISPARITY, disparity.CONFIDENCE, disparity.LEFT])
    return client


def main():
    account = Account()
    end_by = None
    with opened(sys.argv[1]) as client:
        while end_by is None or time.monotonic() < end_by:
            frame = client.read(timeout=TURN_S)
            if frame is not None:
                account.add(frame)
                if account.frames == 1:
                    print("frame", flush=True)
                if end_by is not None:
                    print(account.to_json(), flush=True)
                    return 0
            if end_by is None and select.select([sys.stdin], [], [], 0)[0]:
                end_by = time.monotonic() + LONGEST_WAIT_S
    sys.exit(f"soak_reader.py: error: no frame for {LONGEST_WAIT_S} s")


if __name__ == "__main__":
    main()

# SPDX-License-Identifier: Apache-2.0
"""Both readers of frames share this behaviour."""
from .errors import Gone


class FrameSource:
    """Adds "with" blocks, which close the source at their end, and "for" loops to a class with read() and close()."""

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def __iter__(self):
        """Yields frames without end and waits while there is no daemon. read() raises Gone instead."""
        while True:
            try:
                frame = self.read()
            except Gone:
                continue
            if frame is not None:
                yield frame

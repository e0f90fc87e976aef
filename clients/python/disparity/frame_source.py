# SPDX-License-Identifier: Apache-2.0
"""What every source of frames can do, however they come."""
from .errors import Gone


class FrameSource:
    """Of something with read() and close(): closed at the end of a "with" block, and frames in a "for" loop."""

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def __iter__(self):
        """Frames until the daemon is gone."""
        while True:
            try:
                frame = self.read()
            except Gone:
                return
            if frame is not None:
                yield frame

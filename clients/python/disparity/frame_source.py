# SPDX-License-Identifier: Apache-2.0
"""Both readers of frames share this behaviour."""
from __future__ import annotations

import abc
import types
import typing

from .errors import Gone
from .frame import Frame

Source = typing.TypeVar("Source", bound="FrameSource")


class FrameSource(abc.ABC):
    """Adds "with" blocks, which close the source at their end, and "for" loops to a class with read() and close()."""

    @abc.abstractmethod
    def read(self, timeout: float | None = None) -> Frame | None:
        """Returns the next frame, or None when none came in time."""

    @abc.abstractmethod
    def close(self) -> None:
        """Frees what the source holds; later reads raise ValueError."""

    def __enter__(self: Source) -> Source:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: types.TracebackType | None
    ) -> None:
        self.close()

    def __iter__(self) -> typing.Iterator[Frame]:
        """Yields frames without end and waits while there is no daemon. read() raises Gone instead."""
        while True:
            try:
                frame = self.read()
            except Gone:
                continue
            if frame is not None:
                yield frame

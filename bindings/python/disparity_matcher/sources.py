# SPDX-License-Identifier: Apache-2.0
"""Frames of any source of disparityd: recordings, folders, patterns, videos, bags, cameras, the rendered scene."""
from __future__ import annotations

import dataclasses
import importlib.util
import logging
import os
import types
import typing

import numpy as np

from .calibration import Calibration, _from_text
from .images import Image

if typing.TYPE_CHECKING:
    import numpy.typing as npt

    from . import _sources

_log = logging.getLogger("disparity")


@dataclasses.dataclass
class Frame:
    """A captured pair, not rectified unless the source's images are. Its arrays belong to the program.

    left, right: uint8; grey (height, width), or BGR (height, width, 3) of image files in colour. Of cameras and
        recordings that send YUYV it is the luma, as disparityd matches it. Both are views of one array, without a copy.
    sequence: counts captured frames; a gap means lost ones. dropped_before: how many are known to be lost since the
        frame before. monotonic_ns, realtime_ns: at capture (as recorded, of a recording); 0 where the source says none.
    corrupt: the driver marked it as damaged. discontinuity: the first one after a gap, a restart or a loop.
    name: of the left image's file; empty where frames have none.
    calibration: the source's, with the correction by self-calibration that a recording holds for this frame, which is
        what disparityctl process rectifies with; None where unknown.
    """

    left: Image
    right: Image
    sequence: int
    monotonic_ns: int
    realtime_ns: int
    dropped_before: int
    corrupt: bool
    discontinuity: bool
    name: str
    calibration: Calibration | None


def _eyes(pixels: npt.NDArray[np.uint8], pixel_format: str) -> tuple[Image, Image]:
    """Returns both halves of a picture with the eyes side by side."""
    half = pixels.shape[1] // 2
    eyes = pixels[:, :half], pixels[:, half:]
    if pixel_format == "yuyv":
        return eyes[0][:, ::2], eyes[1][:, ::2]
    if pixel_format == "bgr24":
        # Views: a reshape of half a row would copy.
        left, right = (np.lib.stride_tricks.as_strided(eye, (eye.shape[0], half // 3, 3), (eye.strides[0], 3, 1))
                       for eye in eyes)
        return left, right
    return eyes


class Source:
    """Frames in their order: `for frame in source`. A context manager; open() makes one. One thread at a time takes
    frames, others wait; close() ends such a wait."""

    def __init__(self, native: _sources.Source) -> None:
        self._native = native
        text = native.calibration_text
        self._calibration = None if text is None else _from_text(text, native.name)
        self._corrected: tuple[str, Calibration] | None = None
        self._dropped = 0

    @property
    def name(self) -> str:
        """What it was opened with."""
        return self._native.name

    @property
    def description(self) -> str:
        """One line for people."""
        return self._native.description

    @property
    def width(self) -> int:
        """Pixels of one eye."""
        return self._native.width

    @property
    def height(self) -> int:
        """Rows of a frame."""
        return self._native.height

    @property
    def rate(self) -> float:
        """Nominal frames per second; 0 = unknown."""
        return self._native.rate

    @property
    def live(self) -> bool:
        """Whether frames come by the clock and are lost when nobody takes them."""
        return self._native.live

    @property
    def synthetic(self) -> bool:
        """Whether frames are drawn: no camera saw them."""
        return self._native.synthetic

    @property
    def frame_count(self) -> int | None:
        """How many frames there are, where it is known beforehand."""
        return self._native.frame_count

    @property
    def calibration(self) -> Calibration | None:
        """Of the camera; None: unknown, frames can only be matched as they are."""
        return self._calibration

    @property
    def dropped(self) -> int:
        """How many frames are known to be lost among those that came."""
        return self._dropped

    def close(self) -> None:
        """Ends it; frames that came stay. A second call does nothing."""
        self._native.close()

    def __enter__(self) -> Source:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: types.TracebackType | None) -> None:
        self.close()

    def __iter__(self) -> Source:
        return self

    def __next__(self) -> Frame:
        """Waits for the next frame. RuntimeError with one line where the input is damaged, after the frames before it;
        ValueError after close()."""
        try:
            got = self._native.next()
        finally:
            tell(self._native)
        if got is None:
            raise StopIteration
        pixels, pixel_format, sequence, monotonic_ns, realtime_ns, dropped, corrupt, discontinuity, name, corrected = got
        self._dropped += dropped
        left, right = _eyes(pixels, pixel_format)
        return Frame(left, right, sequence, monotonic_ns, realtime_ns, dropped, corrupt, discontinuity, name,
                     self._calibration_of(corrected))

    def _calibration_of(self, corrected: str | None) -> Calibration | None:
        if corrected is None:
            return self._calibration
        if self._corrected is None or self._corrected[0] != corrected:
            self._corrected = corrected, _from_text(corrected, self._native.name)
        return self._corrected[1]


def tell(native: _sources.Source) -> None:
    """Says, in the log "disparity", what the source had to tell people."""
    for line in native.take_notes():
        _log.warning("%s", line)


def open(source: str | os.PathLike[str], *, calibration: str | os.PathLike[str] = "", loop: bool = False,
         real_time: bool = False, skip_damaged: bool = False) -> Source:  # noqa: A001
    """Opens a source by the name that disparityctl and disparityd know it by: a recording, a folder or a pattern of
    images, "left.png,right.png", a video, a bag, an .svo file, "v4l2:hd720@30", "scene:vga" (disparityctl sources lists
    them). For a running daemon there is disparity.connect.

    calibration: a file instead of the source's own. loop: starts again after the last frame. real_time: frames of
    recordings and folders come at their own rate, else as soon as they are asked for. skip_damaged: images that cannot
    be read are left out and counted as dropped, else they end the source with an error.

    What people should know, such as how 16 bits become 8, goes to the log "disparity". ValueError with one line where
    the name, a file or its calibration is not allowed, RuntimeError where the system refuses, and in a wheel, which
    has neither decoders nor cameras.
    """
    if importlib.util.find_spec("._sources", __package__) is None:
        raise RuntimeError(f"source {os.fspath(source)}: a wheel of disparity_matcher reads no sources: give match() arrays of OpenCV, PyAV "
                           "or imageio, or install Debian's package python3-disparity-matcher")
    from . import _sources  # here, as decoders take long to load

    native = _sources.Source(os.fsencode(source), os.fsencode(calibration), not real_time, loop, skip_damaged)
    tell(native)
    return Source(native)

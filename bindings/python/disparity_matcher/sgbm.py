# SPDX-License-Identifier: Apache-2.0
"""The matcher with the calls of OpenCV's StereoSGBM. docs/python.md has the table of what each parameter becomes."""
from __future__ import annotations

import typing
import warnings

import numpy as np

from .images import ImageLike, whole_number
from .matching import Matcher

if typing.TYPE_CHECKING:
    import numpy.typing as npt

# OpenCV's limits of 16 bits.
_MOST = 32767


class StereoSGM:
    """Takes the place of OpenCV's StereoSGBM: StereoSGM_create() makes one. compute() returns what OpenCV's does.

    Parameters are checked when they are set and, where they depend on each other, by compute(); ValueError with one line
    says what is allowed. One thread at a time.
    """

    MODE_SGBM = 0
    MODE_HH = 1
    MODE_SGBM_3WAY = 2
    MODE_HH4 = 3
    DISP_SHIFT = 4
    DISP_SCALE = 16

    def __init__(self, threads: int = 0) -> None:
        self._threads = threads
        self._values = {"minDisparity": 0, "numDisparities": 16, "blockSize": 3, "P1": 0, "P2": 0, "disp12MaxDiff": 0,
                        "preFilterCap": 0, "uniquenessRatio": 0, "speckleWindowSize": 0, "speckleRange": 0,
                        "mode": self.MODE_SGBM}
        self._matcher: Matcher | None = None

    def _set(self, name: str, value: typing.Any, least: int, most: int) -> None:
        self._values[name] = whole_number(name, value, least, most)
        self._matcher = None

    def compute(self, left: ImageLike, right: ImageLike,
                disparity: npt.NDArray[np.int16] | None = None) -> npt.NDArray[np.int16]:
        """Returns the disparities of the left image: int16 of height x width, 1/16 px; (minDisparity - 1) * 16 where
        there is none. Images are uint8, as OpenCV takes them; else as of Matcher.match().

        disparity: an array of this size and type to write into, which is returned. ValueError with one line for another.
        """
        for name, image in (("left", left), ("right", right)):
            if np.asarray(image).dtype != np.uint8:
                raise ValueError(f"{name}: found an array of {np.asarray(image).dtype}, allowed: uint8")
        if self._matcher is None:
            self._matcher = self._made()
        found = self._matcher._found(left, right, None)[0]
        if disparity is None:
            return found
        if not isinstance(disparity, np.ndarray) or disparity.shape != found.shape or disparity.dtype != found.dtype:
            kind = f"an array of {disparity.dtype}, shape {disparity.shape}" if isinstance(disparity, np.ndarray) else type(disparity).__name__
            raise ValueError(f"disparity: found {kind}, allowed: None, or an array of int16, shape {found.shape}")
        disparity[...] = found
        return disparity

    def _made(self) -> Matcher:
        values = self._values
        eight_paths = values["mode"] == self.MODE_HH
        small = values["blockSize"] <= 7
        options: dict[str, typing.Any] = {
            "d_min": values["minDisparity"], "disparities": values["numDisparities"],
            "paths": 8 if eight_paths else 4, "uniqueness": values["uniquenessRatio"],
            "left_right_check": values["disp12MaxDiff"] >= 0, "speckle_step": values["speckleRange"],
            # OpenCV rejects regions of up to so many pixels, the option those of fewer.
            "speckle_size": values["speckleWindowSize"] + 1 if values["speckleWindowSize"] else 0,
            "interpolate": False, "guided_median": 0, "median": 3}
        options.update(self._penalties(small))
        return Matcher(preset="dense", cost="census-7x5+gradient" if small else "census-9x7", threads=self._threads,
                       **options)

    def _penalties(self, small: bool) -> dict[str, int]:
        """Returns p1, p2 and what depends on them: the tuned ones, or with the ratio of OpenCV's."""
        tuned = Matcher(preset="dense" if small else "paper").options
        p1, p2 = tuned["p1"], tuned["p2"]
        given = self._values["P1"], self._values["P2"]
        if given != (0, 0):
            most = 193
            if not 0 < given[0] < given[1] or round(p1 * given[1] / given[0]) > most:
                raise ValueError(f"P1 and P2: found {given[0]} and {given[1]}, allowed: both 0 (tuned values), or P2 more than P1 "
                                 f"and at most {most / p1:.1f} times P1, of which the ratio counts")
            p2 = max(p1 + 1, round(p1 * given[1] / given[0]))
        return {"p1": p1, "p2": p2, "p2_slope": tuned["p2_slope"], "p2_min": min(tuned["p2_min"], p2)}

    def setMinDisparity(self, minDisparity: int) -> None:
        """Sets the smallest candidate, px, -256 to 256."""
        self._set("minDisparity", minDisparity, -256, 256)

    def getMinDisparity(self) -> int:
        """Returns the smallest candidate, px."""
        return self._values["minDisparity"]

    def setNumDisparities(self, numDisparities: int) -> None:
        """Sets the number of candidates, a multiple of 16, 16 to 256."""
        if whole_number("numDisparities", numDisparities, 16, 256) % 16:
            raise ValueError(f"numDisparities: found '{numDisparities}', allowed: a multiple of 16, 16 .. 256")
        self._set("numDisparities", numDisparities, 16, 256)

    def getNumDisparities(self) -> int:
        """Returns the number of candidates."""
        return self._values["numDisparities"]

    def setBlockSize(self, blockSize: int) -> None:
        """Sets the window, 1 to 21: up to 7 the census of 7x5 with a gradient, from 8 on that of 9x7."""
        self._set("blockSize", blockSize, 1, 21)

    def getBlockSize(self) -> int:
        """Returns blockSize as it was set."""
        return self._values["blockSize"]

    def setP1(self, P1: int) -> None:
        """Sets P1; the ratio P2 / P1 counts. 0 with P2 = 0: tuned values."""
        self._set("P1", P1, 0, 2**31 - 1)

    def getP1(self) -> int:
        """Returns P1 as it was set."""
        return self._values["P1"]

    def setP2(self, P2: int) -> None:
        """Sets P2, more than P1, or 0."""
        self._set("P2", P2, 0, 2**31 - 1)

    def getP2(self) -> int:
        """Returns P2 as it was set."""
        return self._values["P2"]

    def setDisp12MaxDiff(self, disp12MaxDiff: int) -> None:
        """Sets the left-right check: 0 and 1 are on, with at most 1 px; less than 0 is off."""
        try:
            self._set("disp12MaxDiff", disp12MaxDiff, -_MOST - 1, 1)
        except ValueError:
            raise ValueError(f"disp12MaxDiff: found '{disp12MaxDiff}', allowed: 0 or 1 (left and right differ by at most 1 px), less "
                             "than 0 (no such check)") from None

    def getDisp12MaxDiff(self) -> int:
        """Returns disp12MaxDiff as it was set."""
        return self._values["disp12MaxDiff"]

    def setPreFilterCap(self, preFilterCap: int) -> None:
        """Takes 0 to 63. It limits how much one pixel's brightness counts in OpenCV; a census compares which of two
        pixels is brighter, so there is nothing to limit: UserWarning for what is not 0."""
        self._set("preFilterCap", preFilterCap, 0, 63)
        if preFilterCap:
            warnings.warn(f"preFilterCap = {preFilterCap} changes nothing here: a census compares order, not amounts", stacklevel=3)

    def getPreFilterCap(self) -> int:
        """Returns preFilterCap as it was set."""
        return self._values["preFilterCap"]

    def setUniquenessRatio(self, uniquenessRatio: int) -> None:
        """Sets by how many percent the best cost must be better than the second one, 0 to 99."""
        self._set("uniquenessRatio", uniquenessRatio, 0, 99)

    def getUniquenessRatio(self) -> int:
        """Returns uniquenessRatio."""
        return self._values["uniquenessRatio"]

    def setSpeckleWindowSize(self, speckleWindowSize: int) -> None:
        """Sets up to how many pixels a region is a speckle, which is rejected; 0: none is."""
        self._set("speckleWindowSize", speckleWindowSize, 0, 999_999)

    def getSpeckleWindowSize(self) -> int:
        """Returns speckleWindowSize."""
        return self._values["speckleWindowSize"]

    def setSpeckleRange(self, speckleRange: int) -> None:
        """Sets by how many px neighbours of a region may differ, 0 to 256."""
        self._set("speckleRange", speckleRange, 0, 256)

    def getSpeckleRange(self) -> int:
        """Returns speckleRange."""
        return self._values["speckleRange"]

    def setMode(self, mode: int) -> None:
        """Sets the paths: 8 for MODE_HH, 4 for the others."""
        self._set("mode", mode, self.MODE_SGBM, self.MODE_HH4)

    def getMode(self) -> int:
        """Returns the mode as it was set."""
        return self._values["mode"]


def StereoSGM_create(minDisparity: int = 0, numDisparities: int = 16, blockSize: int = 3, P1: int = 0, P2: int = 0,
                     disp12MaxDiff: int = 0, preFilterCap: int = 0, uniquenessRatio: int = 0, speckleWindowSize: int = 0,
                     speckleRange: int = 0, mode: int = StereoSGM.MODE_SGBM, *, threads: int = 0) -> StereoSGM:
    """Takes the arguments of cv2.StereoSGBM_create, with its defaults, and returns what has its calls.

    threads: 0 = one per core, 1 = the calling thread alone. ValueError with one line for what has no counterpart here:
    docs/python.md says what each argument becomes.
    """
    made = StereoSGM(whole_number("threads", threads, 0, 256))
    made.setMinDisparity(minDisparity)
    made.setNumDisparities(numDisparities)
    made.setBlockSize(blockSize)
    made.setP1(P1)
    made.setP2(P2)
    made.setDisp12MaxDiff(disp12MaxDiff)
    made.setPreFilterCap(preFilterCap)
    made.setUniquenessRatio(uniquenessRatio)
    made.setSpeckleWindowSize(speckleWindowSize)
    made.setSpeckleRange(speckleRange)
    made.setMode(mode)
    return made

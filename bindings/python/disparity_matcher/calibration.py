# SPDX-License-Identifier: Apache-2.0
"""Calibrations of stereo cameras, and the rectification that follows from them."""
from __future__ import annotations

import os
import typing

import numpy as np

from . import _matcher
from .images import Image, ImageLike, Matrix, as_image, as_pair, size_text, whole_number


class Calibration:
    """A stereo calibration for one size of frames, as OpenCV's stereoRectify takes it. load_calibration() makes one,
    Source.calibration and Frame.calibration are others. It does not change; any thread may read it; it can be pickled."""

    def __init__(self, native: _matcher.StereoCalibration) -> None:
        self._native = native

    @property
    def width(self) -> int:
        """Pixels of one eye that the calibration is valid for."""
        return self._native.width

    @property
    def height(self) -> int:
        """Rows that the calibration is valid for."""
        return self._native.height

    @property
    def rectified(self) -> bool:
        """Whether the images are rectified already."""
        return self._native.rectified

    @property
    def origin(self) -> str:
        """Where it was read from, for messages: a name of a file, "recording", "scene"."""
        return self._native.origin

    @property
    def camera_matrices(self) -> tuple[Matrix, Matrix]:
        """3x3 of the left and the right camera, pixels: OpenCV's M1 and M2."""
        return self._native.K_left, self._native.K_right

    @property
    def distortion(self) -> tuple[list[float], list[float]]:
        """Coefficients of both lenses in OpenCV's order: 5, 8, 12 or 14 of Brown's model, 4 of a fisheye."""
        return self._native.D_left, self._native.D_right

    @property
    def fisheye(self) -> tuple[bool, bool]:
        """Whether the left and the right lens have OpenCV's fisheye model."""
        return self._native.fisheye

    @property
    def R(self) -> Matrix:
        """3x3: turns points of the left camera to the axes of the right one."""
        return self._native.R

    @property
    def T(self) -> Matrix:
        """3x1, mm: (-baseline, ty, tz)."""
        return self._native.T

    def to_opencv_yaml(self) -> str:
        """Returns OpenCV's YAML (M1 D1 M2 D2 R T), which load_calibration() and OpenCV read. ValueError where it is
        of rectified images."""
        return self._native.to_opencv_yaml()

    def __reduce__(self) -> tuple[typing.Any, ...]:
        return _from_text, (self._native.to_text(), self.origin)

    def __repr__(self) -> str:
        return f"<Calibration of {self.origin} for {self.width}x{self.height}>"


def _from_text(text: str, origin: str) -> Calibration:
    return Calibration(_matcher.StereoCalibration.from_text(text, os.fsencode(origin)))


def _two_numbers(name: str, size: typing.Any) -> tuple[int, int]:
    try:
        width, height = size
    except (TypeError, ValueError):
        raise ValueError(f"{name}: found '{size}', allowed: (width, height)") from None
    return whole_number(f"{name}, width", width, 1, 65535), whole_number(f"{name}, height", height, 1, 65535)


def load_calibration(path: str | os.PathLike[str], size: tuple[int, int]) -> Calibration:
    """Reads a calibration in any of the formats that docs/calibration.md lists: a factory .conf, OpenCV's YAML, JSON or
    XML, ROS, Kalibr, EuRoC, ORB-SLAM, Middlebury, ETH3D, KITTI. Two files stand with a comma between them, and behind a
    question mark what they leave open, as "stereo.yml?unit=m".

    size: (width, height) of one eye's frames, which several formats do not say, and others have for more than one.
    ValueError with one line that says what is wrong with the file.
    """
    return Calibration(_matcher.StereoCalibration.read(os.fsencode(path), *_two_numbers("size", size)))


class Rectifier:
    """Takes raw pairs of a calibrated camera to rectified ones, the same pixels as disparityd's. Made once for a
    calibration, it holds maps; any number of threads may use it at the same time.

    calibration: of the camera. size: (width, height) of the rectified image; None: that of the capture. region:
    (x, y, width, height) of it that is wanted; None: all. ValueError where these do not fit together.
    """

    def __init__(self, calibration: Calibration, size: tuple[int, int] | None = None,
                 region: tuple[int, int, int, int] | None = None) -> None:
        if not isinstance(calibration, Calibration):
            raise ValueError(f"calibration: found '{calibration}', allowed: what load_calibration() returns"
                             + (", and this source has none" if calibration is None else ""))
        width, height = (0, 0) if size is None else _two_numbers("size", size)
        part = (0, 0, 0, 0) if region is None else tuple(region)
        if len(part) != 4:
            raise ValueError(f"region: found '{region}', allowed: (x, y, width, height)")
        if region is not None:
            part = tuple(whole_number("region", number, least, 65535) for number, least in zip(part, (0, 0, 1, 1)))
        self._arguments = (calibration, size, region)
        self._native = _matcher.Rectification(calibration._native, width, height, list(part))

    @property
    def width(self) -> int:
        """Pixels of the rectified region."""
        return self._native.width

    @property
    def height(self) -> int:
        """Rows of the rectified region."""
        return self._native.height

    @property
    def f(self) -> float:
        """Rectified focal length, px; 0 = unknown."""
        return self._native.f

    @property
    def cx(self) -> float:
        """Column of the principal point within the region, px."""
        return self._native.cx

    @property
    def cy(self) -> float:
        """Row of the principal point within the region, px."""
        return self._native.cy

    @property
    def baseline_mm(self) -> float:
        """Distance between the cameras, mm; 0 = unknown."""
        return self._native.baseline_mm

    @property
    def disparity_offset(self) -> float:
        """px, added to a disparity before Z = f B / d."""
        return self._native.disparity_offset

    @property
    def calibration_id(self) -> int:
        """Hash of maps and geometry: the same pixels, the same number, as Frame.calibration_id of the client."""
        return self._native.calibration_id

    @property
    def R_left(self) -> Matrix:
        """3x3: turns the left camera's axes to the rectified ones (OpenCV's R1)."""
        return self._native.R_left

    def rectify(self, left: ImageLike, right: ImageLike, *, bits: int | None = None) -> tuple[Image, Image]:
        """Returns the rectified pair as new arrays, uint8: grey of grey images, BGR of BGR ones.

        left, right: raw images as match() takes them, of the calibration's size. ValueError with one line for others.
        """
        pair = as_pair(left, right, bits)
        return self._eye(pair[0], False, pair[0].ndim == 3), self._eye(pair[1], True, pair[1].ndim == 3)

    def _eye(self, image: Image, right_eye: bool, colour: bool) -> Image:
        native = self._native
        if image.shape[:2] != (native.capture_height, native.capture_width):
            raise ValueError(f"images are {size_text(image)}, and the calibration of {self._arguments[0].origin} is for "
                             f"{native.capture_width}x{native.capture_height}")
        out = np.empty((native.height, native.width) + ((3,) if colour else ()), np.uint8)
        _matcher.rectify(native, right_eye, image, out)
        return out

    def __reduce__(self) -> tuple[typing.Any, ...]:
        return Rectifier, self._arguments


def grey_pair(left: Image, right: Image, rectifier: Rectifier | None) -> tuple[Image, Image]:
    """Returns what is matched of a pair: rectified luma, in arrays of its own, which the caller's next picture does
    not change."""
    if rectifier is not None:
        return rectifier._eye(left, False, False), rectifier._eye(right, True, False)
    return _luma("left", left), _luma("right", right)


def _luma(name: str, image: Image) -> Image:
    if image.ndim == 2:
        return image.copy()
    grey = np.empty(image.shape[:2], np.uint8)
    _matcher.rectify(None, False, image, grey)
    return grey

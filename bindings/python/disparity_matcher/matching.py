# SPDX-License-Identifier: Apache-2.0
"""The matcher: pairs of images in, disparities, confidences and distances out."""
from __future__ import annotations

import dataclasses
import functools
import math
import operator
import os
import threading
import typing
import weakref

import numpy as np

from . import _matcher
from .calibration import Rectifier, grey_pair
from .images import Image, ImageLike, as_pair, whole_number

if typing.TYPE_CHECKING:
    import numpy.typing as npt

_FIELDS = {name: (is_switch, allowed) for name, is_switch, allowed, _ in _matcher.fields()}
_OPTIONS_TEXT = "\n".join(f"        {name} ({allowed}): {text}" for name, _, allowed, text in _matcher.fields())


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Match:
    """What was found for a pair. All arrays have height x width of the pair; pixels that nobody knows are NaN in
    floating-point arrays. What is not asked for is not computed. Nothing can be changed of what was found, so that what
    follows from it fits: disparity, confidence, left and right are read-only, copy() makes others.

    disparity: int16, 1/16 px: left (x, y) and right (x - d, y) show the same; `invalid` where rejected.
    confidence: uint8, 1 to 255; 0 = rejected or interpolated. With calibrated_confidence, as in the presets dense and
        obstacles, it is the chance in 255ths that the disparity is off by at most 1 px; else a ratio of costs.
    invalid: the value of rejected pixels of `disparity`, (d_min - 1) * 16.
    left, right: uint8, the rectified grey images that were matched.
    f, baseline_mm, disparity_offset: the geometry of distances, 0 = unknown.
    subpixel_error_px: one sigma of a right disparity.
    """

    disparity: npt.NDArray[np.int16]
    confidence: Image
    invalid: int
    left: Image
    right: Image
    f: float
    baseline_mm: float
    disparity_offset: float
    subpixel_error_px: float

    def __post_init__(self) -> None:
        arrays: tuple[npt.NDArray[typing.Any], ...] = (self.disparity, self.confidence, self.left, self.right)
        for array in arrays:
            array.setflags(write=False)

    @functools.cached_property
    def disparity_px(self) -> npt.NDArray[np.float32]:
        """float32, px, NaN where rejected."""
        return _matcher.disparity_px(self.disparity, self.invalid)

    @functools.cached_property
    def depth_m(self) -> npt.NDArray[np.float32]:
        """float32, metres along the optical axis: NaN where unknown, infinity where the disparity is 0 or less.
        ValueError where focal length or baseline are not known."""
        return _matcher.depth_m(self.disparity, self.invalid, self._focal_baseline(), self.disparity_offset)

    @functools.cached_property
    def depth_error_m(self) -> npt.NDArray[np.float32]:
        """float32, one sigma of a right match's depth_m, metres; NaN where the confidence is 0 (rejected or
        interpolated: nobody measured it), infinity where the disparity is 0 or less. ValueError as depth_m."""
        return _matcher.depth_error_m(self.disparity, self.confidence, self._focal_baseline(), self.disparity_offset,
                                      self.subpixel_error_px)

    def _focal_baseline(self) -> float:
        if not (self.f > 0 and self.baseline_mm > 0):
            raise ValueError("no distances without a calibration: give a rectifier, or f in px and baseline_mm")
        return self.f * self.baseline_mm / 1000


class Metric(typing.NamedTuple):
    """What turns disparities into distances."""

    f: float
    baseline_mm: float
    disparity_offset: float
    subpixel_error_px: float


def _real(name: str, value: typing.Any, least: float, most: float) -> float:
    number = float(value) if isinstance(value, (int, float, np.number)) else math.nan
    if not least <= number <= most:
        raise ValueError(f"{name}: found '{value}', allowed: a number from {least:g} to {most:g}")
    return number


def _option_number(name: str, value: typing.Any) -> int:
    is_switch, allowed = _FIELDS[name]
    try:
        number = operator.index(value)
    except TypeError:
        raise ValueError(f"{name}: found '{value}', allowed: {allowed}") from None
    if (is_switch and number not in (0, 1)) or abs(number) >= 1 << 31:
        raise ValueError(f"{name}: found '{value}', allowed: {allowed}")
    return number


class Matcher:
    __doc__ = f"""Matches pairs, and keeps its memory and threads from one to the next of the same size.

    method: sgm (most pixels, few of them wrong), census or sad. preset, of sgm: dense (every pixel), obstacles (measured
        pixels only) or paper; None: dense. cost: census-9x7 or census-7x5+gradient; None: that of the preset.
    disparities: number of candidates in whole pixels, a multiple of 16, 16 to 256, from d_min on.
    threads: 0 = one per core, 1 = the calling thread alone. The result does not depend on it.
    backend: auto (the fastest here), cpu, reference, or cuda where it was built; all give the same bytes.
    rectifier: pairs are raw ones of its camera; None: pairs are rectified already. It gives the geometry of distances;
        else f (px), baseline_mm and disparity_offset (px) may, for depth_m and depth_error_m.
    subpixel_error_px: one sigma of a right disparity, 0.01 to 4, for depth_error_m.

    The others are those of [match] in the configuration of disparityd and of disparityctl's command lines, by the same
    names; without one the tuned value of method and preset holds:
{_OPTIONS_TEXT}

    ValueError with one line where a value is not allowed, TypeError for a name that is no option, RuntimeError where
    memory or a device is missing. Any thread may call match(); while one matches, others wait: with a Matcher for each
    thread they match at the same time. After a fork the child goes on with threads and memory of its own.
    Pickling keeps the arguments.
    """

    def __init__(self, *, method: str = "sgm", preset: str | None = None, cost: str | None = None, disparities: int = 64,
                 threads: int = 0, backend: str = "auto", rectifier: Rectifier | None = None, f: float = 0,
                 baseline_mm: float = 0, disparity_offset: float = 0, subpixel_error_px: float = 0.25,
                 **options: int) -> None:
        self._arguments = {**{name: value for name, value in locals().items() if name not in ("self", "options")}, **options}
        unknown = sorted(set(options) - set(_FIELDS))
        if unknown:
            raise TypeError(f"no option of matching is called '{unknown[0]}'; there are {', '.join(_FIELDS)}")
        given = {name: _option_number(name, value) for name, value in {"disparities": disparities, **options}.items()}
        self._options = _matcher.MatchOptions(str(method), "" if preset is None else str(preset),
                                              "" if cost is None else str(cost), given)
        self._threads = whole_number("threads", threads, 0, 256)
        _matcher.check_backend(str(backend))
        self._backend = str(backend)
        if rectifier is not None and not isinstance(rectifier, Rectifier):
            raise ValueError(f"rectifier: found '{rectifier}', allowed: a Rectifier")
        if rectifier is not None and (f or baseline_mm or disparity_offset):
            raise ValueError("f, baseline_mm and disparity_offset: the rectifier has them, give one or the other")
        self._rectifier = rectifier
        if rectifier is not None:
            f, baseline_mm, disparity_offset = rectifier.f, rectifier.baseline_mm, rectifier.disparity_offset
        if bool(f) != bool(baseline_mm):
            raise ValueError("f and baseline_mm: one of them is missing, distances need both")
        self._metric = Metric(_real("f", f, 0, 1e6), _real("baseline_mm", baseline_mm, 0, 1e6),
                              _real("disparity_offset", disparity_offset, -1e6, 1e6),
                              _real("subpixel_error_px", subpixel_error_px, 0.01, 4))
        self._lock = threading.Lock()
        self._native: tuple[tuple[int, int], _matcher.PairMatcher] | None = None
        _matchers.add(self)

    @property
    def options(self) -> dict[str, typing.Any]:
        """Every option of matching that holds, by name."""
        return self._options.as_dict()

    @property
    def trouble(self) -> str:
        """One line on what went wrong and was made good, such as a lost GPU whose work the processor has taken over;
        empty as long as all is well."""
        native = self._native  # once, as another thread may change it
        return native[1].trouble if native else ""

    def match(self, left: ImageLike, right: ImageLike, *, bits: int | None = None) -> Match:
        """Matches a pair. Where the options adapt to noise, it is matched again until its noise level stays, as a pair
        that has no frame before it.

        left, right: uint8 of one size, 1 to 8192 pixels each way; grey (height, width), or BGR (height, width, 3).
            Strided, reversed and read-only arrays are taken. They must not change during the call; afterwards they may,
            as the result has images of its own.
        bits: of uint16, which need it: how many of 16 the values use, 9 to 16. Value / 2^(bits - 8) is matched, at most
            255.
        Returns new arrays. ValueError with one line where these are no images of a pair; RuntimeError where memory or a
        device is missing.
        """
        disparity, confidence, pair = self._found(left, right, bits)
        return Match(disparity, confidence, self._options.invalid, *pair, *self._metric)

    def _found(self, left: ImageLike, right: ImageLike,
               bits: int | None) -> tuple[npt.NDArray[np.int16], Image, tuple[Image, Image]]:
        pair = grey_pair(*as_pair(left, right, bits), self._rectifier)
        matcher = self._of_size(pair[0].shape[0], pair[0].shape[1])
        disparity = np.empty(pair[0].shape, np.int16)
        confidence = np.empty(pair[0].shape, np.uint8)
        matcher.match(pair[0], pair[1], disparity, confidence)
        return disparity, confidence, pair

    def __reduce__(self) -> tuple[typing.Any, ...]:
        return functools.partial(Matcher, **self._arguments), ()

    def _of_size(self, height: int, width: int) -> _matcher.PairMatcher:
        with self._lock:
            if self._native is None or self._native[0] != (height, width):
                self._native = None  # first, as both together may be too much memory
                self._native = (height, width), _matcher.PairMatcher(width, height, self._options, self._backend,
                                                                     self._threads)
            return self._native[1]


_matchers: weakref.WeakSet[Matcher] = weakref.WeakSet()


def _unlock_in_child() -> None:
    # The thread that held a lock is not in the child to let it go.
    for matcher in _matchers:
        matcher._lock = threading.Lock()


os.register_at_fork(after_in_child=_unlock_in_child)


def match(left: ImageLike, right: ImageLike, preset: str | None = None, disparities: int = 64, *, bits: int | None = None,
          **arguments: typing.Any) -> Match:
    """Matches one pair: Matcher(preset=preset, disparities=disparities, ...).match(left, right, bits=bits). For several
    pairs a Matcher is faster, as it keeps its memory.

    help(disparity_matcher.Matcher) has the arguments, help(disparity_matcher.Match) what is returned.
    """
    return Matcher(preset=preset, disparities=disparities, **arguments).match(left, right, bits=bits)

# SPDX-License-Identifier: Apache-2.0
"""A frame: image planes as numpy arrays, and everything that comes with them."""
import dataclasses

import numpy as np

# Products.
DISPARITY = 1
CONFIDENCE = 2
DEPTH = 3
LEFT = 4
LEFT_COLOUR = 5

# Bits of Frame.flags.
UNRECTIFIED = 1
INTERPOLATED = 2
DROPPED_BEFORE = 4
DISCONTINUITY = 8

# The rejected pixels of a depth image, and those that are valid but farther away than the type can say.
DEPTH_UNKNOWN = 0
DEPTH_BEYOND = 65535

_TYPES = {DISPARITY: "<i2", CONFIDENCE: "u1", DEPTH: "<u2", LEFT: "u1", LEFT_COLOUR: "u1"}


def plane_array(product, width, height, bytes_per_pixel, data):
    """The bytes of a plane as an array of height x width (x channels); no copy."""
    kind = np.dtype(_TYPES.get(product, "u1"))
    channels = bytes_per_pixel // kind.itemsize
    if channels == 0 or channels * kind.itemsize != bytes_per_pixel:
        raise ValueError(f"product {product} with {bytes_per_pixel} bytes per pixel")
    shape = (height, width) if channels == 1 else (height, width, channels)
    return np.frombuffer(data, kind).reshape(shape)


@dataclasses.dataclass
class Frame:
    """Times in ns, lengths in pixels unless the name says otherwise; docs/protocol.md explains each field."""

    publish_index: int = 0
    sequence: int = 0
    monotonic_ns: int = 0
    realtime_ns: int = 0
    age_ns: int = 0
    dropped_before: int = 0
    missed: int = 0
    calibration_id: int = 0
    f: float = 0.0
    cx: float = 0.0
    cy: float = 0.0
    baseline_mm: float = 0.0
    disparity_offset: float = 0.0
    d_min: int = 0
    disparities: int = 0
    invalid: int = 0
    flags: int = 0
    width: int = 0
    height: int = 0
    region_x: int = 0
    region_y: int = 0
    planes: dict = dataclasses.field(default_factory=dict, repr=False)

    def _plane(self, product, name):
        if product not in self.planes:
            raise KeyError(f"this frame has no {name}: subscribe to it, or have the daemon make it")
        return self.planes[product]

    @property
    def disparity(self):
        """int16, 1/16 px; self.invalid where rejected."""
        return self._plane(DISPARITY, "disparity")

    @property
    def disparity_px(self):
        """float32, px, NaN where rejected."""
        raw = self.disparity
        return np.where(raw == self.invalid, np.float32(np.nan), raw.astype(np.float32) / np.float32(16))

    @property
    def confidence(self):
        """uint8, 0 = rejected or interpolated."""
        return self._plane(CONFIDENCE, "confidence")

    @property
    def depth(self):
        """uint16, mm; 0 = unknown, 65535 = valid but beyond 65.534 m."""
        return self._plane(DEPTH, "depth")

    @property
    def depth_m(self):
        """float32, metres, NaN where unknown, infinity where beyond 65.534 m."""
        raw = self.depth
        metres = raw.astype(np.float32) / np.float32(1000)
        metres[raw == DEPTH_UNKNOWN] = np.nan
        metres[raw == DEPTH_BEYOND] = np.inf
        return metres

    @property
    def left(self):
        """uint8, rectified left image."""
        return self._plane(LEFT, "left image")

    @property
    def left_colour(self):
        """uint8, height x width x 3, BGR."""
        return self._plane(LEFT_COLOUR, "left colour image")

    def points(self):
        """float32 array of height x width x 3: X right, Y down, Z forward in metres; NaN where there is no depth.

        Made from disparity; needs a calibration (f and baseline known).
        """
        if self.f <= 0 or self.baseline_mm <= 0:
            raise ValueError("no points without a calibration: f or baseline are unknown")
        disparity = self.disparity_px + np.float32(self.disparity_offset)
        with np.errstate(divide="ignore", invalid="ignore"):
            z = np.where(disparity > 0, np.float32(self.f * self.baseline_mm / 1000) / disparity, np.float32(np.nan))
        height, width = z.shape
        x = np.arange(width, dtype=np.float32) + np.float32(self.region_x - self.cx)
        y = np.arange(height, dtype=np.float32)[:, None] + np.float32(self.region_y - self.cy)
        return np.stack([x * z / np.float32(self.f), y * z / np.float32(self.f), z], axis=-1)

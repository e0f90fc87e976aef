# SPDX-License-Identifier: Apache-2.0
"""Defines an obstacle scan: by bearing, what is near."""
from __future__ import annotations

import dataclasses
import typing

import numpy as np
import numpy.typing as npt

from .errors import DisparityError

# States of a sector. Take every other value for UNKNOWN.
UNKNOWN = 0
FREE = 1
OCCUPIED = 2
MASKED = 3

# Where the ground's plane comes from: the configured mounting, a fit to this frame, a fit to an earlier one, the camera's
# inertial sensor. A later daemon may send other numbers: the plane holds all the same.
GROUND_CONFIGURED = 0
GROUND_FITTED = 1
GROUND_HELD = 2
GROUND_GRAVITY = 3
GROUND_AUTOPILOT = 4

_VERSION = 2
_DOUBT_SHIFT = 8  # from the doubts of a sector to bits of Frame.flags
# The bytes of a scan; docs/protocol.md explains each field. proto/scan.h has the same.
_HEAD = np.dtype(
    [
        ("version", "<u2"),
        ("sectors", "<u2"),
        ("ground", "u1"),
        ("reserved", "u1"),
        ("ground_age", "<u2"),
        ("ground_mm", "<i2"),
        ("ground_slope_ahead", "<i2"),
        ("ground_slope_left", "<i2"),
        ("low_mm", "<i2"),
        ("high_mm", "<i2"),
        ("min_mm", "<u2"),
        ("max_mm", "<u2"),
        ("mounting_height_mm", "<u2"),
        ("mounting_pitch_cdeg", "<i2"),
        ("mounting_roll_cdeg", "<i2"),
        ("reserved_words", "<u2", 2),
    ]
)
_SECTOR = np.dtype(
    [
        ("from_cdeg", "<i2"),
        ("to_cdeg", "<i2"),
        ("state", "u1"),
        ("confidence", "u1"),
        ("distance_mm", "<u2"),
        ("sigma_mm", "<u2"),
        ("free_mm", "<u2"),
        ("low_mm", "<i2"),
        ("high_mm", "<i2"),
        ("pixels", "<u2"),
        ("doubts", "<u2"),
        ("trust", "u1"),
        ("reserved", "u1"),
    ]
)


@dataclasses.dataclass(frozen=True)
class Mounting:
    """How the left camera is mounted above the floor, in the words of the daemon's configuration."""

    height_m: float
    pitch_deg: float  # positive looks down
    roll_deg: float  # positive has its right side lower


@dataclasses.dataclass
class Scan:
    """Has one element per sector in each array, by bearing, the right-most first. Lengths in metres, distances horizontal
    from the robot's origin; bearings in degrees, 0 is the robot's x axis, left is positive.

    The frame of reference is the robot's: x ahead, y left, z up, the origin on the ground below the camera, or where the
    daemon's configuration puts it. The ground is the plane z = ground_height_m + ground_slope_ahead x + ground_slope_left y.
    """

    ground: int  # GROUND_CONFIGURED, GROUND_FITTED, GROUND_HELD, GROUND_GRAVITY or GROUND_AUTOPILOT
    ground_age: int  # frames since the plane was fitted
    ground_height_m: float
    ground_slope_ahead: float
    ground_slope_left: float
    band_m: tuple[float, float]  # obstacles lie between these two heights above the plane
    range_m: tuple[float, float]  # nothing is reported nearer than the first or beyond the second
    mounting: typing.Optional[Mounting]  # that the floor of the last seconds shows; None: not found
    from_deg: npt.NDArray[np.float64]  # the right edge
    to_deg: npt.NDArray[np.float64]  # the left edge
    state: npt.NDArray[np.uint8]  # UNKNOWN, FREE up to free_m, OCCUPIED at distance_m, or MASKED: unknown
    distance_m: npt.NDArray[np.float64]  # to the nearest obstacle of an occupied sector, else NaN
    sigma_m: npt.NDArray[np.float64]  # one-sigma error of distance_m, else NaN
    free_m: npt.NDArray[np.float64]  # no obstacle is nearer, whatever the state; at most distance_m
    low_m: npt.NDArray[np.float64]  # the obstacle's lowest part above the ground, else NaN
    high_m: npt.NDArray[np.float64]  # its highest part
    pixels: npt.NDArray[np.int32]  # that show it
    confidence: npt.NDArray[np.uint8]  # mean of those pixels
    trust: npt.NDArray[np.uint8]  # how far each sector can be trusted: 1 to 255, more is better; 0: not told
    doubts: npt.NDArray[np.uint32]  # why it can be trusted less: bits of Frame.flags, such as DIRTY_EYE

    @property
    def near(self) -> npt.NDArray[np.bool_]:
        """Tells where the obstacle is nearer than can be measured: distance_m is the most that it can be there."""
        return (self.state == OCCUPIED) & (self.pixels == 0)


def _mounting(head: np.void) -> typing.Optional[Mounting]:
    if head["mounting_height_mm"] == 0:
        return None
    return Mounting(
        float(head["mounting_height_mm"]) / 1000,
        float(head["mounting_pitch_cdeg"]) / 100,
        float(head["mounting_roll_cdeg"]) / 100,
    )


def read_scan(data: bytes) -> Scan:
    """Returns the Scan that bytes hold. Raises DisparityError when they have another version or length."""
    if len(data) < _HEAD.itemsize:
        raise DisparityError(f"the scan has {len(data)} bytes, its head alone has {_HEAD.itemsize}")
    head = np.frombuffer(data, _HEAD, 1)[0]
    if head["version"] != _VERSION:
        raise DisparityError(
            f"the scan has version {head['version']}, this program knows {_VERSION}: use the client that came with the daemon"
        )
    count = int(head["sectors"])
    if len(data) != _HEAD.itemsize + count * _SECTOR.itemsize:
        raise DisparityError(f"the scan has {len(data)} bytes, which is not the length of {count} sectors")
    sectors = np.frombuffer(data, _SECTOR, count, _HEAD.itemsize)
    occupied = sectors["state"] == OCCUPIED

    def of_obstacles(name: str) -> npt.NDArray[np.float64]:
        return np.where(occupied, sectors[name] / 1000, np.nan)

    return Scan(
        ground=int(head["ground"]),
        ground_age=int(head["ground_age"]),
        ground_height_m=float(head["ground_mm"]) / 1000,
        ground_slope_ahead=float(head["ground_slope_ahead"]) / 10000,
        ground_slope_left=float(head["ground_slope_left"]) / 10000,
        band_m=(float(head["low_mm"]) / 1000, float(head["high_mm"]) / 1000),
        range_m=(float(head["min_mm"]) / 1000, float(head["max_mm"]) / 1000),
        mounting=_mounting(head),
        from_deg=sectors["from_cdeg"] / 100,
        to_deg=sectors["to_cdeg"] / 100,
        state=sectors["state"].copy(),
        distance_m=of_obstacles("distance_mm"),
        sigma_m=of_obstacles("sigma_mm"),
        free_m=sectors["free_mm"] / 1000,
        low_m=of_obstacles("low_mm"),
        high_m=of_obstacles("high_mm"),
        pixels=sectors["pixels"].astype(np.int32),
        confidence=sectors["confidence"].copy(),
        trust=sectors["trust"].copy(),
        doubts=sectors["doubts"].astype(np.uint32) << np.uint32(_DOUBT_SHIFT),
    )

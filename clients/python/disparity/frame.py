# SPDX-License-Identifier: Apache-2.0
"""Defines a frame: image planes as numpy arrays, and the numbers that come with them."""
from __future__ import annotations

import ctypes
import dataclasses
import typing

import numpy as np
import numpy.typing as npt

from . import disparity_pb2 as pb
from .scan import Scan, read_scan

# What a plane or its bytes are before the product says more.
Plane = npt.NDArray[typing.Any]
Bytes = typing.Union[bytes, bytearray, memoryview, Plane]

# Bits of Frame.flags.
UNRECTIFIED = 1
INTERPOLATED = 2
DROPPED_BEFORE = 4
DISCONTINUITY = 8
SYNTHETIC = 16
EXPOSURE_CENTRE = 32
# Doubts, why a frame can be trusted less; docs/protocol.md explains them. Bits 24 .. 31 are the trust.
DARK = 0x100
SATURATED = 0x200
BLURRED = 0x400
DIRTY_EYE = 0x800
COVERED_EYE = 0x1000
MISALIGNED = 0x2000
TOO_NEAR = 0x4000
NOISY = 0x8000
_DOUBTS = {"dark": DARK, "saturated": SATURATED, "blurred": BLURRED, "dirty-eye": DIRTY_EYE, "covered-eye": COVERED_EYE,
           "misaligned": MISALIGNED, "too-near": TOO_NEAR, "noisy": NOISY}
_TRUST_SHIFT = 24

# The value of unknown pixels of a depth image and of its errors, and of those that are more than the type can hold.
DEPTH_UNKNOWN = 0
DEPTH_BEYOND = 65535


def doubt_names(flags: int) -> list[str]:
    """Returns the words of the doubts in Frame.flags or in an element of Scan.doubts, such as "dirty-eye"."""
    return [word for word, bit in _DOUBTS.items() if flags & bit]


class Product(typing.NamedTuple):
    """Describes a product. name: the property of Frame. kind: the numpy type of one channel. channels: 0 for a record,
    which is no image but a row of bytes."""

    name: str
    kind: str
    channels: int


_KINDS = {"u8": "u1", "i16": "<i2", "u16": "<u2"}


def _described(value: typing.Any) -> Product:
    info = value.GetOptions().Extensions[pb.product]
    return Product(value.name.lower(), _KINDS[info.type], info.channels)


# The products that this program knows, by number, as the options in disparity.proto describe them.
PRODUCTS = {value.number: _described(value) for value in pb.Product.DESCRIPTOR.values if value.number}
# Planes of products that this program does not know are bytes.
_UNKNOWN = Product("", "u1", 1)


def product_name(number: int) -> str:
    """Returns the name of a product for messages, or its number where it has none here."""
    return PRODUCTS[number].name if number in PRODUCTS else f"product {number}"


def plane_array(product: int, width: int, height: int, bytes_per_pixel: int, data: Bytes) -> Plane:
    """Returns the bytes of a plane as an array of height x width (x channels), without a copy."""
    kind = np.dtype(PRODUCTS.get(product, _UNKNOWN).kind)
    channels = bytes_per_pixel // kind.itemsize
    if channels == 0 or channels * kind.itemsize != bytes_per_pixel:
        raise ValueError(f"plane of {product_name(product)} with {bytes_per_pixel} bytes per pixel")
    shape = (height, width) if channels == 1 else (height, width, channels)
    return np.frombuffer(data, kind).reshape(shape)


# A message of a socket has a number in disparityd.v1.Frame, or in its Geometry.
_FRAME, _GEOMETRY = "frame", "geometry"


def _number(c_type: type[typing.Any], message: str | None = None) -> typing.Any:
    """Makes a field of Frame. c_type: its type in disparity_frame_info of disparity_client.h, which has the same order.
    message: the message of a socket that has it under the same name; None: the client fills it in."""
    return dataclasses.field(default=c_type().value, metadata={"c_type": c_type, "message": message})


@dataclasses.dataclass
class Frame:
    """Has times in ns and lengths in pixels unless the name says otherwise; docs/protocol.md explains each field."""

    publish_index: int = _number(ctypes.c_uint64, _FRAME)
    sequence: int = _number(ctypes.c_uint64, _FRAME)
    monotonic_ns: int = _number(ctypes.c_int64, _FRAME)
    realtime_ns: int = _number(ctypes.c_int64, _FRAME)
    age_ns: int = _number(ctypes.c_int64, _FRAME)
    dropped_before: int = _number(ctypes.c_uint64, _FRAME)
    skipped: int = _number(ctypes.c_uint64)
    calibration_id: int = _number(ctypes.c_uint64, _GEOMETRY)
    f: float = _number(ctypes.c_double, _GEOMETRY)
    cx: float = _number(ctypes.c_double, _GEOMETRY)
    cy: float = _number(ctypes.c_double, _GEOMETRY)
    baseline_mm: float = _number(ctypes.c_double, _GEOMETRY)
    disparity_offset: float = _number(ctypes.c_double, _GEOMETRY)
    d_min: int = _number(ctypes.c_int32, _GEOMETRY)
    disparities: int = _number(ctypes.c_uint32, _GEOMETRY)
    invalid: int = _number(ctypes.c_int32, _GEOMETRY)
    flags: int = _number(ctypes.c_uint32, _FRAME)
    width: int = _number(ctypes.c_uint32, _GEOMETRY)
    height: int = _number(ctypes.c_uint32, _GEOMETRY)
    region_x: int = _number(ctypes.c_uint32)
    region_y: int = _number(ctypes.c_uint32)
    planes: dict[int, Plane] = dataclasses.field(default_factory=dict, repr=False)
    # Asks the library whether a borrowed frame is whole; None: the frame was copied.
    _is_whole: typing.Callable[[], bool] | None = dataclasses.field(default=None, repr=False, compare=False)

    @property
    def trust(self) -> int:
        """How far the frame can be trusted: 1 to 255, more is better; 0 where the daemon does not tell it."""
        return self.flags >> _TRUST_SHIFT

    @property
    def doubts(self) -> list[str]:
        """Why it can be trusted less: words such as "dirty-eye"."""
        return doubt_names(self.flags)

    def copy(self) -> Frame:
        """Returns a frame with planes of its own. Of a borrowed one: ask whole() of this one afterwards."""
        planes = {product: plane.copy() for product, plane in self.planes.items()}
        return dataclasses.replace(self, planes=planes, _is_whole=None)

    def __deepcopy__(self, memo: dict[int, typing.Any]) -> Frame:
        return self.copy()

    def __reduce__(self) -> tuple[typing.Any, ...]:
        numbers = {name: getattr(self, name) for name, _ in C_FIELDS}
        return _remade, (numbers, {product: plane.copy() for product, plane in self.planes.items()})

    def whole(self) -> bool:
        """Returns whether all that was read from the planes until now belongs to this frame: always for a copied
        frame, and for a borrowed one until the daemon writes over it; then never again."""
        return self._is_whole is None or self._is_whole()

    def _plane(self, product: int) -> Plane:
        if product not in self.planes:
            raise KeyError(f"this frame has no {PRODUCTS[product].name}: subscribe to it, or have the daemon make it")
        return self.planes[product]

    @property
    def disparity(self) -> npt.NDArray[np.int16]:
        """int16, 1/16 px; self.invalid where rejected."""
        return self._plane(pb.DISPARITY)

    @property
    def disparity_px(self) -> npt.NDArray[np.float32]:
        """float32, px, NaN where rejected."""
        raw = self.disparity
        return np.where(raw == self.invalid, np.float32(np.nan), raw.astype(np.float32) / np.float32(16))

    @property
    def confidence(self) -> npt.NDArray[np.uint8]:
        """uint8, 0 = rejected or interpolated."""
        return self._plane(pb.CONFIDENCE)

    @property
    def depth(self) -> npt.NDArray[np.uint16]:
        """uint16, mm; 0 = unknown, 65535 = valid but beyond 65.534 m."""
        return self._plane(pb.DEPTH)

    @property
    def depth_m(self) -> npt.NDArray[np.float32]:
        """float32, metres: NaN where unknown, infinity where beyond what can be measured (beyond 65.534 m of DEPTH). It
        comes from DEPTH, else from the disparities: ValueError for those without a calibration."""
        if pb.DEPTH in self.planes or pb.DISPARITY not in self.planes:
            return _metres(self.depth)
        return self._metres_of_disparities()

    @property
    def depth_error(self) -> npt.NDArray[np.uint16]:
        """uint16, one sigma of depth, mm; 0 = unknown (also where interpolated), 65535 = 65.535 m or more."""
        return self._plane(pb.DEPTH_ERROR)

    @property
    def depth_error_m(self) -> npt.NDArray[np.float32]:
        """float32, one sigma of depth, metres, NaN where unknown, infinity where 65.535 m or more."""
        return _metres(self.depth_error)

    @property
    def left(self) -> npt.NDArray[np.uint8]:
        """uint8, rectified left image."""
        return self._plane(pb.LEFT)

    @property
    def left_colour(self) -> npt.NDArray[np.uint8]:
        """uint8, height x width x 3, BGR."""
        return self._plane(pb.LEFT_COLOUR)

    @property
    def right(self) -> npt.NDArray[np.uint8]:
        """uint8, rectified right image."""
        return self._plane(pb.RIGHT)

    @property
    def right_colour(self) -> npt.NDArray[np.uint8]:
        """uint8, height x width x 3, BGR."""
        return self._plane(pb.RIGHT_COLOUR)

    @property
    def raw_left(self) -> npt.NDArray[np.uint8]:
        """uint8, left image before rectification: f, cx and cy of the frame do not describe it."""
        return self._plane(pb.RAW_LEFT)

    @property
    def raw_right(self) -> npt.NDArray[np.uint8]:
        """uint8, right image before rectification: f, cx and cy of the frame do not describe it."""
        return self._plane(pb.RAW_RIGHT)

    @property
    def scan(self) -> Scan:
        """The obstacle scan, a disparity.Scan. DisparityError for one of another version."""
        return read_scan(self._plane(pb.SCAN).tobytes())

    def points(self, step: int = 1) -> npt.NDArray[np.float32]:
        """Returns a float32 array of height x width x 3, x right, y down, z ahead of the rectified left camera in
        metres: the nearest point of each block of step columns and rows, so that nothing thin is lost; NaN where the
        depth is unknown or beyond what can be measured. colours() has their colours.

        The depths come from the disparities, which are finer than a millimetre near the camera, else from DEPTH.
        ValueError without a calibration.
        """
        if self.f <= 0:
            raise ValueError("no points without a calibration: f is unknown")
        # In the steps of clients/cpp/metres.h: both have the same bits.
        z = self._finite_depths()
        rows, columns = _nearest_pixels(z, step)
        z = z[rows, columns]
        x = (columns + float(self.region_x) - self.cx) * z / self.f
        y = (rows + float(self.region_y) - self.cy) * z / self.f
        return np.stack([x.astype(np.float32), y.astype(np.float32), z], axis=-1)

    def colours(self, step: int = 1) -> npt.NDArray[np.uint8] | None:
        """Returns the colours of points(step), a uint8 array of height x width x 3, red, green, blue; grey ones where
        the frame has LEFT only. None where it has neither. Where step is not 1, ValueError as of points()."""
        if pb.LEFT_COLOUR not in self.planes and pb.LEFT not in self.planes:
            return None
        image = self.left_colour[..., ::-1] if pb.LEFT_COLOUR in self.planes else np.repeat(self.left[..., None], 3, -1)
        return image if step <= 1 else image[_nearest_pixels(self._finite_depths(), step)]

    def _finite_depths(self) -> npt.NDArray[np.float32]:
        """Returns the metres that points have; NaN where they have none."""
        if pb.DISPARITY in self.planes and (self.baseline_mm > 0 or pb.DEPTH not in self.planes):
            z = self._metres_of_disparities()
        else:
            z = _metres(self.depth)
        return np.where(np.isfinite(z), z, np.float32(np.nan))

    def _metres_of_disparities(self) -> npt.NDArray[np.float32]:
        if self.f <= 0 or self.baseline_mm <= 0:
            raise ValueError("no distances without a calibration: f or baseline are unknown")
        raw = self.disparity
        shift = raw / 16.0 + self.disparity_offset
        with np.errstate(divide="ignore", invalid="ignore"):
            z = np.where(shift > 0, self.f * self.baseline_mm / 1000 / shift, np.inf)
        return np.where(raw == self.invalid, np.nan, z).astype(np.float32)


def _nearest_pixels(z: npt.NDArray[np.float32], step: int) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.intp]]:
    """Returns rows and columns of the nearest pixel of each block of step columns and rows: of several the first, row
    by row; the first of a block where all are NaN."""
    if step <= 1:
        return np.arange(z.shape[0])[:, None], np.arange(z.shape[1])
    step = min(step, max(z.shape))
    height, width = (-(-size // step) for size in z.shape)
    blocks = np.full((height * step, width * step), np.inf, np.float32)
    blocks[: z.shape[0], : z.shape[1]] = np.where(np.isnan(z), np.float32(np.inf), z)
    blocks = blocks.reshape(height, step, width, step).swapaxes(1, 2).reshape(height, width, step * step)
    row, column = np.divmod(blocks.argmin(axis=-1), step)
    return np.arange(height)[:, None] * step + row, np.arange(width) * step + column


def _metres(raw: npt.NDArray[np.uint16]) -> npt.NDArray[np.float32]:
    """Returns millimetres of 16 bits as float32 metres."""
    metres = raw.astype(np.float32) / np.float32(1000)
    metres[raw == DEPTH_UNKNOWN] = np.nan
    metres[raw == DEPTH_BEYOND] = np.inf
    return metres


def _remade(numbers: dict[str, typing.Any], planes: dict[int, Plane]) -> Frame:
    """Makes a frame that was pickled."""
    return Frame(**numbers, planes=planes)


# The name and C type of each number, in the order of disparity_frame_info.
C_FIELDS: list[tuple[str, type[typing.Any]]] = [
    (field.name, field.metadata["c_type"]) for field in dataclasses.fields(Frame) if field.metadata
]
# The names of the numbers that each message has.
MESSAGE_FIELDS = {
    message: [field.name for field in dataclasses.fields(Frame) if field.metadata.get("message") == message]
    for message in (_FRAME, _GEOMETRY)
}


def frame_of_message(message: pb.Frame) -> Frame:
    """Returns the Frame of a disparityd.v1.Frame, without planes."""
    numbers = {name: getattr(message, name) for name in MESSAGE_FIELDS[_FRAME]}
    numbers.update((name, getattr(message.geometry, name)) for name in MESSAGE_FIELDS[_GEOMETRY])
    return Frame(**numbers, region_x=message.region.x, region_y=message.region.y)

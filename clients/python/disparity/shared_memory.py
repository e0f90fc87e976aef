# SPDX-License-Identifier: Apache-2.0
"""Frames over shared memory, through the C library libdisparity-client."""
import ctypes
import os
import pathlib

from .errors import DisparityError, Gone
from .frame import Frame, plane_array
from .frame_source import FrameSource

LIBRARY = "libdisparity-client.so.0"

_FRAME, _TIMEOUT, _GONE = 1, 0, -1


class _Info(ctypes.Structure):
    """disparity_frame_info of disparity_client.h."""

    _fields_ = (
        [(name, ctypes.c_uint64) for name in ("publish_index", "sequence")]
        + [(name, ctypes.c_int64) for name in ("monotonic_ns", "realtime_ns", "age_ns")]
        + [(name, ctypes.c_uint64) for name in ("dropped_before", "missed", "calibration_id")]
        + [(name, ctypes.c_double) for name in ("f", "cx", "cy", "baseline_mm", "disparity_offset")]
        + [("d_min", ctypes.c_int32), ("disparities", ctypes.c_uint32)]
        + [("invalid", ctypes.c_int32), ("flags", ctypes.c_uint32)]
        + [(name, ctypes.c_uint32) for name in ("width", "height", "region_x", "region_y", "plane_count", "reserved")]
    )


class _Plane(ctypes.Structure):
    """disparity_plane of disparity_client.h."""

    _fields_ = [
        ("product", ctypes.c_uint32),
        ("width", ctypes.c_uint32),
        ("height", ctypes.c_uint32),
        ("bytes_per_pixel", ctypes.c_uint32),
        ("data", ctypes.c_void_p),
        ("bytes", ctypes.c_uint64),
    ]


def _open_library():
    """$DISPARITY_CLIENT_LIBRARY, beside the package, in the build tree it lies in, or where the loader looks."""
    named = os.environ.get("DISPARITY_CLIENT_LIBRARY")
    if named:
        candidates = [named]
    else:
        here = pathlib.Path(__file__).resolve().parent
        beside = [here / LIBRARY, here.parent / LIBRARY, here.parent.parent / "lib" / LIBRARY]
        candidates = [str(path) for path in beside if path.exists()] + [LIBRARY]
    reasons = []
    for candidate in candidates:
        try:
            return ctypes.CDLL(candidate)
        except OSError as error:
            reasons.append(str(error))
    raise DisparityError(
        f"{LIBRARY} cannot be loaded ({'; '.join(reasons)}): install it, or set DISPARITY_CLIENT_LIBRARY to its path"
    )


def _declare(library):
    pointer, integer, size = ctypes.c_void_p, ctypes.c_int, ctypes.c_size_t
    for name, result, arguments in (
        ("disparity_last_error", ctypes.c_char_p, []),
        ("disparity_frame_new", pointer, []),
        ("disparity_frame_free", None, [pointer]),
        ("disparity_frame_get_info", None, [pointer, ctypes.POINTER(_Info), size]),
        ("disparity_frame_plane_at", integer, [pointer, ctypes.c_uint32, ctypes.POINTER(_Plane)]),
        ("disparity_shared_memory_open", pointer, [ctypes.c_char_p]),
        ("disparity_shared_memory_close", None, [pointer]),
        (
            "disparity_shared_memory_read",
            integer,
            [pointer, pointer, integer, ctypes.POINTER(ctypes.c_uint32), size],
        ),
        ("disparity_shared_memory_heartbeat_age_ns", ctypes.c_int64, [pointer]),
    ):
        function = getattr(library, name)
        function.restype, function.argtypes = result, arguments
    return library


class SharedMemoryReader(FrameSource):
    """Reads /disparityd.<name>. Not for several threads at once. Times are in seconds.

    Raises DisparityError when the library or the object is missing or access is denied, Gone when the daemon has
    stopped; a read() after that looks for a new daemon of the same name.
    """

    def __init__(self, name="default"):
        self._reader = self._frame = None
        self._library = _declare(_open_library())
        self.name = name
        self._reader = self._library.disparity_shared_memory_open(name.encode())
        self._frame = self._library.disparity_frame_new()
        if not self._reader or not self._frame:
            message = self._error()
            self.close()
            raise DisparityError(message)

    def __del__(self):
        self.close()

    def close(self):
        if self._reader:
            self._library.disparity_shared_memory_close(self._reader)
        if self._frame:
            self._library.disparity_frame_free(self._frame)
        self._reader = self._frame = None

    def read(self, timeout=None, products=()):
        """The newest frame not read before, or None when none came in time (None = wait for ever).

        Only the given products are copied; none given = all there are.
        """
        if not self._reader:
            raise ValueError("this reader is closed")
        wanted = (ctypes.c_uint32 * len(products))(*products)
        milliseconds = 2**31 - 1 if timeout is None else int(min(max(0, timeout) * 1000, 2**31 - 1))
        result = self._library.disparity_shared_memory_read(
            self._reader, self._frame, milliseconds, wanted, len(products)
        )
        if result == _TIMEOUT:
            return None
        if result == _GONE:
            raise Gone(f"shared memory {self.name}: the daemon has stopped or died")
        if result != _FRAME:
            raise DisparityError(self._error())
        return self._copy()

    def heartbeat_age(self):
        """Seconds since the daemon's last sign of life; a huge number when it is gone."""
        return self._library.disparity_shared_memory_heartbeat_age_ns(self._reader) / 1e9

    def _error(self):
        return self._library.disparity_last_error().decode(errors="replace")

    def _copy(self):
        """The library's frame as one of ours: its memory is used again by the next read."""
        info = _Info()
        self._library.disparity_frame_get_info(self._frame, ctypes.byref(info), ctypes.sizeof(info))
        names = [name for name, _ in _Info._fields_ if name not in ("plane_count", "reserved")]
        frame = Frame(**{name: getattr(info, name) for name in names})
        for index in range(info.plane_count):
            plane = _Plane()
            if self._library.disparity_frame_plane_at(self._frame, index, ctypes.byref(plane)):
                data = bytearray(ctypes.string_at(plane.data, plane.bytes))
                frame.planes[plane.product] = plane_array(
                    plane.product, plane.width, plane.height, plane.bytes_per_pixel, data
                )
        return frame

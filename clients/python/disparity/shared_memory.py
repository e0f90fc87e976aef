# SPDX-License-Identifier: Apache-2.0
"""Reads frames over shared memory, through the C library libdisparity-client."""
import ctypes
import os
import pathlib
import time

import numpy as np

from .errors import DisparityError, Gone
from .frame import C_FIELDS, Frame, plane_array
from .frame_source import FrameSource

LIBRARY = "libdisparity-client.so.0"

_FRAME, _TIMEOUT, _GONE = 1, 0, -1

# The library waits this long at a time, in ms: Python handles Ctrl-C only between its calls.
_PATIENCE = 200


class _Info(ctypes.Structure):
    """disparity_frame_info of disparity_client.h."""

    # Fields are only added at the end: those after region_y come behind plane_count and reserved.
    _first = [name for name, _ in C_FIELDS].index("region_y") + 1
    _fields_ = C_FIELDS[:_first] + [("plane_count", ctypes.c_uint32), ("reserved", ctypes.c_uint32)] + C_FIELDS[_first:]


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
    """Loads $DISPARITY_CLIENT_LIBRARY, else the library beside the package, in its build tree, or of the system."""
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
        ("disparity_shared_memory_open_with", pointer, [ctypes.c_char_p, ctypes.c_char_p, integer]),
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
    """Reads /disparityd.<name>. One thread at a time may use it. Times are in seconds.

    Raises DisparityError when the library or the object is missing, access is denied, or the owner of the object is not
    trusted. owner: the user who is trusted, beside root and this program's own, a name or a number; None: the user that
    DISPARITYD_SHARED_MEMORY_OWNER names, else "disparityd". may_be_absent: no error without a daemon, read() waits for
    one.
    """

    def __init__(self, name="default", owner=None, may_be_absent=False):
        self._reader = self._frame = None
        self._gone_told = may_be_absent
        self._library = _declare(_open_library())
        self.name = name
        self._reader = self._library.disparity_shared_memory_open_with(
            name.encode(), None if owner is None else str(owner).encode(), int(may_be_absent)
        )
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
        """Returns the newest frame not read before, or None when none came in time (timeout None = wait for ever).

        Raises Gone at once when the daemon has stopped, and within 3 s when it has died. The calls after that wait for
        a new daemon under the name, and raise Gone again when none has come in time. Only the given products are
        copied; without any, all are.
        """
        if not self._reader:
            raise ValueError("this reader is closed")
        wanted = (ctypes.c_uint32 * len(products))(*products)
        deadline = None if timeout is None else time.monotonic() + timeout
        while True:
            left = _PATIENCE if deadline is None else (deadline - time.monotonic()) * 1000
            result = self._library.disparity_shared_memory_read(
                self._reader, self._frame, int(min(max(0, left), _PATIENCE)), wanted, len(products)
            )
            last = left <= _PATIENCE and deadline is not None
            if result == _FRAME:
                self._gone_told = False
                return self._copy()
            if result == _GONE and (last or not self._gone_told):
                self._gone_told = True
                raise Gone(self._error())
            if result == _TIMEOUT:
                self._gone_told = False
                if last:
                    return None
            elif result != _GONE:
                raise DisparityError(self._error())

    def heartbeat_age(self):
        """Returns the seconds since the daemon's last heartbeat; a huge number when it is gone."""
        return self._library.disparity_shared_memory_heartbeat_age_ns(self._reader) / 1e9

    def _error(self):
        return self._library.disparity_last_error().decode(errors="replace")

    def _copy(self):
        """Returns a copy of the library's frame: the next read overwrites the library's memory."""
        info = _Info()
        self._library.disparity_frame_get_info(self._frame, ctypes.byref(info), ctypes.sizeof(info))
        frame = Frame(**{name: getattr(info, name) for name, _ in C_FIELDS})
        for index in range(info.plane_count):
            plane = _Plane()
            if self._library.disparity_frame_plane_at(self._frame, index, ctypes.byref(plane)):
                data = np.empty(plane.bytes, np.uint8)
                ctypes.memmove(data.ctypes.data, plane.data, plane.bytes)
                frame.planes[plane.product] = plane_array(
                    plane.product, plane.width, plane.height, plane.bytes_per_pixel, data
                )
        return frame

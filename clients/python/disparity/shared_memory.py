# SPDX-License-Identifier: Apache-2.0
"""Reads frames over shared memory, through the C library libdisparity-client."""
from __future__ import annotations

import ctypes
import os
import pathlib
import time
import typing

import numpy as np

from .errors import DisparityError, Gone
from .frame import C_FIELDS, Frame, Plane, plane_array
from .frame_source import FrameSource
from .one_user import OneUser

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


def _open_library() -> ctypes.CDLL:
    """Loads $DISPARITY_CLIENT_LIBRARY, else the library beside the package, in its build tree or prefix, or of the system."""
    named = os.environ.get("DISPARITY_CLIENT_LIBRARY")
    if named:
        candidates = [named]
    else:
        here = pathlib.Path(__file__).resolve().parent
        beside = [here / LIBRARY, here.parent / LIBRARY, here.parent.parent / "lib" / LIBRARY]
        # PREFIX/lib/python3/dist-packages/disparity belongs to a library in PREFIX/lib, or in PREFIX/lib/x86_64-linux-gnu.
        prefix = here.parents[2]
        beside += [prefix / LIBRARY, *sorted(prefix.glob(f"*/{LIBRARY}"))]
        candidates = [str(path) for path in beside if path.exists()] + [LIBRARY]
    reasons = []
    for candidate in candidates:
        try:
            return ctypes.CDLL(candidate)
        except OSError as error:
            reasons.append(str(error))
    raise DisparityError(
        f"{LIBRARY} cannot be loaded ({'; '.join(reasons)}): install it (Debian: libdisparity-client0), or set "
        "DISPARITY_CLIENT_LIBRARY to its path"
    )


def _declare(library: ctypes.CDLL) -> ctypes.CDLL:
    pointer, integer, size = ctypes.c_void_p, ctypes.c_int, ctypes.c_size_t
    functions: tuple[tuple[str, typing.Any, list[typing.Any]], ...] = (
        ("disparity_last_error", ctypes.c_char_p, []),
        ("disparity_frame_new", pointer, []),
        ("disparity_frame_free", None, [pointer]),
        ("disparity_frame_get_info", None, [pointer, ctypes.POINTER(_Info), size]),
        ("disparity_frame_is_whole", integer, [pointer]),
        ("disparity_frame_plane_at", integer, [pointer, ctypes.c_uint32, ctypes.POINTER(_Plane)]),
        ("disparity_shared_memory_open_with", pointer, [ctypes.c_char_p, ctypes.c_char_p, integer]),
        ("disparity_shared_memory_close", None, [pointer]),
        (
            "disparity_shared_memory_read",
            integer,
            [pointer, pointer, integer, ctypes.POINTER(ctypes.c_uint32), size],
        ),
        ("disparity_shared_memory_borrow", integer, [pointer, pointer, integer]),
        ("disparity_shared_memory_heartbeat_age_ns", ctypes.c_int64, [pointer]),
    )
    for name, result, arguments in functions:
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

    def __init__(self, name: str = "default", owner: str | int | None = None, may_be_absent: bool = False) -> None:
        self._reader: int | None = None
        self._frame: int | None = None
        self._gone_told = may_be_absent
        self._user = OneUser("SharedMemoryReader", forks=True)
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

    def __del__(self) -> None:
        self.close()

    def close(self) -> None:
        if self._reader:
            self._library.disparity_shared_memory_close(self._reader)
        if self._frame:
            self._library.disparity_frame_free(self._frame)
        self._reader = self._frame = None

    def read(self, timeout: float | None = None, products: typing.Sequence[int] = ()) -> Frame | None:
        """Returns the newest frame not read before, or None when none came in time (timeout None = wait for ever).

        Raises Gone at once when the daemon has stopped, and within 3 s when it has died. The calls after that wait for
        a new daemon under the name, and raise Gone again when none has come in time. Only the given products are
        copied; without any, all are.
        """
        self._check_open()
        wanted = (ctypes.c_uint32 * len(products))(*products)
        with self._user:
            copied = self._wait(
                lambda wait_ms: self._library.disparity_shared_memory_read(
                    self._reader, self._frame, wait_ms, wanted, len(products)
                ),
                timeout,
            )
            return self._copy() if copied else None

    def borrow(self, timeout: float | None = None) -> Frame | None:
        """Does the same without a copy: the arrays of the frame lie in the shared memory and are read-only.

        The daemon never waits: the frame stays for one frame less than the ring has slots ([shared_memory] slots), then
        the daemon writes another one over it. So compute from the arrays, then ask frame.whole(), and use the result
        only if it is True. frame.copy() is a copy. The memory stays mapped as long as the frame or one of its arrays
        exists.
        """
        self._check_open()
        lent = _LentFrame(self._library)
        with self._user:
            borrowed = self._wait(
                lambda wait_ms: self._library.disparity_shared_memory_borrow(self._reader, lent.handle, wait_ms), timeout
            )
        return self._view(lent) if borrowed else None

    def _check_open(self) -> None:
        if not self._reader:
            raise ValueError("this reader is closed")

    def _wait(self, attempt: typing.Callable[[int], int], timeout: float | None) -> bool:
        """Calls attempt(milliseconds) until it has a frame (True) or the time is over (False); raises as read()."""
        deadline = None if timeout is None else time.monotonic() + timeout
        while True:
            left = _PATIENCE if deadline is None else (deadline - time.monotonic()) * 1000
            result = attempt(int(min(max(0, left), _PATIENCE)))
            last = left <= _PATIENCE and deadline is not None
            if result == _FRAME:
                self._gone_told = False
                return True
            if result == _GONE and (last or not self._gone_told):
                self._gone_told = True
                raise Gone(self._error())
            if result == _TIMEOUT:
                self._gone_told = False
                if last:
                    return False
            elif result != _GONE:
                raise DisparityError(self._error())

    def heartbeat_age(self) -> float:
        """Returns the seconds since the daemon's last heartbeat; a huge number when it is gone."""
        return self._library.disparity_shared_memory_heartbeat_age_ns(self._reader) / 1e9

    def _error(self) -> str:
        return self._library.disparity_last_error().decode(errors="replace")

    def _copy(self) -> Frame:
        """Returns a copy of the library's frame: the next read overwrites the library's memory."""
        frame, planes = self._describe(self._frame)
        for plane in planes:
            data = np.empty(plane.bytes, np.uint8)
            ctypes.memmove(data.ctypes.data, plane.data, plane.bytes)
            frame.planes[plane.product] = _array(plane, data)
        return frame

    def _view(self, lent: _LentFrame) -> Frame:
        """Returns the lent frame. Each array keeps its memory mapped."""
        frame, planes = self._describe(lent.handle)
        frame._is_whole = lent.is_whole
        for plane in planes:
            memory = (ctypes.c_uint8 * plane.bytes).from_address(plane.data)
            memory.lent = lent
            data = np.frombuffer(memory, np.uint8)
            data.flags.writeable = False
            frame.planes[plane.product] = _array(plane, data)
        return frame

    def _describe(self, handle: int | None) -> tuple[Frame, list[_Plane]]:
        """Returns a frame without planes, and the library's descriptions of its planes."""
        info = _Info()
        self._library.disparity_frame_get_info(handle, ctypes.byref(info), ctypes.sizeof(info))
        planes = [_Plane() for _ in range(info.plane_count)]
        for index, plane in enumerate(planes):
            self._library.disparity_frame_plane_at(handle, index, ctypes.byref(plane))
        return Frame(**{name: getattr(info, name) for name, _ in C_FIELDS}), planes


class _LentFrame:
    """A frame of the library, freed when nothing refers to it any more."""

    def __init__(self, library: ctypes.CDLL) -> None:
        self.handle: int | None = None
        self._library = library
        self.handle = library.disparity_frame_new()
        if not self.handle:
            raise MemoryError("no memory for a frame")

    def __del__(self) -> None:
        if self.handle:
            self._library.disparity_frame_free(self.handle)

    def is_whole(self) -> bool:
        return self._library.disparity_frame_is_whole(self.handle) == 1


def _array(plane: _Plane, data: Plane) -> Plane:
    return plane_array(plane.product, plane.width, plane.height, plane.bytes_per_pixel, data)

# SPDX-License-Identifier: Apache-2.0
"""The front door: one object for a daemon, however its frames come."""
from __future__ import annotations

import math
import time
import typing

from . import disparity_pb2 as pb
from .connection import ConnectOptions
from .errors import DisparityError, Gone, Refused
from .frame import Frame
from .frame_source import FrameSource
from .local_daemons import check_name, connect_to, open_memory_of, running_daemon
from .one_user import OneUser
from .shared_memory import SharedMemoryReader
from .socket_client import SocketClient
from .stream import deadline_after

# Passes between two looks for a daemon that is away, s: at its address, and by its name, which also touches the sockets of
# others.
_LOOK_INTERVAL, _LOOK_BY_NAME_INTERVAL = 0.1, 0.25
# A daemon that has refused is asked again after this time, s.
_PAUSE_AFTER_REFUSAL = 0.5
# A daemon has so long to answer, however little the caller wants to wait, s: a busy one would never be found again.
_LEAST_PATIENCE = 1.0


def _left(deadline: float) -> float:
    return max(0.0, deadline - time.monotonic())


class Client(FrameSource):
    """A daemon as a program sees it: frames over shared memory where there is one, else over a socket, and beside them
    the sensors and the status, always over a socket.

    `where`: "default" or another name, the daemon of this machine that has it; "", the daemon of this machine: that of
    the name "default", else the only one that runs; "unix:PATH", "/PATH", "tcp:HOST:PORT" or "tls:HOST:PORT", a socket.
    products, max_rate, region, compressed, sensors: as SocketClient.subscribe(). may_be_absent: no error without a
    daemon, read() waits for one. timeout: for a socket to answer, s. options: certificates and the token. owner: as of
    SharedMemoryReader.

    The newest frame counts, and a restart of the daemon is survived: the read that finds it gone raises Gone, and those
    after it look for it again, by its name and in both ways. Frames that came over the socket of a daemon go on over its
    shared memory as soon as that can be read. Where the library libdisparity-client is missing, all comes over the
    socket.

    Raises ValueError for arguments that are not allowed, DisparityError where no daemon answers, or where several run
    and none was named: the line names them. One thread at a time may use it, of the process that made it.
    """

    def __init__(
        self,
        where: str = "",
        products: typing.Sequence[int] = (pb.DISPARITY,),
        *,
        max_rate: float = 0.0,
        region: tuple[int, int, int, int] | None = None,
        compressed: bool = False,
        sensors: bool = False,
        may_be_absent: bool = False,
        client_name: str = "disparity-python",
        timeout: float = 5.0,
        options: ConnectOptions | None = None,
        owner: str | int | None = None,
    ) -> None:
        self._memory: SharedMemoryReader | None = None
        self._socket: SocketClient | None = None
        self._closed = self._open = self._asked_memory = False
        self._look_again = 0.0
        self._why: DisparityError | None = None
        self._user = OneUser("Client")
        self._client_name, self._timeout, self._options, self._owner = client_name, timeout, options, owner
        self._named = self._name = where
        is_address = where.startswith(("unix:", "tcp:", "tls:"))
        self._address = where if is_address else f"unix:{where}" if "/" in where else ""
        self._pause = _LOOK_INTERVAL if self._address else _LOOK_BY_NAME_INTERVAL
        if where and not self._address:
            check_name(where)
        self._want(products, max_rate, region, compressed, sensors)
        try:
            self._look(timeout)
        except DisparityError:
            if not may_be_absent:
                raise

    def close(self) -> None:
        self._lose()
        self._closed = True

    def subscribe(
        self,
        products: typing.Sequence[int] = (pb.DISPARITY,),
        max_rate: float = 0.0,
        region: tuple[int, int, int, int] | None = None,
        compressed: bool = False,
        sensors: bool = False,
    ) -> None:
        """Replaces what is wanted. A region is cut by the daemon, so such frames come over the socket."""
        with self._user:
            self._want(products, max_rate, region, compressed, sensors)
            if self._memory is not None and not self._memory_serves():
                self._drop_memory()  # the next read goes on over the socket
                self._open = False
            elif self._socket is not None:
                self._subscribe()

    def read(self, timeout: float | None = None) -> Frame | None:
        """Returns the newest frame that was not read before, or None when none came in time (timeout None = wait for
        ever); it takes up to a second more where a daemon is being connected to. The first one out of shared memory may
        be an old one: see its age. Raises Gone without a daemon; the calls after the first Gone look for it until their
        timeout. Raises DisparityError when the daemon refuses, as it does over the socket with a product that it does
        not make; a frame out of shared memory lacks that plane. read() may be called again, and then begins anew."""
        with self._user:
            deadline = deadline_after(timeout)
            self._find(deadline)
            try:
                return self._read_socket(deadline) if self._memory is None else self._read_memory(deadline)
            except Gone:
                if not self._address:
                    self._lose()  # it may come back elsewhere
                raise
            except DisparityError as error:
                self._lose()  # what a daemon refuses today it may grant tomorrow
                self._why, self._look_again = error, time.monotonic() + _PAUSE_AFTER_REFUSAL
                raise

    def read_sensors(self, timeout: float | None = None) -> pb.Sensors | None:
        """As SocketClient.read_sensors(), where sensors were wanted."""
        with self._user:
            deadline = deadline_after(timeout)
            self._find(deadline)
            try:
                beside = self._beside(deadline)
            except DisparityError as error:
                time.sleep(min(_left(deadline), self._pause))
                raise Gone(str(error)) from None
            try:
                return beside.read_sensors(_left(deadline))
            except Gone:
                if not self._address:
                    self._drop_socket()
                raise
            except DisparityError:
                self._drop_socket()
                raise

    def status(self, timeout: float = 5.0) -> pb.Status:
        """Returns the daemon's status: a disparity_pb2.Status."""
        with self._user:
            try:
                return self._beside(deadline_after(timeout)).status(timeout)
            except DisparityError:
                if self._memory is not None or not self._wanted["products"]:
                    self._drop_socket()  # the next call looks for it anew
                raise

    def socket(self) -> SocketClient:
        """Returns the connection for all other requests; makes it where there is none. It stays this object's: another
        call of it may end it, and subscribe() replaces what it has subscribed to."""
        with self._user:
            return self._beside(deadline_after(self._timeout))

    @property
    def where(self) -> str:
        """Where frames come from now, for people: "shared memory default", "tcp:HOST:PORT"; "" without a daemon."""
        if self._memory is not None:
            return f"shared memory {self._name}"
        return "" if not self._open else self._address or f"socket of {self._name}"

    def _want(
        self,
        products: typing.Sequence[int],
        max_rate: float,
        region: tuple[int, int, int, int] | None,
        compressed: bool,
        sensors: bool,
    ) -> None:
        if not 0 <= max_rate < math.inf:
            raise ValueError(f"max_rate: found {max_rate}, allowed: 0 (every frame) or more")
        self._wanted: dict[str, typing.Any] = {
            "products": tuple(products), "max_rate": max_rate, "region": region, "compressed": compressed,
            "sensors": sensors,
        }
        self._due = 0.0
        self._asked_memory = False

    def _memory_serves(self) -> bool:
        return bool(self._wanted["products"]) and self._wanted["region"] is None

    def _subscribe(self) -> None:
        """Tells the socket what to send: the frames only where they do not come over shared memory."""
        assert self._socket is not None
        self._socket.subscribe(**{**self._wanted, **({} if self._memory is None else {"products": ()})})

    def _look(self, timeout: float) -> None:
        """Looks for the daemon once. Raises DisparityError when there is none."""
        why = ""
        if not self._address:
            self._name = self._named or running_daemon(self._owner)
            self._asked_memory = False
            why = self._open_memory()
        try:
            if self._memory is None:
                self._open_socket(timeout)
        except DisparityError as error:
            if not why:
                raise
            raise DisparityError(f"{error} ({why})") from None
        self._open = True

    def _open_memory(self) -> str:
        """Takes the shared memory where all that is wanted can come out of it. Returns why it cannot."""
        if self._memory_serves():
            try:
                self._memory = open_memory_of(self._name, self._owner)
            except DisparityError as error:
                return str(error)
        return ""

    def _open_socket(self, timeout: float) -> SocketClient:
        if self._socket is None:
            if self._address:
                self._socket = SocketClient(self._address, self._client_name, timeout, self._options)
            else:
                self._socket = connect_to(self._name, self._client_name, self._options, self._owner, timeout)
        if self._wanted["sensors"] or (self._wanted["products"] and self._memory is None):
            self._subscribe()
        return self._socket

    def _beside(self, deadline: float) -> SocketClient:
        """Returns the socket, whatever way the frames take."""
        if not self._open:
            if self._closed:
                raise ValueError("this client is closed")
            self._look(max(_left(deadline), _LEAST_PATIENCE))
        return self._socket or self._open_socket(max(_left(deadline), _LEAST_PATIENCE))

    def _find(self, deadline: float) -> None:
        """Looks for a daemon until the deadline where there is none. Raises what refuses until then, or Gone."""
        while not self._open:
            if self._closed:
                raise ValueError("this client is closed")
            time.sleep(max(0.0, min(deadline, self._look_again) - time.monotonic()))
            if time.monotonic() < self._look_again:
                raise Gone(str(self._why))
            try:
                self._look(min(max(_left(deadline), _LEAST_PATIENCE), max(self._timeout, _LEAST_PATIENCE)))
                return
            except DisparityError as error:
                self._why = error
            except ValueError as error:  # a file that was right before
                self._why = Refused(str(error))
            self._look_again = time.monotonic() + self._pause
            if isinstance(self._why, Refused) and self._look_again >= deadline:
                raise self._why

    def _read_memory(self, deadline: float) -> Frame | None:
        assert self._memory is not None
        # max_rate, as the daemon keeps it over the socket: a little early is on time.
        interval = 1 / max(self._wanted["max_rate"], 1e-6) if self._wanted["max_rate"] else 0.0
        due = self._due - interval / 20
        time.sleep(max(0.0, min(deadline, due) - time.monotonic()))
        if time.monotonic() < due:
            return None
        frame = self._memory.read(_left(deadline), self._wanted["products"])
        if frame is not None:
            now = time.monotonic()
            self._due = (self._due if self._due + interval > now else now) + interval
        return frame

    def _read_socket(self, deadline: float) -> Frame | None:
        assert self._socket is not None
        frame = self._socket.read(_left(deadline))
        # A daemon that publishes has its shared memory, if it has one at all.
        if frame is not None and not self._address and not self._asked_memory:
            self._asked_memory = True
            return self._go_on_over_memory(frame)
        return frame

    def _go_on_over_memory(self, frame: Frame) -> Frame:
        """Takes the shared memory where it has this frame of the socket, or a newer one, which is returned instead."""
        self._open_memory()
        newest = None
        if self._memory is not None:
            try:
                newest = self._memory.read(0, self._wanted["products"])
            except DisparityError:
                pass
        if newest is None or newest.publish_index < frame.publish_index:
            self._drop_memory()
            return frame
        newest.skipped = frame.skipped + newest.publish_index - frame.publish_index
        self._subscribe()
        return newest

    def _drop_memory(self) -> None:
        if self._memory is not None:
            self._memory.close()
        self._memory = None

    def _drop_socket(self) -> None:
        if self._socket is not None:
            self._socket.close()
        self._socket = None
        self._open = self._memory is not None

    def _lose(self) -> None:
        self._drop_memory()
        self._drop_socket()


# The front door has this name in C++ and C, too.
connect = Client

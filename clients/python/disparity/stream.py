# SPDX-License-Identifier: Apache-2.0
"""Sends and receives whole messages over a socket: u32 length (little endian) | Envelope | payload."""
from __future__ import annotations

import socket
import ssl
import struct
import time
import typing
import unicodedata

from google.protobuf.message import DecodeError

from . import disparity_pb2 as pb
from .connection import LONGEST_WAIT, ConnectOptions, connect, token_for
from .errors import DisparityError, Gone, Refused

# docs/protocol.md has these limits.
MAX_ENVELOPE_BYTES = 1 << 20
MAX_PAYLOAD_BYTES = 512 << 20
MAX_IMAGE_SIDE = 16384
MAX_BYTES_PER_PIXEL = 8

# The buffer grows by this much at a time, beyond the bytes that have arrived.
_GROWTH = 1 << 20

# An Envelope and its payload.
Message = typing.Tuple[pb.Envelope, bytearray]


def printable(text: str) -> str:
    """Returns a text of the daemon as one line. Control characters become "?": they could move a terminal's cursor."""
    return "".join("?" if unicodedata.category(c) == "Cc" else c for c in text)


def deadline_after(timeout: float | None) -> float:
    """Returns now plus the timeout, by time.monotonic(). None, or more than a clock can hold, is LONGEST_WAIT."""
    return time.monotonic() + min(max(0, LONGEST_WAIT if timeout is None else timeout), LONGEST_WAIT)


def raw_bytes(plane: pb.PlaneInfo) -> int:
    """Returns the bytes of a plane before compression; ValueError when a size is outside the limits."""
    for name, value, most in (
        ("width", plane.width, MAX_IMAGE_SIDE),
        ("height", plane.height, MAX_IMAGE_SIDE),
        ("bytes_per_pixel", plane.bytes_per_pixel, MAX_BYTES_PER_PIXEL),
    ):
        if not 1 <= value <= most:
            raise ValueError(f"plane with {name} {value}, allowed 1..{most}")
    return plane.width * plane.height * plane.bytes_per_pixel


def check_payload(envelope: pb.Envelope) -> None:
    """Raises ValueError when the payload cannot be what the Envelope says."""
    if envelope.payload_bytes > MAX_PAYLOAD_BYTES:
        raise ValueError(f"payload of {envelope.payload_bytes} bytes announced, allowed {MAX_PAYLOAD_BYTES}")
    if not envelope.HasField("frame"):
        return
    announced = raw_total = 0
    for plane in envelope.frame.planes:
        raw = raw_bytes(plane)
        if plane.encoding not in (pb.RAW, pb.ZSTD):
            raise ValueError(f"plane with unknown encoding {plane.encoding}")
        # zstd adds at most 1/256 and a little to what it cannot compress.
        most = raw if plane.encoding == pb.RAW else raw + raw // 256 + 1024
        if plane.payload_bytes > most or (plane.encoding == pb.RAW and plane.payload_bytes != raw):
            raise ValueError(f"plane of {plane.width} x {plane.height} pixels with {plane.payload_bytes} payload bytes")
        announced += plane.payload_bytes
        raw_total += raw
    if announced != envelope.payload_bytes or raw_total > MAX_PAYLOAD_BYTES:
        raise ValueError(f"planes of {announced} bytes in a payload of {envelope.payload_bytes}")


class MessageStream:
    """Sends and receives messages over one connection. It keeps a part of a message over a timeout."""

    def __init__(self, address: str, timeout: float, options: ConnectOptions | None = None) -> None:
        self.address = address
        self._socket = connect(address, timeout, options)
        try:
            self.token = token_for(address, self._socket, options)
        except BaseException:
            self._socket.close()
            raise
        self._part = "length"
        self._wanted = 4
        self._buffer = bytearray(4)
        self._filled = 0
        self._envelope = pb.Envelope()
        # When the last bytes were read, and when there were none to read; of time.monotonic_ns().
        self.heard = self.empty = time.monotonic_ns()
        self._sends = True  # False: a message was cut off, and nothing can follow it

    def close(self) -> None:
        self._socket.close()

    def server_user(self) -> int | None:
        """Returns the user id of the process behind a Unix socket; None over TCP."""
        if self._socket.family != socket.AF_UNIX:
            return None
        _, user, _ = struct.unpack("3i", self._socket.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, 12))
        return user

    def send(self, envelope: pb.Envelope, timeout: float) -> None:
        try:
            self._send_all(envelope, timeout)
        except OSError as error:
            # A part of the message may have been sent: nothing can follow it.
            self._report_last_words()
            self.close()
            raise Gone(f"disparityd at {self.address}: the connection has ended: {error}") from None

    def try_to_send(self, envelope: pb.Envelope, timeout: float) -> None:
        """As send(), for what nobody waits for. Where it fails, receive() still gives what came before the end."""
        try:
            self._send_all(envelope, timeout)
        except OSError:
            self._sends = False

    def _send_all(self, envelope: pb.Envelope, timeout: float) -> None:
        if not self._sends:
            raise BrokenPipeError("it takes nothing any more")
        body = envelope.SerializeToString()
        self._socket.settimeout(min(timeout, LONGEST_WAIT))
        self._socket.sendall(struct.pack("<I", len(body)) + body)

    def receive(self, deadline: float) -> Message | None:
        """Returns (Envelope, payload as bytearray), or None when the time (of time.monotonic) is up. Raises Gone when
        the connection has ended, Refused with the daemon's message, DisparityError when it breaks the protocol."""
        while True:
            if not self._fill(deadline):
                return None
            data, self._filled = self._buffer, 0
            try:
                message = self._take(data)
            except (ValueError, DecodeError) as error:
                self.close()
                raise DisparityError(f"disparityd at {self.address}: broke the protocol: {error}") from None
            if message is not None:
                if message[0].HasField("error"):
                    told = message[0].error
                    raise Refused(f"disparityd at {self.address}: {printable(told.message)}", told.closing)
                return message

    def _take(self, data: bytearray) -> Message | None:
        """Takes a part that has arrived. Returns the message if it was the last part."""
        if self._part == "length":
            (self._wanted,) = struct.unpack("<I", data)
            if self._wanted > MAX_ENVELOPE_BYTES:
                raise ValueError(
                    f"message of {self._wanted} bytes announced, allowed {MAX_ENVELOPE_BYTES}: not the disparityd "
                    "protocol, or another version of it"
                )
            self._part = "envelope"
        elif self._part == "envelope":
            self._envelope = pb.Envelope.FromString(bytes(data))
            check_payload(self._envelope)
            self._part, self._wanted = "payload", self._envelope.payload_bytes
        else:
            self._part, self._wanted = "length", 4
            self._buffer = bytearray()
            return self._envelope, data
        self._buffer = bytearray()
        return None

    def _fill(self, deadline: float) -> bool:
        while self._filled < self._wanted:
            if len(self._buffer) == self._filled:
                room = min(self._wanted, self._filled + max(self._filled, _GROWTH))
                self._buffer.extend(bytes(room - self._filled))
            with memoryview(self._buffer) as view:
                received = self._receive_into(view[self._filled : min(len(view), self._wanted)], deadline)
            if received is None:
                return False
            self._filled += received
        return True

    def _receive_into(self, view: memoryview, deadline: float) -> int | None:
        """Returns how many bytes came, or None at the deadline. Bytes that are there are read even after it."""
        received: int | None = None
        try:
            for timeout in (0.0, deadline - time.monotonic()):
                if timeout < 0 or received is not None:
                    break
                self._socket.settimeout(timeout)
                received = self._receive_once(view)
            if received is None:
                return None
        except OSError as error:
            raise Gone(f"disparityd at {self.address}: the connection has ended: {error}") from None
        finally:
            view.release()
        if received == 0:
            raise Gone(f"disparityd at {self.address}: the connection has ended")
        self.heard = time.monotonic_ns()
        return received

    def _receive_once(self, view: memoryview) -> int | None:
        """Returns how many bytes came, or None when none came in the socket's time."""
        try:
            return self._socket.recv_into(view)
        except (BlockingIOError, TimeoutError, socket.timeout, ssl.SSLWantReadError, ssl.SSLWantWriteError):
            self.empty = time.monotonic_ns()
            return None

    def _report_last_words(self) -> None:
        """Raises Refused if the daemon's Error arrived before the connection ended."""
        try:
            while self.receive(time.monotonic()) is not None:
                pass
        except Gone:
            pass

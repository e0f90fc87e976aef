# SPDX-License-Identifier: Apache-2.0
"""Reads frames and status over a socket, in pure Python (numpy and protobuf; zstandard for compressed frames)."""
from __future__ import annotations

import collections
import os
import time
import typing

from . import disparity_pb2 as pb
from .connection import ConnectOptions
from .errors import DisparityError, Gone, Refused
from .frame import DISPARITY, Bytes, Frame, frame_of_message, plane_array, product_name
from .frame_source import FrameSource
from .stream import Message, MessageStream, deadline_after, raw_bytes

if typing.TYPE_CHECKING:
    import zstandard

PROTOCOL_VERSION = 1

# So many frames are kept while a request waits for its answer.
_MOST_PENDING = 8

# The daemon must answer the Hello of a new connection in the first time. The second passes between two attempts. An
# attempt may take the third at least, whatever the caller's timeout.
_HELLO_TIMEOUT = 5.0
_RECONNECT_INTERVAL = 0.1
_LEAST_PATIENCE = 0.05

# So many messages with samples of the sensors are kept while frames are read.
_MOST_SENSORS = 256


class SocketClient(FrameSource):
    """Connects to "unix:PATH", "tcp:HOST:PORT" or, encrypted, "tls:HOST:PORT". One thread at a time may use it.

    Over "tls:" the daemon's certificate is always checked; the options say by which authority, and what the daemon may ask
    of the client. A token is sent over "tls:", and over "tcp:" only to this machine.

    Times are in seconds. Raises ValueError for an address of another form and for files that cannot be used,
    DisparityError when the daemon cannot be reached, is not who it should be, or refuses.

    When the connection ends, the first read() or read_sensors() after it raises Gone. The calls after that connect
    again, send Hello and subscribe as before. They raise Gone again when no daemon answers in time, Refused when it
    refuses until then. Requests connect again, too.
    """

    def __init__(
        self,
        address: str,
        client_name: str = "disparity-python",
        timeout: float = 5.0,
        options: ConnectOptions | None = None,
    ) -> None:
        self._pending: collections.deque[Frame] = collections.deque(maxlen=_MOST_PENDING)
        self._last_index: int | None = None
        self._decompress: zstandard.ZstdDecompressor | None = None
        self._sensors: collections.deque[pb.Sensors] = collections.deque()
        self._sensors_dropped = 0
        self.last_status: pb.Status | None = None  # the newest status message that came unasked
        self.welcome: pb.Welcome | None = None
        self._address, self._name, self._options = address, client_name, options
        self._subscription: pb.Envelope | None = None
        self._stream: MessageStream | None = None
        self._closed = False
        self._lost = False  # the connection has ended; a new _stream has no answer to Hello yet
        try:
            deadline = deadline_after(timeout)
            self._connect(timeout, deadline)
            if not self._greeted(deadline):
                raise DisparityError(f"disparityd at {address}: no answer to hello in time")
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        self._closed = True
        self._drop()

    def subscribe(
        self,
        products: typing.Sequence[int] = (DISPARITY,),
        max_rate: float = 0.0,
        region: tuple[int, int, int, int] | None = None,
        compressed: bool = False,
        status_interval: float = 0.0,
        sensors: bool = False,
    ) -> None:
        """Replaces the subscription. region = (x, y, width, height); sensors: for read_sensors(). The next read()
        raises Refused when the daemon refuses. When the connection has ended, the subscription holds from the next one
        on."""
        if compressed and self._decompress is None:
            import zstandard  # only needed for this

            self._decompress = zstandard.ZstdDecompressor()
        message = pb.Subscribe(
            max_rate=max_rate,
            encoding=pb.ZSTD if compressed else pb.RAW,
            status_interval_s=status_interval,
            sensors=sensors,
        )
        message.products.extend(products)
        if region is not None:
            message.region.x, message.region.y, message.region.width, message.region.height = region
        self._subscription = pb.Envelope(subscribe=message)
        if not self._lost:
            self._send_subscription()

    def read(self, timeout: float | None = None) -> Frame | None:
        """Returns the next frame, or None when none came in time (timeout None = wait for ever)."""
        if self._pending:
            return self._count_missed(self._pending.popleft())
        deadline = deadline_after(timeout)
        while True:
            message = self._receive(deadline)
            if message is None:
                return None
            if message[0].HasField("frame"):
                return self._count_missed(self._frame(*message))
            self._keep(*message)

    def read_sensors(self, timeout: float | None = None) -> pb.Sensors | None:
        """Returns samples of the camera's sensors: a disparity_pb2.Sensors, or None when none came in time (timeout
        None = wait for ever). The newest 8 frames that come meanwhile are kept for read()."""
        deadline = deadline_after(timeout)
        while not self._sensors:
            message = self._receive(deadline)
            if message is None:
                return None
            self._keep(*message)
        sensors = self._sensors.popleft()
        sensors.skipped_for_client += self._sensors_dropped
        self._sensors_dropped = 0
        return sensors

    def status(self, timeout: float = 5.0) -> pb.Status:
        """Returns the daemon's status: a disparity_pb2.Status."""
        return self._ask(pb.Envelope(status_request=pb.StatusRequest()), "status", "a status request", timeout)

    def start_recording(self, path: str | os.PathLike[str], timeout: float = 5.0) -> pb.RecordStatus:
        """Starts a recording on the daemon's machine and returns a disparity_pb2.RecordStatus."""
        request = pb.Envelope(record_start=pb.RecordStart(path=str(path)))
        return self._ask(request, "record_status", "a recording request", timeout)

    def stop_recording(self, timeout: float = 5.0) -> pb.RecordStatus:
        """Stops the recording that runs and returns a disparity_pb2.RecordStatus."""
        request = pb.Envelope(record_stop=pb.RecordStop())
        return self._ask(request, "record_status", "a recording request", timeout)

    def control_camera(
        self, settings: typing.Mapping[str, int] | None = None, timeout: float = 5.0
    ) -> pb.CameraControls:
        """Sets controls of the daemon's live camera, {name: value} (none: only asks). Returns a
        disparity_pb2.CameraControls."""
        wanted = [pb.CameraSetting(name=name, value=value) for name, value in (settings or {}).items()]
        request = pb.Envelope(camera_request=pb.CameraRequest(settings=wanted))
        return self._ask(request, "camera_controls", "a camera request", timeout)

    def trace(self, seconds: float = 3.0, timeout: float = 5.0) -> pb.Trace:
        """Has the daemon record what its threads do in the next seconds (0.1 to 10), waits for that and returns a
        disparity_pb2.Trace. The timeout counts from the end of that time."""
        question, patience = "a trace request", min(max(seconds, 0.0), 10.0) + timeout
        deadline = deadline_after(patience)
        trace = pb.Trace()
        part = self._ask(pb.Envelope(trace_request=pb.TraceRequest(seconds=seconds)), "trace", question, patience)
        trace.MergeFrom(part)
        while not part.last:
            part = self._wait_for("trace", question, deadline)
            trace.MergeFrom(part)
        return trace

    def _drop(self) -> None:
        if self._stream is not None:
            self._stream.close()
        self._stream = None
        self._lost = True

    def _open_stream(self) -> MessageStream:
        """Returns the stream of a connection that is open or waits for the answer to Hello."""
        assert self._stream is not None
        return self._stream

    def _connect(self, timeout: float, greeting: float) -> None:
        """Opens another connection and sends Hello. The daemon must answer until `greeting`."""
        self._stream = MessageStream(self._address, timeout, self._options)
        self._greeting = greeting
        hello = pb.Envelope(
            hello=pb.Hello(protocol_version=PROTOCOL_VERSION, client_name=self._name, token=self._stream.token)
        )
        self._stream.send(hello, timeout)

    def _greeted(self, deadline: float) -> bool:
        """Waits for the answer to Hello. Returns False when it has not come in time and may still come."""
        while True:
            message = self._open_stream().receive(min(deadline, self._greeting))
            if message is None:
                if time.monotonic() >= self._greeting:
                    raise DisparityError(f"disparityd at {self._address}: no answer to hello in time")
                return False
            if message[0].HasField("welcome"):
                break
            self._keep(*message)
        version = message[0].welcome.protocol_version
        if version != PROTOCOL_VERSION:
            raise Refused(
                f"disparityd at {self._address}: it speaks version {version} of the protocol, this program version "
                f"{PROTOCOL_VERSION}: use the client that came with the daemon"
            )
        self.welcome = message[0].welcome
        return True

    def _come_back(self, deadline: float) -> None:
        """Connects again and subscribes as before. Raises Gone when no daemon has answered by the deadline; the next
        call continues. Raises Refused when the daemon refuses until then."""
        if self._closed:
            raise ValueError("this client is closed")
        reason: DisparityError | None = None
        while True:
            try:
                if self._stream is None:
                    patience = min(max(_LEAST_PATIENCE, deadline - time.monotonic()), _HELLO_TIMEOUT)
                    self._connect(patience, deadline_after(_HELLO_TIMEOUT))
                if self._greeted(deadline):
                    self._lost = False
                    self._send_subscription()
                    return
                break
            except DisparityError as error:
                self._drop()
                reason = error
            except ValueError as error:  # a file that was right before
                self._drop()
                reason = Refused(str(error))
            left = deadline - time.monotonic()
            time.sleep(min(max(0.0, left), _RECONNECT_INTERVAL))
            if left <= _RECONNECT_INTERVAL:
                break
        if isinstance(reason, Refused):
            raise reason
        raise Gone(str(reason or f"disparityd at {self._address}: no answer to hello yet"))

    def _send_subscription(self) -> None:
        """Sends the subscription. Where that fails, the next read reports why, or sends it over another connection."""
        if self._subscription is not None:
            try:
                self._open_stream().send(self._subscription, 5.0)
            except Gone:
                self._drop()

    def _receive(self, deadline: float) -> Message | None:
        """Returns the next message, over another connection when the one before has ended; None when the time is up."""
        if self._lost:
            self._come_back(deadline)
        try:
            return self._open_stream().receive(deadline)
        except Gone:
            self._drop()
            raise

    def _ask(self, request: pb.Envelope, answer: str, question: str, timeout: float) -> typing.Any:
        deadline = deadline_after(timeout)
        # Messages that arrived before the request cannot be its answer.
        try:
            message = None if self._lost else self._receive(time.monotonic())
            while message is not None and time.monotonic() < deadline:
                self._keep(*message)
                message = self._receive(time.monotonic())
        except Gone:
            pass
        except Refused as error:
            # The daemon closes a connection after a long time without requests: its Error is no answer.
            if not error.closing:
                raise
            self._drop()
        if self._lost:
            self._come_back(deadline)
        try:
            self._open_stream().send(request, timeout)
        except Gone:
            self._drop()
            raise
        return self._wait_for(answer, question, deadline)

    def _wait_for(self, answer: str, question: str, deadline: float) -> typing.Any:
        while True:
            message = self._receive(deadline)
            if message is None:
                raise DisparityError(f"disparityd at {self._address}: no answer to {question} in time")
            if message[0].HasField(answer):
                return getattr(message[0], answer)
            self._keep(*message)

    def _keep(self, envelope: pb.Envelope, payload: bytearray) -> None:
        if envelope.HasField("frame"):
            self._pending.append(self._frame(envelope, payload))
        elif envelope.HasField("status"):
            self.last_status = envelope.status
        elif envelope.HasField("sensors"):
            self._sensors.append(envelope.sensors)
            if len(self._sensors) > _MOST_SENSORS:
                oldest = self._sensors.popleft()
                self._sensors_dropped += oldest.skipped_for_client + len(oldest.samples)

    def _count_missed(self, frame: Frame) -> Frame:
        if self._last_index is not None and frame.publish_index > self._last_index:
            frame.missed = frame.publish_index - self._last_index - 1
        self._last_index = frame.publish_index
        return frame

    def _frame(self, envelope: pb.Envelope, payload: bytearray) -> Frame:
        message = envelope.frame
        frame = frame_of_message(message)
        offset = 0
        for plane in message.planes:
            data = memoryview(payload)[offset : offset + plane.payload_bytes]
            offset += plane.payload_bytes
            if plane.encoding == pb.ZSTD:
                data = self._unpack(plane, data)
            frame.planes[plane.product] = plane_array(
                plane.product, plane.width, plane.height, plane.bytes_per_pixel, data
            )
        return frame

    def _unpack(self, plane: pb.PlaneInfo, data: memoryview) -> memoryview:
        """Returns one plane decompressed. It never writes more bytes than the plane has."""
        if self._decompress is None:
            raise DisparityError("the daemon sent a compressed frame that nobody asked for")
        wanted = raw_bytes(plane)
        reader = self._decompress.stream_reader(data)
        out = bytearray(wanted + 1)
        filled = 0
        try:
            while filled < len(out):
                got = reader.readinto(memoryview(out)[filled:])
                if got == 0:
                    break
                filled += got
        except Exception as error:  # zstandard's own class, which this module does not import
            raise DisparityError(f"compressed plane of {product_name(plane.product)} is damaged: {error}") from None
        if filled != wanted:
            raise DisparityError(
                f"compressed plane of {product_name(plane.product)} is damaged: {filled} of {wanted} bytes"
            )
        return memoryview(out)[:wanted]

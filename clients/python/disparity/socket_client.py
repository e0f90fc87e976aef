# SPDX-License-Identifier: Apache-2.0
"""Frames and status over a socket, in pure Python (numpy and protobuf; zstandard for compressed frames)."""
import collections
import time

from . import disparity_pb2 as pb
from .errors import DisparityError
from .frame import DISPARITY, Frame, plane_array
from .frame_source import FrameSource
from .stream import MessageStream, deadline_after, raw_bytes

PROTOCOL_VERSION = 1

# Frames kept while a question waits for its answer.
_MOST_PENDING = 8

# Messages with samples of the sensors kept while frames are read.
_MOST_SENSORS = 256


class SocketClient(FrameSource):
    """One connection to "tcp:HOST:PORT" or "unix:PATH". Not for several threads at once.

    Times are in seconds. Raises ValueError for an address that is none, DisparityError when the daemon cannot be
    reached or refuses, Gone when the connection has ended.
    """

    def __init__(self, address, client_name="disparity-python", timeout=5.0):
        self._pending = collections.deque(maxlen=_MOST_PENDING)
        self._last_index = None
        self._decompress = None
        self._sensors = collections.deque()
        self._sensors_dropped = 0
        self.last_status = None  # newest status message that came by itself
        self._stream = MessageStream(address, timeout)
        try:
            deadline = deadline_after(timeout)
            hello = pb.Envelope(hello=pb.Hello(protocol_version=PROTOCOL_VERSION, client_name=client_name))
            self._stream.send(hello, timeout)
            self.welcome = self._wait_for("welcome", "hello", deadline)
            if self.welcome.protocol_version != PROTOCOL_VERSION:
                raise DisparityError(
                    f"disparityd at {address}: it speaks version {self.welcome.protocol_version} of the protocol, this "
                    f"program version {PROTOCOL_VERSION}: use the client that came with the daemon"
                )
        except BaseException:
            self.close()
            raise

    def close(self):
        self._stream.close()

    def subscribe(
        self, products=(DISPARITY,), max_rate=0.0, region=None, compressed=False, status_interval=0.0, sensors=False
    ):
        """Replaces the subscription. region = (x, y, width, height); sensors: for read_sensors(). A refusal comes out
        of the next read()."""
        if compressed and self._decompress is None:
            import zstandard  # only needed for this

            self._decompress = zstandard.ZstdDecompressor()
        message = pb.Subscribe(
            products=products,
            max_rate=max_rate,
            encoding=pb.ZSTD if compressed else pb.RAW,
            status_interval_s=status_interval,
            sensors=sensors,
        )
        if region is not None:
            message.region.x, message.region.y, message.region.width, message.region.height = region
        self._stream.send(pb.Envelope(subscribe=message), 5.0)

    def read(self, timeout=None):
        """The next frame, or None when none came in time (None = wait for ever)."""
        if self._pending:
            return self._count_missed(self._pending.popleft())
        deadline = deadline_after(timeout)
        while True:
            message = self._stream.receive(deadline)
            if message is None:
                return None
            if message[0].HasField("frame"):
                return self._count_missed(self._frame(*message))
            self._keep(*message)

    def read_sensors(self, timeout=None):
        """Samples of the camera's sensors: a disparity_pb2.Sensors, or None when none came in time (None = wait for
        ever). Frames that come meanwhile are kept for read(), 8 of them."""
        deadline = deadline_after(timeout)
        while not self._sensors:
            message = self._stream.receive(deadline)
            if message is None:
                return None
            self._keep(*message)
        sensors = self._sensors.popleft()
        sensors.skipped_for_client += self._sensors_dropped
        self._sensors_dropped = 0
        return sensors

    def status(self, timeout=5.0):
        """Asks for the daemon's status: a disparity_pb2.Status."""
        return self._ask(pb.Envelope(status_request=pb.StatusRequest()), "status", "a status request", timeout)

    def start_recording(self, path, timeout=5.0):
        """Starts a recording on the daemon's machine: a disparity_pb2.RecordStatus."""
        request = pb.Envelope(record_start=pb.RecordStart(path=str(path)))
        return self._ask(request, "record_status", "a recording request", timeout)

    def stop_recording(self, timeout=5.0):
        request = pb.Envelope(record_stop=pb.RecordStop())
        return self._ask(request, "record_status", "a recording request", timeout)

    def control_camera(self, settings=None, timeout=5.0):
        """Sets controls of the daemon's live camera, {name: value} (none: only asks): a disparity_pb2.CameraControls."""
        wanted = [pb.CameraSetting(name=name, value=value) for name, value in (settings or {}).items()]
        request = pb.Envelope(camera_request=pb.CameraRequest(settings=wanted))
        return self._ask(request, "camera_controls", "a camera request", timeout)

    def _ask(self, request, answer, question, timeout):
        deadline = deadline_after(timeout)
        # What has arrived before the question cannot be its answer.
        message = self._stream.receive(time.monotonic())
        while message is not None and time.monotonic() < deadline:
            self._keep(*message)
            message = self._stream.receive(time.monotonic())
        self._stream.send(request, timeout)
        return self._wait_for(answer, question, deadline)

    def _wait_for(self, answer, question, deadline):
        while True:
            message = self._stream.receive(deadline)
            if message is None:
                raise DisparityError(f"disparityd at {self._stream.address}: no answer to {question} in time")
            if message[0].HasField(answer):
                return getattr(message[0], answer)
            self._keep(*message)

    def _keep(self, envelope, payload):
        if envelope.HasField("frame"):
            self._pending.append(self._frame(envelope, payload))
        elif envelope.HasField("status"):
            self.last_status = envelope.status
        elif envelope.HasField("sensors"):
            self._sensors.append(envelope.sensors)
            if len(self._sensors) > _MOST_SENSORS:
                oldest = self._sensors.popleft()
                self._sensors_dropped += oldest.skipped_for_client + len(oldest.samples)

    def _count_missed(self, frame):
        if self._last_index is not None and frame.publish_index > self._last_index:
            frame.missed = frame.publish_index - self._last_index - 1
        self._last_index = frame.publish_index
        return frame

    def _frame(self, envelope, payload):
        message = envelope.frame
        geometry = message.geometry
        frame = Frame(region_x=message.region.x, region_y=message.region.y)
        for name in ("publish_index", "sequence", "monotonic_ns", "realtime_ns", "age_ns", "dropped_before", "flags"):
            setattr(frame, name, getattr(message, name))
        for name in ("calibration_id", "f", "cx", "cy", "baseline_mm", "disparity_offset", "d_min", "disparities"):
            setattr(frame, name, getattr(geometry, name))
        frame.invalid, frame.width, frame.height = geometry.invalid, geometry.width, geometry.height
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

    def _unpack(self, plane, data):
        """Decompresses one plane, never more than it has bytes."""
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
            raise DisparityError(f"compressed plane of product {plane.product} is damaged: {error}") from None
        if filled != wanted:
            raise DisparityError(f"compressed plane of product {plane.product} is damaged: {filled} of {wanted} bytes")
        return memoryview(out)[:wanted]

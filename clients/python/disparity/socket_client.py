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
from .frame import Frame
from .frame_decoder import FrameDecoder
from .frame_flow import Arrival, DaemonClock, FrameFlow
from .frame_source import FrameSource
from .liveness import Liveness
from .one_user import OneUser
from .stream import Message, MessageStream, deadline_after

PROTOCOL_VERSION = 2

# So many frames of a daemon without credit are kept while a request waits for its answer; of others the newest one.
_MOST_PENDING = 8
# What came while the program worked is at most that many messages, or the daemon sends without end.
_MOST_AT_ONCE = 1000

# An attempt to connect again takes the first time at most, so that the first one after a link is back succeeds: the
# system repeats its packets ever more seldom. The daemon must answer Hello in the second; it tells a wrong token after
# a second. The third passes between two attempts. An attempt may take the fourth at least, whatever the caller's
# timeout.
_CONNECT_TIMEOUT, _TLS_TIMEOUT = 1.0, 2.0
_HELLO_TIMEOUT = 2.5
_RECONNECT_INTERVAL = 0.1
_LEAST_PATIENCE = 0.05
_NO_ANSWER = "no answer to hello in time: the daemon hangs, or another program listens there"
# A read that waits looks at the socket at least this often.
_LOOK_INTERVAL = 0.05
# A few bytes that cannot be sent for so long: the connection is of no more use.
_SEND_TIMEOUT = 1.0

# So many messages with samples of the sensors are kept while frames are read.
_MOST_SENSORS = 256


class SocketClient(FrameSource):
    """Connects to "unix:PATH", "tcp:HOST:PORT" or, encrypted, "tls:HOST:PORT". One thread at a time may use it, of the
    process that made it.

    A program reads the newest frame, however long it works on each: the client orders frames by reading. One that works
    longer than an interval misses those in between (Frame.skipped) and is given none that grew old meanwhile. Frame.age_ns
    counts until the program gets the frame. Of a daemon on another machine it may be more than the true age, by no more
    than the shortest way there that was seen; it is never less. An older daemon knows no orders: its frames come one
    after the other.

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
        self._user = OneUser("SocketClient")
        # With when the socket was last seen empty before each.
        self._pending: collections.deque[tuple[Message, int]] = collections.deque(maxlen=_MOST_PENDING)
        self._last_index: int | None = None
        self._decoder = FrameDecoder()
        self._sensors: collections.deque[pb.Sensors] = collections.deque()
        self._sensors_dropped = 0
        self.last_status: pb.Status | None = None  # the newest status message that came unasked
        self.welcome: pb.Welcome | None = None
        self._address, self._name, self._options = address, client_name, options
        self._subscription: pb.Envelope | None = None
        self._stream: MessageStream | None = None
        self._closed = False
        self._lost = False  # the connection has ended; a new _stream has no answer to Hello yet
        self._later: DisparityError | None = None  # to be raised when the program has got what came before
        self._id = int.from_bytes(os.urandom(8), "little") | 1
        self._clock: DaemonClock | None = None  # of this connection; None: its daemon knows no credit
        self._flow = FrameFlow()
        self._liveness = Liveness()
        try:
            deadline = deadline_after(timeout)
            self._connect(timeout, deadline)
            if not self._greeted(deadline):
                raise DisparityError(f"disparityd at {address}: {_NO_ANSWER}")
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        self._closed = True
        self._drop()

    def server_user(self) -> int | None:
        """Returns the user id of the process that listens at a Unix socket, as the system knows it; None over TCP."""
        return None if self._stream is None else self._stream.server_user()

    def subscribe(
        self,
        products: typing.Sequence[int] = (pb.DISPARITY,),
        max_rate: float = 0.0,
        region: tuple[int, int, int, int] | None = None,
        compressed: bool = False,
        status_interval: float = 0.0,
        sensors: bool = False,
    ) -> None:
        """Replaces the subscription. region = (x, y, width, height); sensors: for read_sensors(). The next read()
        raises Refused when the daemon refuses. When the connection has ended, the subscription holds from the next one
        on."""
        if compressed:
            self._decoder.expect_compressed()
        message = pb.Subscribe(
            max_rate=max_rate,
            encoding=pb.ZSTD if compressed else pb.RAW,
            status_interval_s=status_interval,
            sensors=sensors,
        )
        message.products.extend(products)
        if region is not None:
            message.region.x, message.region.y, message.region.width, message.region.height = region
        with self._user:
            self._subscription = pb.Envelope(subscribe=message)
            if not self._lost:
                self._send_subscription()

    def read(self, timeout: float | None = None) -> Frame | None:
        """Returns the newest frame that was not read before, or None when none came in time (timeout None = wait for
        ever). A frame that has lain for more than an interval while the program worked is left out, counts as skipped, and
        a fresh one is asked for; that may take a little longer than the timeout."""
        with self._user:
            self._flow.reads(time.monotonic_ns())
            deadline, refused = deadline_after(timeout), False
            while True:
                self._take_in()
                came = len(self._pending) > 0
                frame = self._next_frame()
                if frame is not None:
                    return self._count_missed(frame)
                if came and not refused:  # the daemon has the time to send a fresh one
                    refused = True
                    deadline = max(deadline, time.monotonic() + self._flow.patience() / 1e9)
                self._be_connected(deadline)
                self._order(waiting=True)
                message = self._receive(deadline, watch=True)
                if message is None:
                    return None
                self._keep(*message)

    def read_sensors(self, timeout: float | None = None) -> pb.Sensors | None:
        """Returns samples of the camera's sensors: a disparity_pb2.Sensors, or None when none came in time (timeout
        None = wait for ever). The newest frame that comes meanwhile is kept for read()."""
        with self._user:
            return self._read_sensors(deadline_after(timeout))

    def _read_sensors(self, deadline: float) -> pb.Sensors | None:
        while not self._sensors:
            message = self._receive(deadline, watch=True)
            if message is None:
                return None
            self._keep(*message)
        sensors = self._sensors.popleft()
        sensors.skipped += self._sensors_dropped
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

    def give_level(self, levels: list[tuple[float, float, float, float]], timeout: float = 5.0) -> pb.LevelStatus:
        """Tells the daemon where up was in the last moments, at most 64 of them in the order of time, for obstacle scans
        with [scan] ground = "autopilot": (ahead, left, up, age in s), along the robot's axes, of length 1. Returns a
        disparity_pb2.LevelStatus."""
        samples = [pb.LevelSample(ahead=a, left=b, up=c, age_us=round(1e6 * age)) for a, b, c, age in levels]
        request = pb.Envelope(give_level=pb.GiveLevel(samples=samples))
        return self._ask(request, "level_status", "a level", timeout)

    def trace(self, seconds: float = 3.0, timeout: float = 5.0) -> pb.Trace:
        """Has the daemon record what its threads do in the next seconds (0.1 to 10), waits for that and returns a
        disparity_pb2.Trace. The timeout counts from the end of that time."""
        question, patience = "a trace request", min(max(seconds, 0.0), 10.0) + timeout
        deadline = deadline_after(patience)
        trace = pb.Trace()
        part = self._ask(pb.Envelope(trace_request=pb.TraceRequest(seconds=seconds)), "trace", question, patience)
        trace.MergeFrom(part)
        with self._user:
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
        hello = pb.Hello(
            protocol_version=PROTOCOL_VERSION, client_name=self._name, token=self._stream.token, client_id=self._id
        )
        self._hello_sent = time.monotonic_ns()
        self._stream.send(pb.Envelope(hello=hello), timeout)

    def _greeted(self, deadline: float) -> bool:
        """Waits for the answer to Hello. Returns False when it has not come in time and may still come."""
        while True:
            message = self._open_stream().receive(min(deadline, self._greeting))
            if message is None:
                if time.monotonic() >= self._greeting:
                    raise DisparityError(f"disparityd at {self._address}: {_NO_ANSWER}")
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
        self._begin(self.welcome)
        return True

    def _begin(self, welcome: pb.Welcome) -> None:
        """Begins to order frames, on a connection whose daemon knows that."""
        self._pending.clear()
        self._later = None
        self._clock = None
        if welcome.monotonic_ns != 0:
            now = time.monotonic_ns()
            self._clock, self._liveness = DaemonClock(), Liveness()
            self._clock.add(self._hello_sent, welcome.monotonic_ns, now)

    def _come_back(self, deadline: float) -> None:
        """Connects again and subscribes as before. Raises Gone when no daemon has answered by the deadline; the next
        call continues. Raises Refused when the daemon refuses until then."""
        if self._closed:
            raise ValueError("this client is closed")
        reason: DisparityError | None = None
        while True:
            try:
                if self._stream is None:
                    most = _TLS_TIMEOUT if self._address.startswith("tls:") else _CONNECT_TIMEOUT
                    patience = min(max(_LEAST_PATIENCE, deadline - time.monotonic()), most)
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
            self._subscription.subscribe.by_credit = self._clock is not None
            self._flow = FrameFlow(self._subscription.subscribe.max_rate)
            try:
                self._open_stream().send(self._subscription, 5.0)
            except Gone:
                self._drop()

    def _order(self, waiting: bool) -> None:
        """Gives the daemon credit for frames. waiting: the program waits for one."""
        wants_frames = self._subscription is not None and len(self._subscription.subscribe.products) > 0
        if self._clock is not None and wants_frames and not self._lost and self._later is None:
            frames = self._flow.ask(waiting)
            if frames > 0:
                self._send_aside(pb.Envelope(ready=pb.Ready(frames=frames)))

    def _send_aside(self, message: pb.Envelope) -> None:
        """Sends what the program has not asked for. Where that fails, reading finds the end behind what has come."""
        self._open_stream().try_to_send(message, _SEND_TIMEOUT)

    def _take_in(self) -> None:
        """Takes in what lies in the socket. What is wrong behind a frame is told after it."""
        if self._clock is None or self._lost or self._later is not None:
            return
        try:
            for _ in range(_MOST_AT_ONCE):
                message = self._open_stream().receive(time.monotonic())
                if message is None:
                    return
                self._keep(*message)
        except DisparityError as error:
            self._later = error

    def _next_frame(self) -> Frame | None:
        """Returns the frame that the program is given, of those that have come; None: there is none that is fresh."""
        if not self._pending:
            return None
        (envelope, payload), lay = self._pending.popleft()
        if self._clock is None:
            return self._decoder.frame(envelope.frame, payload)
        if not self._flow.fresh(self._arrival(envelope.frame, time.monotonic_ns() - lay)):
            return None
        frame = self._decoder.frame(envelope.frame, payload)
        now = time.monotonic_ns()
        frame.age_ns += max(0, self._clock.latest(now) - envelope.frame.sent_monotonic_ns)
        self._flow.given(now)
        self._order(waiting=False)
        if not self._lost and self._later is None:
            self._ask_whether_there()  # where a frame is always there, nothing else asks for the clock
        return frame

    def _arrival(self, frame: pb.Frame, unwatched: int) -> Arrival:
        assert self._clock is not None
        sent, now = frame.sent_monotonic_ns, self._clock.latest(time.monotonic_ns())
        return Arrival(frame.publish_index, sent - frame.age_ns, sent, now, unwatched, self._clock.round_trip())

    def _be_connected(self, deadline: float) -> None:
        """Raises what was kept for later; connects again when the connection has ended."""
        if self._later is not None:
            error, self._later = self._later, None
            if isinstance(error, Gone):
                self._drop()
            raise error
        if self._lost:
            self._come_back(deadline)

    def _receive(self, deadline: float, watch: bool = False) -> Message | None:
        """Returns the next message, over another connection when the one before has ended; None when the time is up.
        watch: raises Gone when the daemon does not answer any more."""
        self._be_connected(deadline)
        watch = watch and self._clock is not None
        try:
            if watch:
                self._ask_whether_there()
            while True:
                until = min(deadline, time.monotonic() + _LOOK_INTERVAL) if watch else deadline
                message = self._open_stream().receive(until)
                if message is not None:
                    return message
                if watch:
                    self._check_whether_there()
                    self._ask_whether_there()
                if time.monotonic() >= deadline:
                    return None
        except Gone:
            self._drop()
            raise

    def _ask_whether_there(self) -> None:
        """Asks the daemon for its clock, when that is due or nothing has come for a while."""
        now = time.monotonic_ns()
        if self._liveness.asks(now, self._open_stream().heard, self._flow.interval()):
            self._send_aside(pb.Envelope(ping=pb.Ping(client_ns=now)))

    def _check_whether_there(self) -> None:
        """Raises Gone when the daemon has not answered. The socket has just been found empty."""
        stream, now = self._open_stream(), time.monotonic_ns()
        if self._liveness.is_gone(now, stream.heard):
            raise Gone(
                f"disparityd at {self._address}: no answer from the daemon for {(now - stream.heard) / 1e9:.1f} s: "
                "connecting anew"
            )

    def _ask(self, request: pb.Envelope, answer: str, question: str, timeout: float) -> typing.Any:
        with self._user:
            return self._question(request, answer, question, timeout)

    def _question(self, request: pb.Envelope, answer: str, question: str, timeout: float) -> typing.Any:
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
            empty = 0 if self._stream is None else self._stream.empty
            self._pending.append(((envelope, payload), empty))
            if self._clock is not None:
                self._flow.arrived(self._arrival(envelope.frame, 0))
                while len(self._pending) > 1:
                    self._pending.popleft()
        elif envelope.HasField("pong"):
            if self._clock is not None:
                self._clock.add(envelope.pong.client_ns, envelope.pong.monotonic_ns, time.monotonic_ns())
        elif envelope.HasField("status"):
            self.last_status = envelope.status
        elif envelope.HasField("sensors"):
            self._sensors.append(envelope.sensors)
            if len(self._sensors) > _MOST_SENSORS:
                oldest = self._sensors.popleft()
                self._sensors_dropped += oldest.skipped + len(oldest.samples)

    def _count_missed(self, frame: Frame) -> Frame:
        if self._last_index is not None and frame.publish_index > self._last_index:
            frame.skipped = frame.publish_index - self._last_index - 1
        self._last_index = frame.publish_index
        return frame

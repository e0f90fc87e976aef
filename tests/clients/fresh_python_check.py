# SPDX-License-Identifier: Apache-2.0
"""The Python client gives a program fresh frames, with their true age: against a daemon that a script plays.

Exit status 77: a Python module is missing, said on stderr.
"""
import contextlib
import itertools
import os
import socket
import struct
import sys
import tempfile
import threading
import time

try:
    import google.protobuf  # noqa: F401
    import numpy  # noqa: F401
except ImportError as error:
    print(f"skipped: {error}", file=sys.stderr)
    sys.exit(77)

import disparity
from disparity import disparity_pb2 as pb
from disparity import frame_flow, liveness

MS = 1_000_000
PATIENCE = 60.0


def arrival(index, captured_ms, sent_ms, now_ms, unwatched_ms=0, round_trip_ms=0):
    return frame_flow.Arrival(index, captured_ms * MS, sent_ms * MS, now_ms * MS, unwatched_ms * MS, round_trip_ms * MS)


def see(flow, index, sent_ms, now_ms, **more):
    """A frame that was sent 5 ms after its capture."""
    frame = arrival(index, sent_ms - 5, sent_ms, now_ms, **more)
    flow.arrived(frame)
    return flow.fresh(frame)


def reader(interval_ms, work_ms, way_ms=0, round_trip_ms=0):
    """Returns a flow after some frames of a program that works so long on each, and how many frames are on order while
    it works on the last one."""
    flow, on_order = frame_flow.FrameFlow(), 0
    for index in range(8):
        now = index * interval_ms + way_ms
        flow.reads((now - interval_ms + work_ms) * MS)
        on_order += flow.ask(waiting=True)
        assert see(flow, index, index * interval_ms, now, round_trip_ms=round_trip_ms)
        on_order += flow.ask(waiting=False) - 1
        flow.given(now * MS)
    return flow, on_order


def check_credit():
    """A program that keeps up orders when it waits, as many as its work and the way need; one that works longer orders
    one then. A frame that lay there, for which it did not wait, is followed by an order at once."""
    for interval, work, way, round_trip, ahead, waiting in (
        (33, 10, 0, 0, 0, 1),
        (33, 30, 0, 0, 1, 1),
        (33, 40, 0, 0, 0, 1),
        (67, 40, 0, 0, 0, 1),
        (67, 100, 1, 1, 0, 1),
        (33, 25, 25, 40, 2, 1),  # 20 ms of delay, small frames
        (33, 5, 25, 40, 1, 1),
        (33, 5, 100, 1, 1, 0),  # the link carries ten a second: more would wait for each other
    ):
        flow, on_order = reader(interval, work, way, round_trip)
        assert on_order == ahead, (interval, work, way, round_trip, on_order)
        assert flow.ask(waiting=True) == waiting, (interval, work, way, round_trip)
        assert flow.ask(waiting=True) == 0, "and not once more"
    flow, _ = reader(33, 10)
    flow.reads(262 * MS)
    assert see(flow, 8, 261, 262) and flow.ask(waiting=False) == 1


def check_freshness():
    flow, _ = reader(33, 5)
    assert see(flow, 8, 264, 264 + 30), "it lay less than an interval"
    assert not see(flow, 9, 297, 297 + 40, unwatched_ms=40), "it lay longer"
    assert see(flow, 20, 660, 661), "the next one did not"
    # After a stop both frames that were on order are old; what is asked for then is given, however slow the link is now.
    flow, on_order = reader(33, 25, 25, 40)
    assert on_order == 2
    assert not see(flow, 8, 300, 5300, unwatched_ms=5000)
    assert not see(flow, 9, 333, 5300, unwatched_ms=1)
    flow.ask(waiting=True)
    assert see(flow, 50, 5400, 5600, unwatched_ms=20), "asked for and waited for"
    assert see(flow, 51, 5450, 5640, unwatched_ms=20), "that is the way of this link from now on"


def check_clock():
    clock = frame_flow.DaemonClock()
    ahead = 1_000_000 * MS
    clock.add(10 * MS, ahead + 12 * MS, 20 * MS)
    assert ahead + 100 * MS <= clock.latest(100 * MS) <= ahead + 103 * MS and clock.round_trip() == 10 * MS
    clock.add(200 * MS, ahead + 201 * MS, 202 * MS)
    assert clock.latest(300 * MS) <= ahead + 302 * MS and clock.round_trip() == 2 * MS
    same = frame_flow.DaemonClock()
    same.add(10 * MS, 13 * MS, 20 * MS)
    assert same.latest(100 * MS) == 100 * MS, "it may be the same clock, so it is"


def check_liveness():
    alive = liveness.Liveness()
    assert not alive.asks(400 * MS, 0, 33 * MS) and alive.asks(500 * MS, 0, 33 * MS), "after half a second"
    assert not alive.asks(1400 * MS, 1390 * MS, 33 * MS) and alive.asks(1500 * MS, 1490 * MS, 33 * MS), "for the clock"
    alive = liveness.Liveness()
    assert alive.asks(500 * MS, 0, 33 * MS)
    assert not alive.asks(900 * MS, 0, 33 * MS) and not alive.is_gone(1400 * MS, 0)
    assert alive.is_gone(1501 * MS, 0) and not alive.is_gone(1501 * MS, 600 * MS), "but not when it has answered"


class End:
    """The daemon's end of a connection. Its clock is ahead of this program's by an hour."""

    AHEAD = 3600 * 1000 * MS

    def __init__(self, connection):
        connection.settimeout(PATIENCE)
        self._connection = connection
        self.hello = None
        self.credit = 0
        self.pings = 0

    def clock(self):
        return time.monotonic_ns() + self.AHEAD

    def send(self, payload=b"", **body):
        data = pb.Envelope(payload_bytes=len(payload), **body).SerializeToString()
        self._connection.sendall(struct.pack("<I", len(data)) + data + payload)

    def receive(self):
        """Returns the client's next message that is neither Ping nor Ready; None when it has left."""
        while True:
            head = self._connection.recv(4, socket.MSG_WAITALL)
            if len(head) < 4:
                return None
            message = pb.Envelope.FromString(self._connection.recv(struct.unpack("<I", head)[0], socket.MSG_WAITALL))
            if message.HasField("ping"):
                self.pings += 1
                try:
                    self.send(pong=pb.Pong(client_ns=message.ping.client_ns, monotonic_ns=self.clock()))
                except (BrokenPipeError, ConnectionResetError):
                    return None  # it asked, and left before it was answered
            elif message.HasField("ready"):
                self.credit += message.ready.frames
                return message
            else:
                return message

    def greet(self):
        self.hello = self.receive().hello
        self.send(welcome=pb.Welcome(protocol_version=2, monotonic_ns=self.clock()))
        wanted = self.receive().subscribe
        assert wanted.by_credit
        return wanted

    def await_credit(self):
        while self.credit == 0:
            assert self.receive() is not None, "the client left without an order"
        self.credit -= 1

    def send_frame(self, index, age_ms=5, sent_before_ms=0):
        plane = pb.PlaneInfo(product=disparity.CONFIDENCE, width=2, height=1, bytes_per_pixel=1, payload_bytes=2)
        frame = pb.Frame(publish_index=index, planes=[plane], age_ns=age_ms * MS,
                         sent_monotonic_ns=self.clock() - sent_before_ms * MS)
        self.send(b"ab", frame=frame)


@contextlib.contextmanager
def daemon(*scripts):
    """Runs a script for each connection, one after the other. Their failures are this test's."""
    failures = []

    def serve(listener):
        for script in scripts:
            connection, _ = listener.accept()
            with connection:
                try:
                    script(End(connection))
                except BaseException as error:  # noqa: B902
                    failures.append(error)
                    return

    with tempfile.TemporaryDirectory() as folder, socket.socket(socket.AF_UNIX) as listener:
        listener.bind(folder + "/s")
        listener.listen()
        listener.settimeout(PATIENCE)
        server = threading.Thread(target=serve, args=(listener,))
        server.start()
        try:
            yield "unix:" + folder + "/s"
        finally:
            server.join(PATIENCE)
    assert not server.is_alive(), "the script waits for ever"
    if failures:
        raise failures[0]


def check_frames():
    """Old frames are left out and counted; the age is that of the moment when the program gets the frame."""

    def script(end):
        end.greet()
        for index in range(3):
            end.await_credit()
            end.send_frame(index)
            time.sleep(0.02)
        end.await_credit()
        end.send_frame(3, sent_before_ms=9000)  # as if it had lain unread for nine seconds
        end.await_credit()
        end.send_frame(4, age_ms=300)
        end.receive()

    with daemon(script) as address, disparity.SocketClient(address) as client:
        client.subscribe([disparity.CONFIDENCE])
        for index in range(3):
            began = time.monotonic_ns()
            frame = client.read(PATIENCE)
            took = time.monotonic_ns() - began
            assert frame.publish_index == index and frame.confidence.tobytes() == b"ab"
            assert 5 * MS <= frame.age_ns <= 5 * MS + took + 20 * MS, (frame.age_ns, took)
        frame = client.read(PATIENCE)
        assert frame.publish_index == 4 and frame.skipped == 1 and frame.age_ns >= 300 * MS, frame


def orders(frame_with_status):
    """Returns what a daemon hears of a program that asks for the status and reads in turn, in a second and more. It is
    sent a frame with each status, or against credit."""
    heard, asked = [], threading.Event()

    def script(end):
        end.greet()
        for index in itertools.count():
            message = end.receive()
            if end.pings > 1:  # the first one begins
                asked.set()
            if message is None:
                return
            is_status = message.HasField("status_request")
            heard.append("status" if is_status else "ready")
            if is_status == frame_with_status:
                end.send_frame(index)
            if is_status:
                end.send(status=pb.Status())

    with daemon(script) as address, disparity.SocketClient(address) as client:
        client.subscribe([disparity.CONFIDENCE], max_rate=0.01)  # however slow this machine is, the program keeps up
        until = time.monotonic() + PATIENCE
        while not asked.is_set() and time.monotonic() < until:
            if frame_with_status:
                client.status(PATIENCE)
            assert client.read(PATIENCE) is not None
            if not frame_with_status:
                client.status(PATIENCE)
        assert asked.is_set(), "the clock was not asked for"
    return heard


def check_orders():
    """A program that keeps up orders a frame when it waits. One that never waits orders the next one as it takes one, and
    what is known of the daemon's clock does not grow old."""
    assert orders(frame_with_status=False)[:6] == ["ready", "status"] * 3
    assert orders(frame_with_status=True)[:6] == ["status", "ready"] * 3


def check_return():
    """A daemon that answers nothing is told, and another connection is made under the same number."""
    numbers, returned = [], threading.Event()

    def hangs(end):
        end.greet()
        numbers.append(end.hello.client_id)
        end.await_credit()
        end.send_frame(0)
        returned.wait(PATIENCE)

    def works(end):
        end.greet()
        numbers.append(end.hello.client_id)
        with contextlib.suppress(ConnectionError):  # the client leaves with an order unanswered
            while end.receive() is not None:  # a busy machine may let a frame grow old, which is ordered again
                end.send_frame(0)

    with daemon(hangs, works) as address, disparity.SocketClient(address) as client:
        client.subscribe([disparity.CONFIDENCE])
        assert client.read(PATIENCE) is not None
        began = time.monotonic()
        try:
            client.read(PATIENCE)
        except disparity.Gone as error:
            assert "no answer from the daemon for" in str(error), error
        else:
            raise AssertionError("a daemon that hangs was not told")
        assert time.monotonic() - began >= 1
        returned.set()
        assert client.read(PATIENCE) is not None
    assert len(numbers) == 2 and numbers[0] == numbers[1] != 0


def check_end():
    """A frame that came before the connection ended is given before that is told."""

    def script(end):
        end.greet()
        end.await_credit()
        end.send_frame(0)

    with daemon(script) as address, disparity.SocketClient(address) as client:
        client.subscribe([disparity.CONFIDENCE])
        assert client.read(PATIENCE).publish_index == 0
        try:
            client.read(PATIENCE)
        except disparity.Gone:
            return
    raise AssertionError("not gone")


def check_one_user():
    """One object in two threads, and on both sides of a fork."""
    waiting, done = threading.Event(), threading.Event()

    def script(end):
        end.greet()
        end.await_credit()
        waiting.set()
        done.wait(PATIENCE)
        end.send_frame(0)
        end.receive()

    def refusal(client):
        try:
            client.read(0)
        except ValueError as error:
            return str(error)
        return ""

    with daemon(script) as address, disparity.SocketClient(address) as client:
        client.subscribe([disparity.CONFIDENCE])
        frames = []
        thread = threading.Thread(target=lambda: frames.append(client.read(PATIENCE)))
        thread.start()
        assert waiting.wait(PATIENCE)
        assert "two threads use it at once" in refusal(client)
        done.set()
        thread.join()
        assert frames[0].publish_index == 0
        child = os.fork()
        if child == 0:
            os._exit(0 if "made before a fork" in refusal(client) else 1)
        assert os.waitpid(child, 0)[1] == 0


def check_addresses():
    """tcp://HOST:PORT is taken, too."""
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        address = f"tcp://127.0.0.1:{listener.getsockname()[1]}/"
    try:
        disparity.SocketClient(address)
    except disparity.DisparityError as error:
        assert "refused" in str(error), error
    else:
        raise AssertionError("connected to nobody")


for check in (check_credit, check_freshness, check_clock, check_liveness, check_frames, check_orders,
              check_return, check_end, check_one_user, check_addresses):
    check()

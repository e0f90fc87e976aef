# SPDX-License-Identifier: Apache-2.0
"""Prints one frame as the Python client gives it, in the form that same_frame_test.cpp compares.

python_check.py ADDRESS NAME-OF-SHARED-MEMORY; or --written-over NAME FILE, a file that is made when a frame is
borrowed. Exit status 77: a Python module is missing, said on stderr.
"""
import copy
import gc
import os
import pathlib
import pickle
import resource
import socket
import struct
import sys
import tempfile
import threading
import time

try:
    import google.protobuf  # noqa: F401
    import numpy as np
except ImportError as error:
    print(f"skipped: {error}", file=sys.stderr)
    sys.exit(77)

import disparity


def fnv1a(data):
    value = 0xCBF29CE484222325
    for byte in data:
        value = ((value ^ byte) * 0x100000001B3) & 0xFFFFFFFFFFFFFFFF
    return value


def print_frame(way, f):
    values = [getattr(f, name) for name, _ in disparity.frame.C_FIELDS if name != "skipped"]
    print(way, *("%.17g" % value if isinstance(value, float) else value for value in values))
    for product, plane in f.planes.items():
        pixel = plane.itemsize * (plane.shape[2] if plane.ndim == 3 else 1)
        print(way, "plane", product, plane.shape[1], plane.shape[0], pixel, f"{fnv1a(plane.tobytes()):016x}")
    # What is computed from the planes, to the last bit.
    errors = fnv1a(f.depth_error_m.tobytes()) if disparity.DEPTH_ERROR in f.planes else 0
    places = fnv1a(f.points().tobytes() + f.points(3).tobytes())
    colours = fnv1a(f.colours().tobytes() + f.colours(3).tobytes())
    sums = (fnv1a(f.disparity_px.tobytes()), fnv1a(f.depth_m.tobytes()), errors, places, colours)
    print(way, "metres", *(f"{value:016x}" for value in sums))


def check_scan():
    """A scan whose bytes are known."""
    sector = struct.pack("<hhBBHHHhhHHBB", -100, 200, disparity.OCCUPIED, 250, 1500, 30, 900, 100, 700, 80, 0b1001, 90, 0)

    def record(version):
        return struct.pack("<HHBBHhhhhhHHHhhHH", version, 1, 1, 0, 0, 0, 0, 0, 80, 1000, 200, 20000, 0, 0, 0, 0, 0) + sector

    scan = disparity.scan.read_scan(record(2))
    assert scan.distance_m[0] == 1.5 and scan.free_m[0] == 0.9 and scan.pixels[0] == 80
    assert scan.trust[0] == 90 and scan.doubts[0] == disparity.DARK | disparity.DIRTY_EYE
    assert disparity.doubt_names(scan.doubts[0]) == ["dark", "dirty-eye"]
    try:
        disparity.scan.read_scan(record(1))
        raise AssertionError("a scan of an older daemon was taken")
    except disparity.DisparityError as error:
        assert "version 1, this program knows 2" in str(error)


def check_arrays(frame):
    """What is made from the planes, on a frame whose numbers are known."""
    assert frame.disparity.dtype == np.int16 and frame.left_colour.shape == (frame.height, frame.width, 3)
    frame.planes[disparity.DISPARITY] = raw = np.array([[160, frame.invalid], [8, 16]], np.int16)
    assert np.array_equal(np.isnan(frame.disparity_px), raw == frame.invalid)
    assert frame.disparity_px[0, 0] == 10.0
    frame.f, frame.baseline_mm, frame.cx, frame.cy, frame.disparity_offset = 500.0, 120.0, 0.5, 0.5, 2.0
    points = frame.points()
    assert np.isnan(points[0, 1]).all()
    assert abs(points[0, 0, 2] - 0.5 * 120 / 12) < 1e-5
    assert abs(points[0, 0, 0] - points[0, 0, 2] * -0.5 / 500) < 1e-6
    check_thinned_points(frame)
    frame.planes[disparity.DEPTH] = np.array([[0, 65535, 1500]], np.uint16)
    assert np.isnan(frame.depth_m[0, 0]) and np.isinf(frame.depth_m[0, 1]) and frame.depth_m[0, 2] == 1.5
    frame.planes[disparity.DEPTH_ERROR] = np.array([[0, 65535, 250]], np.uint16)
    assert frame.depth_error.dtype == np.uint16 and frame.depth_error[0, 2] == 250
    errors = frame.depth_error_m
    assert errors.dtype == np.float32 and np.isnan(errors[0, 0]) and np.isinf(errors[0, 1]) and errors[0, 2] == 0.25


def check_thinned_points(frame):
    """A block of a thinned image has its nearest point, with the place and the colour of that pixel."""
    before = dict(frame.planes)
    frame.planes.pop(disparity.LEFT_COLOUR, None)
    pixels = np.full((3, 5), frame.invalid, np.int16)
    pixels[0, 1], pixels[1, 0], pixels[2, 4] = 160, 320, 480
    frame.planes[disparity.DISPARITY] = pixels
    frame.planes[disparity.LEFT] = np.arange(15, dtype=np.uint8).reshape(3, 5)
    whole, points = frame.points(), frame.points(2)
    assert points.shape == (2, 3, 3)
    assert np.array_equal(points[0, 0], whole[1, 0]) and np.array_equal(points[1, 2], whole[2, 4])
    assert np.isnan(points[0, 1:]).all() and np.isnan(points[1, :2]).all()
    assert np.array_equal(frame.colours(2)[..., 0], [[5, 2, 4], [10, 12, 14]])
    assert np.array_equal(frame.points(100), whole[2:3, 4:5]) and np.array_equal(frame.points(0), whole, equal_nan=True)
    frame.planes = before


def check_fields():
    """Every field of the messages is one of Frame, or is named here: it comes out in another way."""
    from disparity import disparity_pb2 as pb

    elsewhere = {"geometry", "region", "planes", "skipped", "sent_monotonic_ns"}
    for message, descriptor in (("frame", pb.Frame.DESCRIPTOR), ("geometry", pb.Geometry.DESCRIPTOR)):
        names = {field.name for field in descriptor.fields} - elsewhere
        assert names == set(disparity.frame.MESSAGE_FIELDS[message]), (message, names)


def check_refusals():
    for address in ("", "http:x", "tcp:", "tcp:host", "tcp:host:x", "unix:"):
        try:
            disparity.SocketClient(address)
        except ValueError:
            continue
        raise AssertionError(f"{address!r} was accepted")
    try:
        disparity.SocketClient("unix:/nonexistent/socket")
    except disparity.DisparityError as error:
        assert "unix:/nonexistent/socket: cannot connect" in str(error), error
    else:
        raise AssertionError("connected to nothing")


def check_words():
    """What a daemon says moves no terminal's cursor; this program's own limit is not the daemon's fault."""
    assert disparity.stream.printable("a\x1b[2J\nb\x9b\xe9\x7f") == "a?[2J?b?\xe9?"
    before = resource.getrlimit(resource.RLIMIT_NOFILE)
    with open(os.devnull, encoding="utf-8") as lowest:
        free = lowest.fileno()
    resource.setrlimit(resource.RLIMIT_NOFILE, (free, before[1]))
    try:
        disparity.SocketClient("unix:/tmp/any.sock")
    except disparity.DisparityError as error:
        assert "too many files" in str(error) and "is disparityd running" not in str(error), error
    else:
        raise AssertionError("connected")
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, before)


def check_limits():
    """What a bad server may claim is refused before memory is made for it."""
    from disparity import disparity_pb2 as pb
    from disparity import stream

    def plane(**changes):
        good = {"product": 2, "width": 4, "height": 3, "bytes_per_pixel": 1, "payload_bytes": 12}
        return pb.PlaneInfo(**{**good, **changes})

    stream.check_payload(pb.Envelope(payload_bytes=12, frame=pb.Frame(planes=[plane()])))
    for payload, bad in (
        (1 << 40, plane(payload_bytes=1 << 40)),
        (13, plane()),
        (12, plane(payload_bytes=2**64 - 1)),
        (12, plane(width=1 << 30)),
        (12, plane(height=0)),
        (12, plane(height=2)),
        (12, plane(bytes_per_pixel=9)),
        (12, plane(encoding=7)),
        (5000, plane(encoding=pb.ZSTD, payload_bytes=5000)),
    ):
        try:
            stream.check_payload(pb.Envelope(payload_bytes=payload, frame=pb.Frame(planes=[bad])))
        except ValueError:
            continue
        raise AssertionError(f"accepted: payload {payload}, {bad}")


def check_trust():
    """The flags of a frame say how far it can be trusted, and why not."""
    frame = disparity.Frame(flags=disparity.SYNTHETIC | disparity.DIRTY_EYE | disparity.DARK | 200 << 24)
    assert (frame.trust, frame.doubts) == (200, ["dark", "dirty-eye"])
    assert (disparity.Frame().trust, disparity.Frame().doubts) == (0, [])


def check_inertial_calibration():
    from disparity import disparity_pb2 as pb

    assert disparity.inertial_calibration(pb.Status()) is None
    status = pb.Status(geometry=pb.Geometry(calibration_id=77))
    status.inertial_calibration.gyroscope_random_walk = 0.5
    found = disparity.inertial_calibration(status)
    assert found.rotation is None and found.translation_mm is None and found.time_offset_s is None
    assert found.gyroscope_random_walk == 0.5 and found.accelerometer_random_walk is None
    status.inertial_calibration.pose.rotation.extend([0, -1, 0, 1, 0, 0, 0, 0, 1])
    status.inertial_calibration.pose.translation_mm.extend([10.5, -20, 0.25])
    status.inertial_calibration.time_offset.seconds = 0
    found = disparity.inertial_calibration(status)
    assert found.calibration_id == 77 and found.time_offset_s == 0
    assert np.array_equal(found.rotation @ [1, 0, 0], [0, 1, 0]) and found.translation_mm[1] == -20


def check_sensors(sensors):
    """What came before the frame was kept."""
    assert sensors.skipped == 3 and sensors.age_ns == 5000 and len(sensors.samples) == 2
    first, second = sensors.samples
    assert first.monotonic_ns == 1000 and first.HasField("inertial") and not first.HasField("environment")
    assert first.inertial.acceleration.z == 9.75
    assert second.environment.hectopascal == 1013.25 and second.frame_sync and not second.HasField("inertial")


def check_trace():
    """A level is given; a trace that comes in two parts is one message."""
    from disparity import disparity_pb2 as pb

    def send(end, envelope):
        data = envelope.SerializeToString()
        end.sendall(struct.pack("<I", len(data)) + data)

    def receive(end):
        length, = struct.unpack("<I", end.recv(4, socket.MSG_WAITALL))
        return pb.Envelope.FromString(end.recv(length, socket.MSG_WAITALL))

    def serve(listener):
        end, _ = listener.accept()
        with end:
            receive(end)
            send(end, pb.Envelope(welcome=pb.Welcome(protocol_version=2)))
            given.extend(receive(end).give_level.samples)
            send(end, pb.Envelope(level_status=pb.LevelStatus(source="autopilot")))
            asked.append(receive(end).trace_request.seconds)
            send(end, pb.Envelope(trace=pb.Trace(tracks=[pb.TraceTrack(name="first")])))
            send(end, pb.Envelope(trace=pb.Trace(tracks=[pb.TraceTrack(name="second")], duration_ns=7, last=True)))

    asked = []
    given = []
    with tempfile.TemporaryDirectory() as folder, socket.socket(socket.AF_UNIX) as listener:
        listener.bind(folder + "/s")
        listener.listen()
        server = threading.Thread(target=serve, args=(listener,))
        server.start()
        with disparity.SocketClient("unix:" + folder + "/s") as client:
            assert client.give_level([(0.6, 0.0, 0.8, 0.02)]).source == "autopilot"
            trace = client.trace(0.5)
        server.join()
    assert given == [pb.LevelSample(ahead=0.6, up=0.8, age_us=20000)]
    assert asked == [0.5] and trace.last and trace.duration_ns == 7
    assert [track.name for track in trace.tracks] == ["first", "second"]


def check_door():
    """A daemon that is found by its name, that goes, and that comes back; one of several; none."""
    from disparity import disparity_pb2 as pb

    def send(end, envelope):
        data = envelope.SerializeToString()
        end.sendall(struct.pack("<I", len(data)) + data)

    def receive(end):
        head = end.recv(4, socket.MSG_WAITALL)
        return pb.Envelope.FromString(end.recv(*struct.unpack("<I", head), socket.MSG_WAITALL)) if head else None

    def talk(end):
        receive(end)  # Hello, of a client that does not only look whether somebody listens
        send(end, pb.Envelope(welcome=pb.Welcome(protocol_version=2)))
        while (asked := receive(end)) is not None:
            if asked.HasField("status_request"):
                send(end, pb.Envelope(status=pb.Status(state="running")))
            elif asked.subscribe.products:
                send(end, pb.Envelope(frame=pb.Frame(sequence=7)))
                if asked.subscribe.max_rate == 1:  # the daemon ends
                    return

    def serve(listener):
        while True:
            try:
                end, _ = listener.accept()
            except OSError:
                return
            with end:
                try:
                    talk(end)
                except OSError:  # it only looked
                    pass

    before = os.environ.get("XDG_RUNTIME_DIR")
    with tempfile.TemporaryDirectory() as folder:
        os.environ["XDG_RUNTIME_DIR"] = folder
        listeners = []
        name = f"door-{os.getpid()}"
        for part in ("front", "back"):
            listener = socket.socket(socket.AF_UNIX)
            listener.bind(f"{folder}/disparityd-{name}.{part}.sock")
            listener.listen()
            threading.Thread(target=serve, args=(listener,), daemon=True).start()
            listeners.append(listener)
        with disparity.connect(name + ".front", max_rate=1) as door:
            assert door.where == f"socket of {name}.front" and door.read(timeout=60).sequence == 7
            try:
                door.read(timeout=60)
            except disparity.Gone:
                pass
            else:
                raise AssertionError("not gone")
            door.subscribe()
            frame = None
            while frame is None:  # on another connection
                frame = door.read(timeout=60)
            assert frame.sequence == 7 and door.status(60).state == "running"
        for where, kind, told in (("", disparity.DisparityError, f"{name}.back, {name}.front"),
                                  (name, disparity.DisparityError, "daemons of other names run: "),
                                  ("a b", ValueError, "allowed: 1 to 64"), ("tcp:x", ValueError, "expected tcp")):
            try:
                with disparity.connect(where, []) as door:
                    assert where == "" and door.where == "socket of default", "another daemon runs here"
            except kind as error:
                assert told in str(error), error
        with disparity.connect(name, may_be_absent=True) as door:
            try:
                door.read(timeout=0)
            except disparity.Gone as error:
                assert "no daemon answers" in str(error), error
            else:
                raise AssertionError("not gone")
        for listener in listeners:
            listener.shutdown(socket.SHUT_RDWR)
            listener.close()
    del os.environ["XDG_RUNTIME_DIR"]
    if before is not None:
        os.environ["XDG_RUNTIME_DIR"] = before


def check_absent_memory(name):
    """A reader that waits for its daemon, and one that does not."""
    try:
        disparity.SharedMemoryReader(name)
    except disparity.DisparityError as error:
        assert "there is none" in str(error), error
    else:
        raise AssertionError("opened nothing")
    with disparity.SharedMemoryReader(name, may_be_absent=True) as reader:
        for timeout in (0.3, 0):
            begin = time.monotonic()
            try:
                reader.read(timeout=timeout)
            except disparity.Gone as error:
                assert "there is none" in str(error), error
                assert time.monotonic() - begin >= timeout * 0.99
            else:
                raise AssertionError("not gone")


def check_compressed(address, products, raw):
    """The same planes come out when they travel compressed."""
    try:
        import zstandard  # noqa: F401
    except ImportError as error:
        print(f"compressed frames not checked: {error}", file=sys.stderr)
        return
    with disparity.SocketClient(address) as client:
        client.subscribe(products, compressed=True)
        frame = client.read(timeout=20)
    assert sorted(frame.planes) == sorted(raw)
    assert all(np.array_equal(frame.planes[product], raw[product]) for product in raw)


def check_ownership(reader, frame):
    """The planes are the program's own: writing to them changes neither the library's frame nor another copy of it."""
    for plane in frame.planes.values():
        assert plane.flags.writeable and plane.flags.c_contiguous
        plane[...] = 0
    again = reader._copy()
    assert all(plane.any() for plane in again.planes.values())
    assert not any(plane.any() for plane in frame.planes.values())


def print_borrowed(name):
    """The arrays lie in the shared memory, read-only, and keep it mapped after all else is gone."""
    with disparity.SharedMemoryReader(name) as reader:
        frame = reader.borrow(timeout=20)
        assert reader.borrow(timeout=0) is None
    print_frame("borrowed", frame)
    assert frame.whole()
    for copied in (frame.copy(), copy.deepcopy(frame), pickle.loads(pickle.dumps(frame))):
        assert copied.whole() and copied.sequence == frame.sequence and sorted(copied.planes) == sorted(frame.planes)
        assert all(np.array_equal(copied.planes[product], frame.planes[product]) for product in frame.planes)
        assert copied.confidence.flags.writeable
    plane = frame.confidence
    assert not plane.flags.writeable and not plane.flags.owndata
    before = plane.tobytes()
    del frame, reader
    gc.collect()
    assert plane.tobytes() == before


def check_written_over(name, borrowed):
    """A borrowed frame is whole until another is written over it, then never again; a copy stays."""
    with disparity.SharedMemoryReader(name) as reader:
        frame = reader.borrow(timeout=20)
        copied = frame.copy()
        assert frame.whole()
        pathlib.Path(borrowed).touch()
        end = time.monotonic() + 60
        while frame.whole():
            assert time.monotonic() < end, "nobody wrote over the frame"
            time.sleep(0.01)
        assert not frame.whole() and copied.whole()
        another = reader.borrow(timeout=20)
        assert another.whole() and another.sequence > frame.sequence and not frame.whole()


def main():
    if sys.argv[1] == "--written-over":
        check_written_over(*sys.argv[2:])
        return
    address, name = sys.argv[1:]
    check_fields()
    check_refusals()
    check_words()
    check_limits()
    check_trust()
    check_inertial_calibration()
    check_trace()
    check_door()
    products = [disparity.DISPARITY, disparity.CONFIDENCE, disparity.LEFT_COLOUR, disparity.DEPTH, disparity.DEPTH_ERROR]
    with disparity.SocketClient(address) as client:
        client.subscribe(products, sensors=True)
        frame = client.read(timeout=float("inf"))
        print_frame("socket", frame)
        check_sensors(client.read_sensors(timeout=0))
        raw = dict(frame.planes)
        check_arrays(frame)
        check_scan()
        try:
            client.read(timeout=20)
        except disparity.DisparityError as error:
            assert "the fake daemon has said everything" in str(error), error
        else:
            raise AssertionError("no error")
        try:
            client.read(timeout=20)
        except disparity.Gone:
            pass
        else:
            raise AssertionError("not gone")
        again = client.read(timeout=20)  # on another connection, subscribed as before
        assert again.publish_index == frame.publish_index and sorted(again.planes) == sorted(raw)
    try:
        client.read(timeout=0)
    except ValueError as error:
        assert "closed" in str(error), error
    else:
        raise AssertionError("a closed client read on")
    check_compressed(address, products, raw)
    # An instrumented library cannot be loaded into a program that is not.
    if "DISPARITY_SKIP_LIBRARY" not in os.environ:
        with disparity.SharedMemoryReader(name) as reader:
            frame = reader.read(timeout=20)
            print_frame("shm", frame)
            check_ownership(reader, frame)
            assert reader.read(timeout=0) is None
        print_borrowed(name)
        with disparity.connect(name, [disparity.DISPARITY, disparity.LEFT_COLOUR]) as door:
            print_frame("door", door.read(timeout=20))
            assert door.where == "shared memory " + name
        check_absent_memory(name + "-absent")


if __name__ == "__main__":
    main()

# SPDX-License-Identifier: Apache-2.0
"""A recording goes into the real daemon; the C++ and the Python client read it over shared memory and over TCP.

Whatever frames two of them both saw must be the same to the byte. --input zed makes the recording from a real camera's
raw pair and factory calibration (skipped without the evaluation data), --input scene from the rendered scene.
"""
import argparse
import os
import pathlib
import subprocess
import sys
import tempfile
import threading

FRAMES = 12
SKIP = 77


def fnv(data):
    value = 0xCBF29CE484222325
    for byte in data:
        value = ((value ^ byte) * 0x100000001B3) & 0xFFFFFFFFFFFFFFFF
    return value


def data_folder():
    for name in ("DISPARITYD_DATA", "DISPARITYD_SHARED_DATA"):
        folder = pathlib.Path(os.environ.get(name, "/nonexistent")) / "zed"
        if folder.is_dir():
            return folder
    print("skipped: the real ZED pair is not here (DISPARITYD_DATA names the evaluation data)")
    sys.exit(SKIP)


def make_recording(arguments, out):
    if arguments.input == "zed":
        data = data_folder()
        pair = data / "indoor_zed_sn21531_hd720_15"
        command = [arguments.bin / "make_recording", pair / "left_raw.png", pair / "right_raw.png",
                   data / "SN21531_derived.conf", out, "3"]
    else:
        command = [arguments.bin / "disparityctl", "record", out, "--source",
                   "scene:vga@30?width=320&height=180&loop=4", "--frames", "8"]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)


class Daemon:
    def __init__(self, arguments, recording):
        self.name = f"same-frame-{os.getpid()}-{arguments.input}"
        # Slow enough for every client to see most frames, on a small rectified picture.
        self.process = subprocess.Popen(
            [arguments.bin / "disparityd", "--source", recording, "--name", self.name, "--print-address",
             "--set", "socket.tcp=127.0.0.1:0", "--set", "socket.unix=", "--set", "source.loop=true",
             "--set", "rectify.width=320", "--set", "rectify.height=180", "--set", "match.disparities=32"],
            stdout=subprocess.PIPE, text=True)
        self.tcp = None
        for line in self.process.stdout:
            if line.startswith("tcp:"):
                self.tcp = line.strip()
            if line.strip() == "ready":
                break
        if self.tcp is None:
            raise RuntimeError("the daemon did not start")

    def stop(self):
        self.process.terminate()
        return self.process.wait(timeout=30)


def read_with_program(arguments, address, lines):
    result = subprocess.run([arguments.bin / "frame_digests", address, str(FRAMES)], stdout=subprocess.PIPE, text=True,
                            timeout=200, check=True)
    lines.extend(result.stdout.splitlines())


def line_of(frame):
    planes = " ".join(f"{product}:{fnv(frame.planes[product].tobytes()):016x}" for product in sorted(frame.planes))
    return (f"{frame.publish_index} {planes} seq={frame.sequence} mono={frame.monotonic_ns} real={frame.realtime_ns} "
            f"cal={frame.calibration_id:016x} size={frame.width}x{frame.height} d={frame.d_min}+{frame.disparities} "
            f"inv={frame.invalid} flags={frame.flags}")


def read_with_python(open_client, lines):
    import disparity

    with open_client() as client:
        if isinstance(client, disparity.SocketClient):
            client.subscribe([disparity.DISPARITY, disparity.CONFIDENCE, disparity.DEPTH, disparity.LEFT])
        frames = []
        while len(frames) < FRAMES:
            frame = client.read(timeout=60)
            if frame is None:
                raise RuntimeError("no frame in 60 s")
            frames.append(frame)
        lines.extend(line_of(frame) for frame in frames)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--bin", type=pathlib.Path, required=True)
    parser.add_argument("--python", type=pathlib.Path, required=True)
    parser.add_argument("--input", choices=("scene", "zed"), required=True)
    parser.add_argument("--without-python", action="store_true")
    arguments = parser.parse_args()
    sys.path.insert(0, str(arguments.python))

    if not arguments.without_python:
        try:
            import disparity
        except ImportError as error:
            print(f"skipped: the Python client needs numpy and protobuf: {error}")
            return SKIP

    with tempfile.TemporaryDirectory() as folder:
        recording = os.path.join(folder, "input.mkv")
        make_recording(arguments, recording)
        daemon = Daemon(arguments, recording)
        readers = {
            "C++ over shared memory": lambda out: read_with_program(arguments, "shm:" + daemon.name, out),
            "C++ over TCP": lambda out: read_with_program(arguments, daemon.tcp, out),
        }
        if not arguments.without_python:
            readers["Python over shared memory"] = lambda out: read_with_python(
                lambda: disparity.SharedMemoryReader(daemon.name), out)
            readers["Python over TCP"] = lambda out: read_with_python(lambda: disparity.SocketClient(daemon.tcp), out)

        seen = {name: [] for name in readers}
        threads = [threading.Thread(target=read, args=(seen[name],), daemon=True) for name, read in readers.items()]
        try:
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
        finally:
            status = daemon.stop()

    failures = [] if status == 0 else [f"the daemon ended with {status}"]
    frames = {}
    for name, lines in seen.items():
        if len(lines) != FRAMES:
            failures.append(f"{name}: {len(lines)} frames of {FRAMES}")
        for line in lines:
            frames.setdefault(line.split()[0], {})[name] = line
    shared = [views for views in frames.values() if len(views) == len(readers)]
    for views in frames.values():
        if len(set(views.values())) > 1:
            failures.append("\n".join(f"{name}: {line}" for name, line in views.items()))
    if not shared:
        failures.append("no frame was seen by all readers")
    print(f"{len(shared)} frames seen by all of: {', '.join(readers)}")
    for failure in failures:
        print("FAILED", failure)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Lets ROS's own Python library write bags of ROS 1, and Python's SQLite those of ROS 2, and compares the depth with that of the same images as a
folder of PNGs, byte for byte. Usage: other_bags.py DISPARITYCTL. Exit status 77: ROS's library is not installed (python3-rosbag,
python3-sensor-msgs)."""
import pathlib
import random
import sqlite3
import struct
import subprocess
import sys
import tempfile
import zlib

WIDTH, HEIGHT, FRAMES = 160, 96, 3
START_S = 1_700_000_000
CAMERA = [200.0, 0, 80, 0, 200.0, 48, 0, 0, 1]
BASELINE_M = 0.12


def picture(number, shift):
    """Noise whose right image is shifted."""
    made = random.Random(number)
    rows = [[made.randrange(256) for _ in range(WIDTH + 16)] for _ in range(HEIGHT)]
    return b"".join(bytes(row[shift:shift + WIDTH]) for row in rows)


def png(pixels):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    lines = b"".join(b"\0" + pixels[y * WIDTH:(y + 1) * WIDTH] for y in range(HEIGHT))
    head = struct.pack(">IIBBBBB", WIDTH, HEIGHT, 8, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(lines)) + chunk(b"IEND", b"")


def projection(eye):
    return [200.0, 0, 80, -200.0 * BASELINE_M if eye == "right" else 0, 0, 200.0, 48, 0, 0, 0, 1, 0]


def messages():
    """Frame, eye, pixels."""
    for frame in range(FRAMES):
        for eye, shift in (("left", 0), ("right", 8)):
            yield frame, eye, picture(frame, shift)


def write_folder(folder):
    for frame, eye, pixels in messages():
        (folder / eye).mkdir(parents=True, exist_ok=True)
        (folder / eye / f"{START_S + frame}000000000.png").write_bytes(png(pixels))


def write_ros1(path, packing):
    import genpy
    import rosbag
    from sensor_msgs.msg import CameraInfo, Image
    with rosbag.Bag(str(path), "w", compression=packing, chunk_threshold=40_000) as bag:
        for frame, eye, pixels in messages():
            stamp = genpy.Time(START_S + frame, 0)
            info = CameraInfo(height=HEIGHT, width=WIDTH, distortion_model="plumb_bob", D=[0.0] * 5, K=CAMERA,
                              R=[1, 0, 0, 0, 1, 0, 0, 0, 1], P=projection(eye))
            info.header.stamp = stamp
            bag.write(f"/{eye}/camera_info", info, stamp)
            image = Image(height=HEIGHT, width=WIDTH, encoding="mono8", step=WIDTH, data=pixels)
            image.header.stamp = stamp
            bag.write(f"/{eye}/image_rect", image, stamp)


class Cdr:
    """Writes a message as ROS 2 does."""

    def __init__(self):
        self.body = b""

    def put(self, kind, *values):
        size = struct.calcsize(kind)
        for value in values:
            self.body += b"\0" * (-len(self.body) % size) + struct.pack("<" + kind, value)
        return self

    def text(self, value):
        self.put("I", len(value) + 1)
        self.body += value.encode() + b"\0"
        return self

    def message(self):
        return b"\0\1\0\0" + self.body


def write_db3(path):
    base = sqlite3.connect(path)
    base.executescript("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
                       "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);"
                       "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, "
                       "data BLOB NOT NULL); CREATE INDEX timestamp_idx ON messages (timestamp ASC);")
    topics = {}
    for eye in ("left", "right"):
        for name, kind in (("camera_info", "CameraInfo"), ("image_rect", "Image")):
            topics[eye, kind] = len(topics) + 1
            base.execute("INSERT INTO topics VALUES(?,?,?,'cdr','')",
                         (topics[eye, kind], f"/{eye}/{name}", f"sensor_msgs/msg/{kind}"))
    for frame, eye, pixels in messages():
        info = Cdr().put("i", START_S + frame).put("I", 0).text("camera").put("I", HEIGHT, WIDTH).text("plumb_bob")
        info.put("I", 5).put("d", *[0.0] * 5, *CAMERA, 1, 0, 0, 0, 1, 0, 0, 0, 1, *projection(eye))
        info.put("I", 0, 0, 0, 0, 0, 0).put("B", 0)
        image = Cdr().put("i", START_S + frame).put("I", 0).text("camera").put("I", HEIGHT, WIDTH).text("mono8")
        image.put("B", 0).put("I", WIDTH, len(pixels))
        image.body += pixels
        for kind, message in (("CameraInfo", info), ("Image", image)):
            base.execute("INSERT INTO messages(topic_id, timestamp, data) VALUES(?,?,?)",
                         (topics[eye, kind], (START_S + frame) * 10**9, message.message()))
    base.commit()
    base.close()


def depth_of(program, source, out, *options):
    subprocess.run([program, "process", str(source), "-o", str(out), "--disparities", "16", "--no-self-calibration", *options],
                   check=True, stdout=subprocess.DEVNULL)
    return {path.name: path.read_bytes() for path in sorted(out.iterdir()) if path.suffix == ".png"}


def main():
    try:
        import genpy  # noqa: F401
        import rosbag  # noqa: F401
    except ImportError:
        print("python3-rosbag is not installed")
        return 77
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        write_folder(folder / "images")
        bags = [folder / "a.db3"]
        write_db3(bags[0])
        for packing in ("none", "bz2", "lz4"):
            bags.append(folder / f"{packing}.bag")
            write_ros1(bags[-1], packing)
        calibration = folder / "calib.txt"
        calibration.write_text(f"cam0=[200 0 80; 0 200 48; 0 0 1]\ncam1=[200 0 80; 0 200 48; 0 0 1]\ndoffs=0\nbaseline={1000 * BASELINE_M}\n"
                               f"width={WIDTH}\nheight={HEIGHT}\nndisp=16\n")
        expected = list(depth_of(sys.argv[1], folder / "images", folder / "of-images", "--calibration", str(calibration)).values())
        assert len(expected) >= FRAMES, "no depth of the folder"
        for bag in bags:
            found = list(depth_of(sys.argv[1], bag, folder / f"of-{bag.name}").values())
            assert found == expected, f"{bag.name}: other depth than that of the same images as a folder"
            print(f"{bag.name}: the depth of {FRAMES} frames is that of the folder")
    return 0


if __name__ == "__main__":
    sys.exit(main())

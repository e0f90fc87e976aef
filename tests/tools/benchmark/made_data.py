# SPDX-License-Identifier: Apache-2.0
"""Small data sets of random pictures, truths and results in the layouts of the benchmarks, with files of their own making."""
import pathlib
import struct
import zlib

import numpy

WIDTH, HEIGHT = 61, 37


def png(array):
    """Grey of 8 or 16 bits, or red, green, blue of 8."""
    height, width = array.shape[:2]
    bits, colour = (16, 0) if array.dtype == numpy.uint16 else (8, 2 if array.ndim == 3 else 0)
    rows = array.astype(">u2" if bits == 16 else "u1").reshape(height, -1)
    lines = b"".join(b"\0" + row.tobytes() for row in rows)

    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    head = struct.pack(">IIBBBBB", width, height, bits, colour, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(lines)) + chunk(b"IEND", b"")


def pfm(array):
    return b"Pf\n%d %d\n-1\n" % (array.shape[1], array.shape[0]) + array[::-1].astype("<f4").tobytes()


def write(path, content):
    path = pathlib.Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    if isinstance(content, numpy.ndarray):
        content = pfm(content) if path.suffix == ".pfm" else png(content)
    path.write_bytes(content)


class Scene:
    """What is known of a scene: grey left image, truth (px, float32, NaN = unknown), and masks or None."""

    def __init__(self, random, name, quantum=0.0, known=0.9):
        self.name = name
        self.left = random.integers(0, 256, (HEIGHT, WIDTH), dtype=numpy.uint8)
        self.left[:, :30] = 100 + random.integers(0, 5, (HEIGHT, 30))  # weak texture, in part
        self.right = random.integers(0, 256, (HEIGHT, WIDTH), dtype=numpy.uint8)
        truth = random.uniform(1, 20, (HEIGHT // 6 + 1, WIDTH // 9 + 1)).repeat(6, 0).repeat(9, 1)[:HEIGHT, :WIDTH]
        truth = truth + random.uniform(0, 0.8, truth.shape)
        truth[5:9, 5:20] += 60  # far enough off for the five percent of D1
        if quantum:
            truth = numpy.maximum(numpy.round(truth / quantum), 1) * quantum
        self.truth = numpy.where(random.random(truth.shape) < known, truth, numpy.nan).astype(numpy.float32)
        self.visible = None
        self.foreground = None

    def hide_some(self, random):
        self.visible = random.random(self.truth.shape) < 0.8
        return self.visible

    def write_pair(self, left, right):
        write(left, self.left)
        write(right, self.right)


def coded(truth, scale, kind):
    """Stored values; 0 where the truth is unknown."""
    return numpy.nan_to_num(truth.astype(float) * scale, nan=0).round().astype(kind)


def middlebury_v3(root, random, name):
    scene = Scene(random, name)
    folder = pathlib.Path(root) / name
    scene.write_pair(folder / "im0.png", folder / "im1.png")
    write(folder / "disp0GT.pfm", numpy.where(numpy.isnan(scene.truth), numpy.inf, scene.truth).astype(numpy.float32))
    write(folder / "mask0nocc.png", numpy.where(scene.hide_some(random), 255, 128).astype(numpy.uint8))
    return scene


def eth3d(root, random, name):
    scene = Scene(random, name)
    folder, truths = (pathlib.Path(root) / part / name for part in ("two_view_training", "two_view_training_gt"))
    scene.write_pair(folder / "im0.png", folder / "im1.png")
    write(truths / "disp0GT.pfm", numpy.where(numpy.isnan(scene.truth), numpy.inf, scene.truth).astype(numpy.float32))
    write(truths / "mask0nocc.png", numpy.where(scene.hide_some(random), 255, 0).astype(numpy.uint8))
    return scene


def visible_by_right(truth, right):
    """By both truths: the match lies in the right image, on a pixel with truth that is at most 1 px nearer."""
    visible = numpy.zeros(truth.shape, bool)
    for y, x in numpy.argwhere(~numpy.isnan(truth)):
        match = x - float(truth[y, x])
        at = int(numpy.floor(match + 0.5)) if match > -0.5 else -1
        visible[y, x] = 0 <= at < truth.shape[1] and not numpy.isnan(right[y, at]) and right[y, at] - truth[y, x] <= 1
    return visible


def middlebury_2003(root, random, name, eyes=("im2", "im6"), truths=("disp2", "disp6"), scale=4):
    """8-bit truth of both images; which pixels both cameras see follows from them."""
    scene = Scene(random, name, 1 / scale)
    scene.truth[scene.truth > 255 / scale] = numpy.nan
    right = numpy.where(random.random(scene.truth.shape) < 0.9, scene.truth + random.integers(-12, 13, scene.truth.shape) / scale, numpy.nan)
    right = numpy.clip(right, 1 / scale, 255 / scale)
    folder = pathlib.Path(root) / name
    scene.write_pair(folder / f"{eyes[0]}.ppm", folder / f"{eyes[1]}.ppm")
    write(folder / f"{truths[0]}.png", coded(scene.truth, scale, numpy.uint8))
    write(folder / f"{truths[1]}.png", coded(right, scale, numpy.uint8))
    scene.visible = visible_by_right(scene.truth, right)
    return scene


def tsukuba(root, random):
    scene = Scene(random, "tsukuba", 1)
    scene.truth[scene.truth > 15] = numpy.nan
    folder = pathlib.Path(root) / "tsukuba"
    scene.write_pair(folder / "scene1.row3.col3.ppm", folder / "scene1.row3.col4.ppm")
    write(folder / "truedisp.row3.col3.png", coded(scene.truth, 16, numpy.uint8))
    return scene


def kitti(root, random, frame, year=2015):
    scene = Scene(random, f"training/{frame}", 1 / 256, 0.3)
    folder = pathlib.Path(root) / "training"
    images, ending = (("image_2", "image_3"), "_0") if year == 2015 else (("image_0", "image_1"), "")
    scene.write_pair(folder / images[0] / f"{frame}.png", folder / images[1] / f"{frame}.png")
    write(folder / f"disp_occ{ending}" / f"{frame}.png", coded(scene.truth, 256, numpy.uint16))
    seen = numpy.where(scene.hide_some(random), scene.truth, numpy.nan)
    write(folder / f"disp_noc{ending}" / f"{frame}.png", coded(seen, 256, numpy.uint16))
    if year == 2015:
        objects = random.integers(0, 3, scene.truth.shape, dtype=numpy.uint8)
        write(folder / "obj_map" / f"{frame}.png", objects)
        scene.foreground = objects > 0
    return scene


def sintel(root, random, name):
    scene = Scene(random, name, 1 / 64, 1.0)
    folder = pathlib.Path(root) / "training"
    scene.write_pair(folder / "final_left" / f"{name}.png", folder / "final_right" / f"{name}.png")
    steps = coded(scene.truth, 16384, numpy.int64) + random.integers(0, 256, scene.truth.shape)
    scene.truth = (steps / 16384).astype(numpy.float32)
    bytes_of = [steps >> 16, steps >> 8 & 255, steps & 255]
    write(folder / "disparities" / f"{name}.png", numpy.stack(bytes_of, -1).astype(numpy.uint8))
    hidden, outside = (random.random(scene.truth.shape) < 0.1 for _ in range(2))
    write(folder / "occlusions" / f"{name}.png", (hidden * 255).astype(numpy.uint8))
    write(folder / "outofframe" / f"{name}.png", (outside * 255).astype(numpy.uint8))
    scene.visible = ~hidden & ~outside
    return scene


def scene_flow(root, random, place, frame):
    scene = Scene(random, f"{place}/{frame}", 0, 1.0)
    folder = pathlib.Path(root)
    scene.write_pair(*(folder / "frames_finalpass" / place / eye / f"{frame}.png" for eye in ("left", "right")))
    write(folder / "disparity" / place / "left" / f"{frame}.pfm", -scene.truth)
    right = (scene.truth + random.uniform(-2, 2, scene.truth.shape)).astype(numpy.float32)
    write(folder / "disparity" / place / "right" / f"{frame}.pfm", right)
    scene.visible = visible_by_right(scene.truth, numpy.abs(right))
    return scene


def driving_stereo(root, random, weather, frame, size="half"):
    scene = Scene(random, f"{weather}/{size}-size/{frame}", 1 / 128, 0.4)
    folder = pathlib.Path(root) / weather
    scene.write_pair(*(folder / f"{eye}-image-{size}-size" / f"{frame}.png" for eye in ("left", "right")))
    write(folder / f"disparity-map-{size}-size" / f"{frame}.png", coded(scene.truth, 256 if size == "half" else 128, numpy.uint16))
    return scene

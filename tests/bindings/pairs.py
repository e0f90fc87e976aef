# SPDX-License-Identifier: Apache-2.0
"""Pairs of images for the tests of the Python matcher, and what disparityctl finds in them."""
import pathlib
import subprocess
import sys
import tempfile

try:
    import numpy
except ImportError:
    print("skipped: numpy is not installed (python3-numpy)")
    sys.exit(77)

DISPARITYCTL, SOURCE = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
del sys.argv[1:3]


def drawn_pair(width=320, height=120, channels=1, seed=1):
    """Returns a rectified pair: random dots, smoothed, that are 9 px apart above and 20 px below, and unlike where nothing
    is behind it."""
    random = numpy.random.default_rng(seed)
    dots = random.integers(0, 256, (height, width + 64, channels)).astype(float)
    dots = (dots[:, :-2] + dots[:, 1:-1] + dots[:, 2:]) / 3
    left, right = dots[:, 32:32 + width], dots[:, 41:41 + width].copy()
    right[height // 2:] = dots[height // 2:, 52:52 + width]
    pair = [numpy.ascontiguousarray(image.round().astype(numpy.uint8)) for image in (left, right)]
    return tuple(image[:, :, 0] for image in pair) if channels == 1 else tuple(pair)


def write_pnm(path, image):
    """Writes PGM, or PPM of BGR."""
    magic, pixels = (b"P5", image) if image.ndim == 2 else (b"P6", image[:, :, ::-1])
    path.write_bytes(magic + b"\n%d %d\n255\n" % (image.shape[1], image.shape[0]) + pixels.tobytes())


def read_pfm(path):
    """Returns what a PFM of one channel holds, the upper row first."""
    magic, size, scale, values = path.read_bytes().split(b"\n", 3)
    assert magic == b"Pf" and float(scale) < 0, (magic, scale)
    width, height = map(int, size.split())
    return numpy.frombuffer(values, "<f4").reshape(height, width)[::-1]


def process(sources, *options):
    """Returns the disparities of each frame as disparityctl process has them, px, NaN where rejected."""
    with tempfile.TemporaryDirectory() as folder:
        made = subprocess.run([DISPARITYCTL, "process", *sources, "-o", folder + "/out", "--pfm", *options], capture_output=True, text=True,
                              check=False)
        assert made.returncode == 0, made.stderr
        maps = [read_pfm(path) for path in sorted(pathlib.Path(folder).glob("out/*.pfm"))]
    return [numpy.where(numpy.isinf(one), numpy.float32(numpy.nan), one) for one in maps]


def process_pair(pair, *options):
    with tempfile.TemporaryDirectory() as folder:
        names = [pathlib.Path(folder) / f"{eye}.{'pgm' if image.ndim == 2 else 'ppm'}" for eye, image in zip(("left", "right"), pair)]
        for name, image in zip(names, pair):
            write_pnm(name, image)
        return process(names, *options)[0]

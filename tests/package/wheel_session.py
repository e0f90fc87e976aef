# SPDX-License-Identifier: Apache-2.0
"""What programs do with disparity_matcher, for tests/package/wheels: prints a digest of each result, which are the same wherever it
runs. Needs Python 3.9 and numpy 1.19.

Usage: wheel_session.py [wheel]; with this word sources must be refused, as a wheel has none.
"""
import hashlib
import pathlib
import sys
import tempfile

import disparity_matcher as disparity
import numpy

WIDTH, HEIGHT = 320, 240
CALIBRATION = """%YAML:1.0
---
M1: !!opencv-matrix { rows: 3, cols: 3, dt: d, data: [ 265.6, 0, 161.2, 0, 265.3, 120.9, 0, 0, 1 ] }
D1: !!opencv-matrix { rows: 1, cols: 5, dt: d, data: [ -0.28, 0.09, 0.0004, -0.0003, -0.011 ] }
M2: !!opencv-matrix { rows: 3, cols: 3, dt: d, data: [ 266.0, 0, 159.4, 0, 265.8, 119.2, 0, 0, 1 ] }
D2: !!opencv-matrix { rows: 1, cols: 5, dt: d, data: [ -0.27, 0.08, -0.0002, 0.0005, -0.01 ] }
R: !!opencv-matrix { rows: 3, cols: 3, dt: d, data: [ 0.999977, -0.003012, -0.005994, 0.002988, 0.9999875, -0.004009, 0.006006, 0.003991, 0.999974 ] }
T: !!opencv-matrix { rows: 3, cols: 1, dt: d, data: [ -120, 0.9, -0.6 ] }
"""


def drawn_pair():
    """Smoothed dots, 5 to 40 px apart."""
    dots = numpy.arange(HEIGHT * (WIDTH + 64), dtype=numpy.uint32)
    for factor in (0x45D9F3B, 0x45D9F3B, 1):
        dots = (dots ^ (dots >> 16)) * numpy.uint32(factor)
    dots = (dots & 255).astype(int).reshape(HEIGHT, -1)
    dots = ((dots + numpy.roll(dots, 1, axis=1) + numpy.roll(dots, 2, axis=1)) // 3).astype(numpy.uint8)
    right = [row[shift:shift + WIDTH] for row, shift in zip(dots, numpy.linspace(5, 40, HEIGHT).astype(int))]
    return dots[:, :WIDTH].copy(), numpy.array(right)


def tell(name, *arrays):
    digest = hashlib.sha256()
    for array in arrays:
        digest.update(repr((array.dtype.str, array.shape)).encode() + array.tobytes())
    print(name, digest.hexdigest())


def main():
    pair = drawn_pair()
    for preset in ("dense", "obstacles", "paper"):
        found = disparity.match(*pair, preset=preset, disparities=64, f=265, baseline_mm=120)
        if (abs(found.disparity_px[100:140, 80:] - numpy.linspace(5, 40, HEIGHT).astype(int)[100:140, None]) < 1).mean() < 0.9:
            sys.exit(f"wheel_session.py: error: preset {preset} did not find what was drawn")
        tell(preset, found.disparity, found.confidence, found.depth_m, found.depth_error_m)
    tell("StereoSGM", disparity.StereoSGM_create(minDisparity=0, numDisparities=64, blockSize=5, P1=200, P2=800).compute(*pair))
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "stereo.yml"
        file.write_text(CALIBRATION, encoding="ascii")
        rectifier = disparity.Rectifier(disparity.load_calibration(file, (WIDTH, HEIGHT)))
    tell("rectified", *rectifier.rectify(*pair))
    print("maps", rectifier.calibration_id)
    tell("rectified and matched", disparity.Matcher(rectifier=rectifier, disparities=64).match(*pair).depth_m)
    if sys.argv[1:] == ["wheel"]:
        try:
            disparity.open("scene:vga")
        except RuntimeError as error:
            if "reads no sources" not in str(error):
                raise
        else:
            sys.exit("wheel_session.py: error: this is no wheel: it reads sources")


if __name__ == "__main__":
    main()

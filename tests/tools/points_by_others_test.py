# SPDX-License-Identifier: Apache-2.0
"""Points that `disparityctl process` writes, as other programs read them: PLY by meshio, PCD by the Point Cloud Library.

Usage: points_by_others_test.py DISPARITYCTL. Skipped (77) where neither is installed.
"""
import importlib.util
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest
import zlib

PCL = shutil.which("pcl_pcd2ply")
if importlib.util.find_spec("numpy") is None or (importlib.util.find_spec("meshio") is None and PCL is None):
    print("skipped: neither meshio (python3-meshio) nor the tools of PCL (pcl-tools) are installed, or no numpy")
    sys.exit(77)

import numpy  # noqa: E402

CTL = sys.argv.pop(1)


def pfm(path):
    _, size, _, pixels = path.read_bytes().split(b"\n", 3)
    width, height = map(int, size.split())
    return numpy.frombuffer(pixels, "<f4").reshape(height, width)[::-1]


class Points(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temporary.cleanup)
        cls.folder = pathlib.Path(temporary.name)
        for kind in ("ply", "pcd"):
            subprocess.run([CTL, "process", "scene:vga?width=96&height=64&frames=2", "-o", cls.folder / kind, "--points", kind,
                            "--pfm", "--rectified"], check=True, capture_output=True)

    def expect(self, points, colours):
        """Compares with what follows from disparity, calibration and left image."""
        camera = json.loads((self.folder / "ply/geometry.json").read_text())["rectified"]
        disparity = pfm(self.folder / "ply/000001.pfm")
        y, x = numpy.nonzero(numpy.isfinite(disparity) & (disparity > 0))
        z = camera["f"] * camera["baseline_mm"] / 1000 / disparity[y, x].astype(float)
        wanted = numpy.stack(((x - camera["cx"]) * z / camera["f"], (y - camera["cy"]) * z / camera["f"], z), 1)
        self.assertEqual(len(points), len(wanted))
        self.assertGreater(len(points), 1000)
        numpy.testing.assert_allclose(points, wanted, rtol=1e-4, atol=1e-6)
        left = self.left()
        numpy.testing.assert_array_equal(colours, left[y, x])

    def left(self):
        """The left image, red, green and blue, as Python alone reads it."""
        data, at, packed = (self.folder / "ply/000001_left.png").read_bytes(), 8, b""
        while at < len(data):
            size, kind = int.from_bytes(data[at:at + 4], "big"), data[at + 4:at + 8]
            packed += data[at + 8:at + 8 + size] if kind == b"IDAT" else b""
            at += size + 12
        rows = numpy.frombuffer(zlib.decompress(packed), numpy.uint8).reshape(64, 1 + 96 * 3)
        image = numpy.zeros((65, 97, 3), int)  # with a row above and a column to the left of zeros
        filters = (lambda a, b, c: 0, lambda a, b, c: a, lambda a, b, c: b, lambda a, b, c: (a + b) // 2,
                   lambda a, b, c: numpy.array([min(one, key=lambda v, p=one[0] + one[1] - one[2]: abs(p - v)) for one in zip(a, b, c)]))
        for y, row in enumerate(rows, 1):
            for x, pixel in enumerate(row[1:].reshape(96, 3), 1):
                image[y, x] = (pixel + filters[row[0]](image[y, x - 1], image[y - 1, x], image[y - 1, x - 1])) & 255
        return image[1:, 1:]

    @unittest.skipIf(importlib.util.find_spec("meshio") is None, "python3-meshio is not installed")
    def test_ply_by_meshio(self):
        import meshio  # pylint: disable=import-outside-toplevel
        found = meshio.read(self.folder / "ply/000001.ply")
        # meshio 5.0 takes unsigned bytes for signed ones.
        self.expect(found.points, numpy.stack([found.point_data[name].astype(numpy.uint8) for name in ("red", "green", "blue")], 1))

    @unittest.skipIf(PCL is None, "pcl-tools are not installed")
    def test_pcd_and_ply_by_pcl(self):
        text = self.folder / "points.ply"
        subprocess.run([PCL, "-format", "0", self.folder / "pcd/000001.pcd", text], check=True, capture_output=True)
        head, body = text.read_text().split("end_header\n")
        count = int(head.split("element vertex ")[1].split()[0])
        rows = numpy.array([line.split() for line in body.splitlines()[:count]], float)
        self.assertEqual(rows.shape[1], 6, "colours are one number where the field is not as PCL has it")
        self.expect(rows[:, :3], rows[:, 3:])
        again = self.folder / "points.pcd"
        subprocess.run([shutil.which("pcl_ply2pcd"), "-format", "0", self.folder / "ply/000001.ply", again], check=True, capture_output=True)
        rows = numpy.array([line.split() for line in again.read_text().split("DATA ascii\n")[1].splitlines()], float)
        packed = rows[:, 3].astype(numpy.uint32)
        self.expect(rows[:, :3], numpy.stack((packed >> 16, packed >> 8 & 255, packed & 255), 1))


if __name__ == "__main__":
    unittest.main()

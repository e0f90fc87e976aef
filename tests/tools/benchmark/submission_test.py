# SPDX-License-Identifier: Apache-2.0
"""`disparityctl process --submission`: made data sets of each benchmark, the folders that their servers take, and what
disparity-eval reads of them.

Usage: submission_test.py DISPARITYCTL DISPARITY_EVAL. Skipped (77) without numpy.
"""
import csv
import io
import pathlib
import subprocess
import sys
import tempfile
import unittest

try:
    import numpy
except ImportError:
    print("skipped: numpy is not installed (python3-numpy)")
    sys.exit(77)

import made_data

EVAL = sys.argv.pop(2)
CTL = sys.argv.pop(1)
SHIFT = 6


def pfm(path):
    head, size, scale, pixels = path.read_bytes().split(b"\n", 3)
    width, height = map(int, size.split())
    assert head == b"Pf" and float(scale) == -1
    return numpy.frombuffer(pixels, "<f4").reshape(height, width)[::-1]


class Submissions(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        self.data, self.submit = self.folder / "data", self.folder / "submit"
        self.random = numpy.random.default_rng(44)

    def process(self, *arguments, status=0, out="out"):
        done = subprocess.run([CTL, "process", "-o", self.folder / out, "--disparities", "16", *map(str, arguments)],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, status, done.stderr)
        return done.stderr

    def figures(self, results, data):
        """The rows of all pixels that disparity-eval prints, by scene."""
        done = subprocess.run([EVAL, "--benchmark", "--csv", "--region", "all", "--results", results, data],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        return {row["scene"]: row for row in csv.DictReader(io.StringIO(done.stdout)) if row["row"] == "scene"}

    def files(self):
        return sorted(str(path.relative_to(self.submit)) for path in self.submit.rglob("*") if path.is_file())

    def pair(self, left, right):
        """Overwrites both images by texture that is SHIFT px apart."""
        wide = self.random.integers(0, 256, (made_data.HEIGHT, made_data.WIDTH + SHIFT), dtype=numpy.uint8)
        made_data.write(left, wide[:, :-SHIFT])
        made_data.write(right, wide[:, SHIFT:])

    def test_kitti(self):
        for year, images, form in ((2015, (2, 3), "disp_0/{}.png"), (2012, (0, 1), "{}.png")):
            self.data, self.submit = self.folder / f"{year}/data", self.folder / f"{year}/submit"
            for frame in ("000000_10", "000007_10"):
                made_data.kitti(self.data, self.random, frame, year)
            for frame in ("000000_10", "000000_11", "000007_10"):
                self.pair(*(self.data / f"training/image_{i}/{frame}.png" for i in images))
            out = self.folder / f"{year}/out"
            said = self.process(self.data / "training", "--submission", f"kitti{year}={self.submit}", out=out)
            self.assertIn(": 2 results\n", said)
            names = [form.format(frame) for frame in ("000000_10", "000007_10")]
            self.assertEqual(self.files(), names)
            for name in names:
                self.assertEqual((self.submit / name).read_bytes(), (out / pathlib.Path(name).name).read_bytes())
            found = self.figures(self.submit, self.data)
            self.assertEqual(sorted(found), ["training/000000_10", "training/000007_10"])
            self.assertTrue(all(30 < float(row["density"]) < 100 for row in found.values()), found)

    def scenes(self, make, root, folder):
        names = ["Adirondack", "Pipes"]
        for name in names:
            make(root, self.random, name)
            self.pair(folder / name / "im0.png", folder / name / "im1.png")
        return [folder / name for name in names]

    def expect_dense(self, path, results):
        disparity = pfm(path)
        self.assertEqual(disparity.shape, (made_data.HEIGHT, made_data.WIDTH))
        self.assertTrue(numpy.isfinite(disparity).all())
        self.assertGreater((numpy.abs(disparity - SHIFT) < 1).mean(), 0.8)
        self.assertEqual({float(row["density"]) for row in results.values()}, {100})

    def test_middlebury(self):
        root = self.data / "MiddEval3/trainingQ"
        sources = self.scenes(made_data.middlebury_v3, root, root)
        self.process(*sources, "--submission", f"middlebury={self.submit}", "--submission-name", "mine")
        self.assertEqual(self.files(), [f"trainingQ/{name}/{file}" for name in ("Adirondack", "Pipes")
                                        for file in ("disp0mine.pfm", "timemine.txt")])
        self.assertGreater(float((self.submit / "trainingQ/Pipes/timemine.txt").read_text()), 0)
        self.expect_dense(self.submit / "trainingQ/Pipes/disp0mine.pfm", self.figures(self.submit / "trainingQ", root))
        # What is gone comes back, though the sources are left alone.
        (self.submit / "trainingQ/Pipes/disp0mine.pfm").unlink()
        self.process(*sources, "--submission", f"middlebury={self.submit}", "--submission-name", "mine", "--resume")
        self.expect_dense(self.submit / "trainingQ/Pipes/disp0mine.pfm", self.figures(self.submit / "trainingQ", root))

    def test_eth3d(self):
        sources = self.scenes(made_data.eth3d, self.data, self.data / "two_view_training")
        self.process(*sources, "--pfm", "--submission", f"eth3d={self.submit}")
        self.assertEqual(self.files(), [f"low_res_two_view/{name}" for name in
                                        ("Adirondack.pfm", "Adirondack.txt", "Pipes.pfm", "Pipes.txt")])
        self.assertRegex((self.submit / "low_res_two_view/Pipes.txt").read_text(), r"\Aruntime \d+\.\d+\n\Z")
        self.expect_dense(self.submit / "low_res_two_view/Pipes.pfm", self.figures(self.submit, self.data))

    def test_what_is_not_of_the_form_is_refused(self):
        root = self.data / "trainingQ"
        scene = self.scenes(made_data.middlebury_v3, root, root)[0]

        def refused(line, *arguments, status=2):
            self.assertIn(line, self.process(*arguments, status=status))
            self.assertFalse(self.submit.exists())

        refused("--submission: found 'kitti=x', allowed: kitti2012=FOLDER", scene, "--submission", "kitti=x")
        refused("lies in", scene, "--submission", f"eth3d={self.folder}/out/submit")
        refused("--submission-name: found 'a_s'", scene, "--submission", f"middlebury={self.submit}", "--submission-name", "a_s")
        other = self.scenes(made_data.middlebury_v3, self.data / "again/trainingQ", self.data / "again/trainingQ")[0]
        refused("are scenes of the same name", scene, other, "--submission", f"middlebury={self.submit}")
        refused("are scenes of the same name", scene, other, "--submission", f"eth3d={self.submit}")
        refused("found 2 sources, whose frames may have the same names", scene, other, "--submission", f"kitti2012={self.submit}")
        self.assertFalse((self.folder / "out").exists())
        refused("im0.png: is no frame of KITTI", scene, "--submission", f"kitti2015={self.submit}", status=1)
        for frame in "ab":
            self.pair(self.data / f"two/left/{frame}.png", self.data / f"two/right/{frame}.png")
        refused("has 2 frames, allowed: the folder of a scene", self.data / "two", "--force", "--submission",
                f"eth3d={self.submit}", status=1)
        refused("were rectified, scaled or cut here", "scene:vga?width=96&height=64&frames=1", "--force", "--submission",
                f"eth3d={self.submit}", status=1)
        refused("were rectified, scaled or cut here", scene, "--force", "--region", "0,0,48,32",
                "--submission", f"eth3d={self.submit}", status=1)
        for eye in ("im0.png", "im1.png"):
            made_data.write(scene / eye, numpy.full((made_data.HEIGHT, made_data.WIDTH), 90, numpy.uint8))
        refused("nothing was measured", scene, "--force", "--submission", f"eth3d={self.submit}", status=1)
        self.submit.mkdir()
        (self.submit / "mine").touch()
        self.assertIn("is not empty, allowed: a new or empty folder", self.process(
            scene, "--submission", f"eth3d={self.submit}", status=2, out="new"))


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: Apache-2.0
"""disparity-eval --benchmark tells of each scene that it cannot judge, in a line of its own, and leaves none out in silence.

Usage: refusals_test.py DISPARITY_EVAL. Skipped (77) without numpy.
"""
import pathlib
import shutil
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

EVAL = sys.argv.pop(1)


class Refusals(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        self.data, self.results = self.folder / "data", self.folder / "results"
        random = numpy.random.default_rng(7)
        for name in ("Pipes", "Piano"):
            scene = made_data.middlebury_v3(self.data, random, name)
            made_data.write(self.results / f"{name}.pfm", scene.truth)

    def told(self, *arguments, status=2):
        """Lines on stderr without the program's name."""
        done = subprocess.run([EVAL, *map(str, arguments or ("--benchmark", "--results", self.results, self.data))],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, status, done.stderr)
        self.assertEqual(bool(done.stdout), status == 0)
        return [line.removeprefix("disparity-eval: ") for line in done.stderr.splitlines()]

    def test_each_missing_and_wrong_result_has_a_line(self):
        (self.results / "Piano.pfm").unlink()
        missing = f"note: Piano: results has no file in {self.results}, such as Piano.pfm or Piano.png"
        self.assertEqual(self.told(), [missing, "error: 1 result cannot be judged, as told above: correct this, or judge the others with --incomplete"])
        self.assertEqual(self.told("--benchmark", "--incomplete", "--results", self.results, self.data, status=0), [missing])
        pattern = f"x={self.results}/{{scene}}.pfm"
        self.assertEqual(self.told("--benchmark", "--results", pattern, self.data)[0], f"note: Piano: x has no file {self.results}/Piano.pfm")
        made_data.write(self.results / "Piano.png", numpy.zeros((made_data.HEIGHT, made_data.WIDTH), numpy.uint8))
        made_data.write(self.results / "Pipes.pfm", numpy.zeros((made_data.HEIGHT, made_data.WIDTH // 2), numpy.float32))
        lines = self.told()
        self.assertEqual(len(lines), 3, lines)
        self.assertRegex(lines[0], r"^note: Piano: .*Piano.png: found 1 channels? of 8 bits; allowed: one channel of 16 bits")
        self.assertRegex(lines[1], r"^note: Pipes: .*Pipes.pfm: found 30x37 px, allowed: 61x37, the size of the ground truth$")
        self.assertRegex(lines[2], r"^error: 2 results cannot be judged")
        lines = self.told("--benchmark", "--incomplete", "--results", self.results, self.data)
        self.assertEqual(lines[2], "error: nothing is left to judge: each result is missing or cannot be read")

    def test_two_files_that_could_be_meant(self):
        shutil.copytree(self.results, self.results / "Piano")
        (self.results / "Piano/Piano.pfm").rename(self.results / "Piano/disp0MINE.pfm")
        lines = self.told()
        self.assertRegex(lines[0], r"note: Piano: results has .*/Piano\.pfm and .*/Piano/disp0MINE\.pfm; say which by a pattern, such as")

    def test_the_truth_is_no_result(self):
        # Results lie beside the truth where Middlebury's SDK puts them.
        self.assertRegex(self.told("--benchmark", "--results", self.data, self.data)[0], "note: Piano: data has no file in ")
        for name in ("Piano", "Pipes"):
            shutil.copy(self.results / f"{name}.pfm", self.data / name / "disp0MINE.pfm")
        self.assertEqual(self.told("--benchmark", "--results", self.data, self.data, status=0), [])
        truth = ", which is the ground truth; say by a pattern which file is the result$"
        pattern = f"x={self.data}/{{scene}}/disp0GT.pfm"
        self.assertRegex(self.told("--benchmark", "--results", pattern, self.data)[0], "Piano: x has .*/data/Piano/disp0GT.pfm" + truth)
        for name in ("Piano", "Pipes"):  # as the sets of 2014 and 2021 name it
            (self.data / name / "disp0MINE.pfm").unlink()
            (self.data / name / "disp0GT.pfm").rename(self.data / name / "disp0.pfm")
        self.assertRegex(self.told("--benchmark", "--results", self.data, self.data)[0], "Piano: data has .*/data/Piano/disp0.pfm" + truth)
        made_data.kitti(self.folder / "kitti", numpy.random.default_rng(8), "000000_10")
        results = self.folder / "kitti/training/disp_noc_0"
        self.assertRegex(self.told("--benchmark", "--results", results, self.folder / "kitti")[0], "has .*disp_noc_0/000000_10.png" + truth)

    def test_a_matcher_that_is_named_twice_runs_once(self):
        twice = ["--method", "all", "--method", "sgm", "--backend", "cpu", "--backend", "cpu"]
        out = subprocess.run([EVAL, "--benchmark", *twice, "--region", "all", "--csv", self.data], capture_output=True, text=True, check=True).stdout
        matchers = [line.split(",")[2] for line in out.splitlines() if line.startswith("scene,Piano,")]
        self.assertEqual(sorted(matchers), ["census cpu", "sad cpu", "sgm cpu"])

    def test_confidences(self):
        self.assertRegex(self.told("--benchmark", "--results", self.results, "--confidences", f"y={self.results}", self.data)[0],
                         "--confidences: no --results have the name 'y'")
        made_data.write(self.folder / "sure/Piano.pfm", numpy.full((made_data.HEIGHT, made_data.WIDTH), numpy.nan, numpy.float32))
        lines = self.told("--benchmark", "--results", self.results, "--confidences", f"results={self.folder}/sure", self.data)
        self.assertEqual([line.split(":")[1] for line in lines[:1]], [" Pipes"])
        made_data.write(self.folder / "sure/Pipes.png", numpy.zeros((made_data.HEIGHT, made_data.WIDTH), numpy.uint8))
        lines = self.told("--benchmark", "--results", self.results, "--confidences", f"results={self.folder}/sure", self.data)
        self.assertRegex(lines[0], "Piano.pfm: found a confidence that is not finite")

    def test_data_without_truth_or_without_an_image_is_told(self):
        (self.data / "Piano/disp0GT.pfm").unlink()
        self.assertEqual(self.told("--benchmark", "--results", self.results, self.data, status=0),
                         [f"note: {self.data}/Piano: has im0 and im1 and no ground truth, such as disp0.pfm or disp0GT.pfm"])
        random = numpy.random.default_rng(8)
        made_data.kitti(self.data / "kitti", random, "000000_10")
        made_data.kitti(self.data / "kitti", random, "000001_10")
        made_data.kitti(self.data / "kitti", random, "000002_10")
        (self.data / "kitti/training/image_3/000000_10.png").unlink()
        for folder in ("occ", "noc"):
            (self.data / f"kitti/training/disp_{folder}_0/000001_10.png").unlink()
        (self.data / "kitti/training/image_2/000002_10.png").unlink()
        lines = self.told("--benchmark", self.data / "kitti")
        self.assertEqual(len(lines), 4, lines)
        self.assertRegex(lines[0], "image_2/000000_10.png: has no right image")
        self.assertRegex(lines[1], "image_2/000001_10.png: has no ground truth in disp_occ_0")
        self.assertRegex(lines[2], "000002_10.png: has ground truth and no image in image_2/image_3")
        self.assertRegex(lines[3], "^error: .*: found no scene with ground truth")
        made_data.sintel(self.data / "sintel", random, "alley_1/frame_0001")
        shutil.rmtree(self.data / "sintel/training/disparities")
        self.assertRegex(self.told("--benchmark", self.data / "sintel")[0], "final_left: has no ground truth .*/disparities$")
        made_data.driving_stereo(self.data / "driving", random, "foggy", "1")
        shutil.rmtree(self.data / "driving/foggy/right-image-half-size")
        self.assertRegex(self.told("--benchmark", self.data / "driving")[0], "left-image-half-size: has no .*/right-image-half-size beside it$")
        made_data.scene_flow(self.data / "flow", random, "TRAIN/A/0000", "0006")
        (self.data / "flow/disparity/TRAIN/A/0000/left/0006.pfm").unlink()
        self.assertRegex(self.told("--benchmark", self.data / "flow")[0], "left/0006.png: has no ground truth .*/left/0006.pfm$")

    def test_scenes_of_one_name_and_options_that_do_nothing(self):
        shutil.copytree(self.data, self.folder / "again")
        self.assertRegex(self.told("--benchmark", "--results", self.results, self.data, self.folder / "again")[0], "Piano: two scenes have this name")
        for options, line in ((["--preset", "dense"], "found options of matching, but nothing is matched here"),
                              (["--region", "sky"], "--region: found 'sky', allowed: all, nonocc, edges, weak-texture, bg"),
                              (["--holes", "many"], "--holes: found 'many', allowed: bad, left-out, filled"),
                              (["--results", self.results], "--results: two have the name 'results'"),
                              (["--results", self.folder / "absent"], "absent: is no folder and no pattern"),
                              (["--json", "--csv"], "excludes")):
            self.assertIn(line, " ".join(self.told("--benchmark", "--results", self.results, *options, self.data)))
        self.assertIn("--benchmark", " ".join(self.told("--results", self.results, self.data)))

    def test_both_passes(self):
        random = numpy.random.default_rng(9)
        made_data.sintel(self.data / "sintel", random, "alley_1/frame_0001")
        training = self.data / "sintel/training"
        for eye in ("left", "right"):
            shutil.copytree(training / f"final_{eye}", training / f"clean_{eye}")
            shutil.copytree(training / f"clean_{eye}/alley_1", training / f"clean_{eye}/alley_2")
        shutil.copytree(training / "disparities/alley_1", training / "disparities/alley_2")
        for given, scenes in ((training, 1), (training / "clean_left", 2)):
            out = subprocess.run([EVAL, "--benchmark", "--region", "all", "--csv", given], capture_output=True, text=True, check=True).stdout
            self.assertEqual(sum(line.startswith("scene,") for line in out.splitlines()), scenes, out)


if __name__ == "__main__":
    unittest.main()

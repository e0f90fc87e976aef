# SPDX-License-Identifier: Apache-2.0
"""disparity-eval --benchmark against numpy: every figure of small random scenes in every layout, through files.

Usage: numbers_test.py DISPARITY_EVAL. Skipped (77) without numpy.
"""
import csv
import io
import json
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

import expected_figures
import made_data

EVAL = sys.argv.pop(1)


def evaluate(*arguments, check=True):
    return subprocess.run([EVAL, "--benchmark", *map(str, arguments)], capture_output=True, text=True, check=check)


class Results:
    """Disparity maps of a program that does not exist, as PFM and as KITTI's PNG, with confidences."""

    def __init__(self, folder, random, scenes):
        self.folder, self.maps, self.confidences = pathlib.Path(folder), {"pfm": {}, "png": {}}, {}
        for scene in scenes:
            errors = random.choice([0.3, 1.2, 5.0], scene.truth.shape) * random.standard_normal(scene.truth.shape)
            found = numpy.nan_to_num(scene.truth, nan=7.0) + errors
            found[random.random(found.shape) < 0.1] = numpy.nan
            found[:3] = numpy.nan  # whole rows, for the filling
            found[-2:] = numpy.nan
            found[20] = numpy.nan
            self.maps["pfm"][scene.name] = found.astype(numpy.float32)
            stored = made_data.coded(numpy.clip(found, 0, 255), 256, numpy.uint16)
            self.maps["png"][scene.name] = numpy.where(stored == 0, numpy.nan, stored / 256).astype(numpy.float32)
            self.confidences[scene.name] = random.integers(0, 9, found.shape).astype(numpy.uint8)  # many are equal
            made_data.write(self.folder / "pfm" / f"{scene.name}.pfm", self.maps["pfm"][scene.name])
            made_data.write(self.folder / "png" / scene.name.replace("/", "_") / "result.png", stored)
            made_data.write(self.folder / "sure" / f"{scene.name}.png", self.confidences[scene.name])

    def options(self):
        return ["--results", f"a={self.folder}/pfm", "--confidences", f"a={self.folder}/sure/{{folder}}/{{frame}}.png",
                "--results", f"b={self.folder}/renamed/{{frame}}.png"]

    def rename(self, scenes):
        """The PNG files by their frames' names, which are unique here."""
        for scene in scenes:
            path = self.folder / "png" / scene.name.replace("/", "_") / "result.png"
            made_data.write(self.folder / "renamed" / (scene.name.split("/")[-1] + ".png"), path.read_bytes())


class Numbers(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        self.random = numpy.random.default_rng(44)

    def expected(self, scenes, results, holes):
        """{(kind, scene, matcher, region): (pixels, figures)}, computed by numpy."""
        rows, tallies = {}, {}
        for scene in scenes:
            for matcher, kind in (("a", "pfm"), ("b", "png")):
                confidence = results.confidences[scene.name] if matcher == "a" else None
                for region, mask in expected_figures.regions(scene).items():
                    one = expected_figures.Tally(mask, scene.truth, results.maps[kind][scene.name], confidence, holes)
                    rows["scene", scene.name, matcher, region] = one.pixels, one.figures()
                    tallies.setdefault((matcher, region), []).append((scene.name, one))
        for (matcher, region), named in tallies.items():
            figures, pixels = [one.figures() for _, one in named], sum(one.pixels for _, one in named)
            rows["mean", "", matcher, region] = pixels, expected_figures.mean(figures, [1] * len(named))
            rows["pixel-mean", "", matcher, region] = pixels, expected_figures.added([one for _, one in named]).figures(False)
            if all(name.startswith("P") or name == "Teddy" for name, _ in named):
                weights = [0.5 if name in expected_figures.V3_HALF else 1 for name, _ in named]
                rows["middlebury-v3-mean", "", matcher, region] = pixels, expected_figures.mean(figures, weights)
        return rows

    def compare(self, data, scenes):
        results = Results(self.folder / "results", self.random, scenes)
        results.rename(scenes)
        for holes in ("bad", "left-out", "filled"):
            said = evaluate(*results.options(), "--holes", holes, "--csv", data)
            self.assertEqual(said.stderr, "")
            expected = self.expected(scenes, results, holes)
            found = {tuple(row[name] for name in ("row", "scene", "matcher", "region")): row for row in csv.DictReader(io.StringIO(said.stdout))}
            self.assertEqual(set(found), set(expected))
            for key, (pixels, figures) in expected.items():
                self.assertEqual(int(found[key]["pixels"]), pixels, key)
                for name, value in zip(expected_figures.FIGURES, figures):
                    self.assertEqual(found[key][name], "" if value is None else f"{value:.4f}", (holes, *key, name))
        return results

    def test_every_layout(self):
        data, random = self.folder / "data", self.random
        scenes = [made_data.middlebury_v3(data / "MiddEval3/trainingQ", random, "Jadeplant"),
                  made_data.middlebury_2003(data / "2003", random, "cones"),
                  made_data.middlebury_2003(data / "2003", random, "teddyH", scale=2),
                  made_data.middlebury_2003(data / "2006/FullSize", random, "Aloe", ("view1", "view5"), ("disp1", "disp5"), 1),
                  made_data.tsukuba(data / "2001", random),
                  made_data.eth3d(data / "eth3d", random, "delivery_area_1l"),
                  made_data.kitti(data / "kitti", random, "000000_10"), made_data.kitti(data / "kitti", random, "000001_10"),
                  made_data.sintel(data / "sintel", random, "alley_1/frame_0001"),
                  made_data.scene_flow(data / "sceneflow", random, "TRAIN/A/0000", "0006"),
                  made_data.driving_stereo(data / "driving", random, "foggy", "2018-10-25-07-37"),
                  made_data.driving_stereo(data / "driving", random, "sunny", "2018-10-19-09-30", "full")]
        # Of KITTI's second frames there is no truth, and nothing is missing.
        made_data.Scene(random, "").write_pair(*(data / f"kitti/training/image_{i}/000000_11.png" for i in (2, 3)))
        self.compare(data, scenes)

    def test_kitti_2012(self):
        self.compare(self.folder / "data", [made_data.kitti(self.folder / "data", self.random, "000007_10", 2012)])

    def test_middleburys_weights(self):
        data = self.folder / "data"
        results = self.compare(data, [made_data.middlebury_v3(data, self.random, name) for name in ("Pipes", "PianoL", "Teddy", "Playtable")])
        text = evaluate(*results.options()[:4], "--region", "nonocc", data).stdout.splitlines()
        self.assertEqual([line.split()[0] for line in text], ["scene", "PianoL", "Pipes", "Playtable", "Teddy", "mean", "pixel-mean", "middlebury-v3-mean"])

    def test_json_says_the_same_and_has_the_curves(self):
        data = self.folder / "data"
        scenes = [made_data.middlebury_v3(data, self.random, "Pipes")]
        results = Results(self.folder / "results", self.random, scenes)
        said = json.loads(evaluate(*results.options()[:4], "--json", data).stdout)
        self.assertEqual(said["holes"], "bad")
        for row in said["rows"]:
            pixels, figures = self.expected(scenes, results, "bad")[row["row"], row["scene"] or "", row["matcher"], row["region"]]
            self.assertEqual(row["pixels"], pixels)
            for name, value in zip(expected_figures.FIGURES, figures):
                self.assertEqual(row[name] is None, value is None, name)
                self.assertAlmostEqual(row[name] or 0, value or 0, delta=0.500001e-4, msg=name)
        curve = next(one for one in said["curves"] if one["region"] == "all")
        tally = expected_figures.Tally(expected_figures.regions(scenes[0])["all"], scenes[0].truth, results.maps["pfm"]["Pipes"],
                                       results.confidences["Pipes"], "bad")
        self.assertEqual(curve["removed_percent"], list(range(0, 100, 5)))
        for name, expected in zip(("error_px", "best_px"), tally.curves):
            numpy.testing.assert_allclose(curve[name], expected[::5], atol=0.500001e-4)

    def test_a_perfect_and_an_empty_result(self):
        data = self.folder / "data"
        scene = made_data.middlebury_v3(data, self.random, "Pipes")
        made_data.write(self.folder / "perfect/Pipes.pfm", scene.truth)
        made_data.write(self.folder / "empty/Pipes.pfm", numpy.full_like(scene.truth, numpy.nan))
        for holes in ("bad", "left-out", "filled"):
            rows = json.loads(evaluate("--results", self.folder / "perfect", "--results", self.folder / "empty", "--holes", holes,
                                       "--region", "all", "--json", data).stdout)["rows"]
            perfect, empty = (next(row for row in rows if row["matcher"] == name) for name in ("perfect", "empty"))
            self.assertEqual([perfect[name] for name in ("density", "bad_05", "d1", "avg_px", "a99_px", "ause_px")], [100, 0, 0, 0, 0, None])
            bad = None if holes == "left-out" else 100
            self.assertEqual([empty[name] for name in ("density", "bad_05", "bad_4", "d1", "avg_px", "a50_px")], [0, bad, bad, bad, None, None])


if __name__ == "__main__":
    unittest.main()

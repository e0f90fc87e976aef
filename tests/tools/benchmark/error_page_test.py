# SPDX-License-Identifier: Apache-2.0
"""The page of disparity-eval --benchmark --output: whole in its folder, the worst first.

Usage: error_page_test.py DISPARITY_EVAL. Skipped (77) without numpy.
"""
import html.parser
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

import made_data

EVAL = sys.argv.pop(1)


class Page(html.parser.HTMLParser):
    """What a browser would load, the headings in their order, the texts of scripts, and whether all elements are closed."""

    VOID = {"meta", "img"}

    def __init__(self, text):
        super().__init__()
        self.loaded, self.headings, self.scripts, self.open, self.points = [], [], [], [], []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.loaded += [value for name, value in attrs if name in ("src", "href")]
        self.points += [value for name, value in attrs if name == "points"]
        if tag not in self.VOID:
            self.open.append(tag)
        if tag == "h2":
            self.headings.append("")
        if tag == "script":
            self.scripts.append("")

    def handle_startendtag(self, tag, attrs):
        self.handle_starttag(tag, attrs)
        self.open.pop()

    def handle_endtag(self, tag):
        assert self.open.pop() == tag, tag

    def handle_data(self, data):
        if "h2" in self.open:
            self.headings[-1] += data
        if "script" in self.open:
            self.scripts[-1] += data


class ErrorPage(unittest.TestCase):
    def test_it_is_whole_and_sorted(self):
        with tempfile.TemporaryDirectory() as temporary:
            folder, random = pathlib.Path(temporary), numpy.random.default_rng(3)
            wrong = {"a<b>": 1.5, "best": 0, "worst": 1.5}
            for i, (name, error) in enumerate(wrong.items()):
                scene = made_data.middlebury_v3(folder / "data", random, name)
                errors = numpy.where(random.random(scene.truth.shape) < 0.3 * i, error, 0).astype(numpy.float32)
                for matcher in ("one", "two"):
                    made_data.write(folder / matcher / f"{name}.pfm", scene.truth + errors + (5 if matcher == "two" else 0))
                made_data.write(folder / "sure" / f"{name}.png", random.integers(0, 256, scene.truth.shape, dtype=numpy.uint8))
            subprocess.run([EVAL, "--benchmark", "--results", folder / "one", "--confidences", f"one={folder}/sure", "--results", folder / "two", "-o", folder / "page", folder / "data"],
                           check=True, capture_output=True)
            page = Page((folder / "page/index.html").read_text(encoding="utf-8"))
            self.assertEqual(page.open, [])
            self.assertEqual(page.headings, ["a<b> two", "best two", "worst two", "worst one", "a<b> one", "best one"])
            self.assertEqual({pathlib.Path(file) for file in page.loaded} | {pathlib.Path("index.html")},
                             {file.relative_to(folder / "page") for file in (folder / "page").iterdir()})
            self.assertEqual(len(page.points), 2 * 3)
            for points in page.points:
                numbers = [[float(number) for number in point.split(",")] for point in points.split()]
                self.assertEqual(len(numbers), 100)
                self.assertTrue(all(52 <= x <= 350 and 12 <= y <= 168 for x, y in numbers), numbers)
            results = json.loads(page.scripts[0])
            self.assertEqual([result["matcher"] for result in results], ["one", "two"] * 3)
            self.assertEqual(set(results[0]["regions"]), {"all", "nonocc", "edges", "weak-texture"})
            self.assertNotIn("http", page.scripts[1])


if __name__ == "__main__":
    unittest.main()

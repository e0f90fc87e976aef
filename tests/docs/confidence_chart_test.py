# SPDX-License-Identifier: Apache-2.0
"""The chart of confidence and error shows the numbers that it is made from, and the page shows the chart.

Usage: confidence_chart_test.py
"""
import pathlib
import sys
import unittest
import xml.etree.ElementTree as ElementTree

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools/docs"))
import confidence_chart as chart  # noqa: E402

SVG = "{http://www.w3.org/2000/svg}"


def result(pixels, right, sigmas):
    """A result of disparity-eval. pixels and right: {confidence: number}; sigmas: {bin: px}."""
    return {"weight": [pixels.get(value, 0) for value in range(256)],
            "right": [right.get(value, 0) for value in range(256)],
            "sigma_px_of_bins": [sigmas.get(index) for index in range(16)]}


class Chart(unittest.TestCase):
    def test_a_point_is_the_mean_of_its_bin(self):
        found = chart.points(result({170: 2, 174: 2, 250: 96}, {170: 1, 174: 1, 250: 96}, {10: 0.4, 15: 0.2}))
        self.assertEqual(found, [(172, 0.4, 50), (250, 0.2, 0)])

    def test_bins_with_few_pixels_are_left_out(self):
        found = chart.points(result({170: 1, 250: 9999}, {170: 1, 250: 9999}, {10: 0.4, 15: 0.2}))
        self.assertEqual([at for at, _, _ in found], [250])

    def test_each_line_has_its_points_in_both_plots(self):
        picture = ElementTree.fromstring(chart.svg_text([("one", [(160, 0.6, 50), (256, 0, 0)]), ("two", [])]).encode())
        lines = [element.get("points") for element in picture.iter(SVG + "polyline")]
        left, right = chart.LEFT, chart.LEFT + chart.PLOT_WIDTH + chart.GAP
        top, bottom = chart.TOP, chart.TOP + chart.PLOT_HEIGHT
        self.assertEqual(lines[:2], [f"{x:.1f},{top:.1f} {x + chart.PLOT_WIDTH:.1f},{bottom:.1f}" for x in (left, right)])
        words = [element.text for element in picture.iter(SVG + "text")]
        self.assertTrue({"one", "two"} <= set(words))

    def test_the_page_shows_it(self):
        self.assertIn(f"]({chart.PICTURE.name})", (chart.PICTURE.parent / "accuracy.md").read_text(encoding="utf-8"))
        ElementTree.fromstring(chart.PICTURE.read_bytes())


if __name__ == "__main__":
    unittest.main()

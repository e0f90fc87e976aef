# SPDX-License-Identifier: Apache-2.0
"""The table of docs/distances.md is the one that tools/docs/depth_limits.py prints, and its numbers are right."""
import pathlib
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools" / "docs"))
import depth_limits  # noqa: E402


class DepthLimits(unittest.TestCase):
    def test_the_page_has_the_table(self):
        page = (ROOT / "docs" / "distances.md").read_text(encoding="utf-8")
        self.assertIn(depth_limits.table(), page, "run tools/docs/depth_limits.py and put its table into the page")

    def test_a_zed_at_vga(self):
        fb = 350 * 0.120
        self.assertEqual(depth_limits.nearest(fb, 64), 0.67)
        self.assertEqual(depth_limits.disparities_for(fb, 0.5), 96)
        self.assertIsNone(depth_limits.disparities_for(fb, 0.1))
        self.assertAlmostEqual(depth_limits.error(fb, 5, 1), 42 / 7.4 - 5)
        self.assertIsNone(depth_limits.error(fb, 50, 1))


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: Apache-2.0
"""The programs of docs/python.md run as they stand there.

Usage: page_test.py DISPARITYCTL SOURCE. What needs matplotlib is skipped without it, said on standard output.
"""
import contextlib
import importlib.util
import io
import math
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

from pairs import DISPARITYCTL, SOURCE, drawn_pair, numpy, write_pnm

PROGRAMS = re.findall(r"^```python\n(.*?)^```", (SOURCE / "docs/python.md").read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)


class Page(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(temporary.name)
        os.environ.update(MPLBACKEND="Agg", MPLCONFIGDIR=temporary.name)

    def said(self, program, names=None):
        """Runs it; `names` gets its variables."""
        with contextlib.redirect_stdout(io.StringIO()) as said:
            exec(compile(program, "docs/python.md", "exec"), {} if names is None else names)  # pylint: disable=exec-used
        return said.getvalue()

    def test_a_pair(self):
        self.assertLessEqual(len(PROGRAMS[0].strip().splitlines()), 15)
        for eye, image in zip(("left", "right"), drawn_pair()):
            write_pnm(pathlib.Path(f"{eye}.pgm"), image)
        program = PROGRAMS[0].replace("left.png,right.png", "left.pgm,right.pgm")
        said = r"^\d+% of the pixels have a disparity\n$"
        if importlib.util.find_spec("matplotlib") is None:
            print("skipped: the plot of docs/python.md: matplotlib is not installed (python3-matplotlib)")
            program = "\n".join(line for line in program.splitlines() if not re.search("plot|axes|axis|figure|truth|shown", line))
            self.assertRegex(self.said(program), said)
            return
        names = {}
        self.assertRegex(self.said(program, names), said)
        self.assertNotIn("error, px", names["shown"])
        self.assertEqual(pathlib.Path("disparity.png").read_bytes()[:4], b"\x89PNG")
        # The same with a truth, of which some is not known.
        from PIL import Image  # pylint: disable=import-outside-toplevel
        truth = numpy.full(names["found"].disparity.shape, 20 * 256, numpy.uint16)
        truth[:truth.shape[0] // 2] = 9 * 256
        truth[:, :100] = 0
        Image.fromarray(truth).save("truth.png")
        self.assertRegex(self.said(program, names), said)
        error = names["shown"]["error, px"]
        self.assertTrue(numpy.isnan(error[:, :100]).all())
        self.assertLess(numpy.nanmedian(error), 0.1)

    def test_many_pairs(self):
        subprocess.run([DISPARITYCTL, "record", "--source", "scene:vga?width=320&height=180&frames=2", "walk.mkv"], check=True, capture_output=True)
        lines = self.said(PROGRAMS[1]).splitlines()
        # In real time a busy machine loses frames.
        self.assertIn([line.split()[0] for line in lines], (["0", "1"], ["0"], ["1"]))
        self.assertTrue(all(math.isfinite(float(line.split()[3])) for line in lines), lines)


if __name__ == "__main__":
    unittest.main()

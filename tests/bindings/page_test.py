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

from pairs import DISPARITYCTL, SOURCE, drawn_pair, write_pnm

PROGRAMS = re.findall(r"^```python\n(.*?)^```", (SOURCE / "docs/python.md").read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)


class Page(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(temporary.name)
        os.environ.update(MPLBACKEND="Agg", MPLCONFIGDIR=temporary.name)

    def said(self, program):
        with contextlib.redirect_stdout(io.StringIO()) as said:
            exec(compile(program, "docs/python.md", "exec"), {})  # pylint: disable=exec-used
        return said.getvalue()

    def test_a_pair(self):
        self.assertLessEqual(len(PROGRAMS[0].strip().splitlines()), 15)
        for eye, image in zip(("left", "right"), drawn_pair()):
            write_pnm(pathlib.Path(f"{eye}.pgm"), image)
        program = PROGRAMS[0].replace("left.png,right.png", "left.pgm,right.pgm")
        if importlib.util.find_spec("matplotlib") is None:
            print("skipped: the plot of docs/python.md: matplotlib is not installed (python3-matplotlib)")
            program = "\n".join(line for line in program.splitlines() if not re.search("plot|axes|axis|figure", line))
        self.assertRegex(self.said(program), r"^\d+% of the pixels have a disparity\n\d+\.\d\d m is the median distance\n$")
        if "savefig" in program:
            self.assertEqual(pathlib.Path("disparity.png").read_bytes()[:4], b"\x89PNG")

    def test_many_pairs(self):
        subprocess.run([DISPARITYCTL, "record", "--source", "scene:vga?width=320&height=180&frames=2", "walk.mkv"], check=True, capture_output=True)
        lines = self.said(PROGRAMS[1]).splitlines()
        # In real time a busy machine loses frames.
        self.assertIn([line.split()[0] for line in lines], (["0", "1"], ["0"], ["1"]))
        self.assertTrue(all(math.isfinite(float(line.split()[3])) for line in lines), lines)


if __name__ == "__main__":
    unittest.main()

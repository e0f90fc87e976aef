# SPDX-License-Identifier: Apache-2.0
"""check_resources.py must find what it is there to find."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

import check_resources

SOUND = """ptxas info    : 0 bytes gmem
ptxas info    : Compiling entry function '_Z3onev' for 'sm_87'
ptxas info    : Function properties for _Z3onev
    0 bytes stack frame, 0 bytes spill stores, 0 bytes spill loads
ptxas info    : Used 36 registers, used 1 barriers, 1520 bytes smem, 416 bytes cmem[0]
ptxas info    : Compiling entry function '_Z3twov' for 'sm_90'
ptxas info    : Function properties for _Z3twov
    0 bytes stack frame, 0 bytes spill stores, 0 bytes spill loads
ptxas info    : Used 8 registers, used 0 barriers
"""
SPILLS = SOUND.replace("0 bytes spill loads", "16 bytes spill loads", 1)
STACK = SOUND.replace("0 bytes stack frame", "104 bytes stack frame", 1)


class CheckResources(unittest.TestCase):
    def status_of(self, text):
        with tempfile.TemporaryDirectory() as folder:
            if text is not None:
                (pathlib.Path(folder) / "a.o.resources").write_text(text, encoding="utf-8")
            script = pathlib.Path(check_resources.__file__)
            return subprocess.run([sys.executable, "-B", script, folder], capture_output=True, check=False).returncode

    def test_reads_every_kernel(self):
        self.assertEqual(list(check_resources.kernels(SOUND)),
                         [("sm_87", "_Z3onev", 36, 1520, 0, 0), ("sm_90", "_Z3twov", 8, 0, 0, 0)])

    def test_accepts_kernels_in_registers(self):
        self.assertEqual(self.status_of(SOUND), 0)

    def test_finds_spills_and_stacks_and_silence(self):
        for text in (SPILLS, STACK, "", None):
            with self.subTest(text=text):
                self.assertEqual(self.status_of(text), 1)


if __name__ == "__main__":
    unittest.main()

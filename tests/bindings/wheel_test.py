# SPDX-License-Identifier: Apache-2.0
"""The wheel that tools/wheel would make of this build's module: its files, what it refuses, and what a program finds in it. Wheels
themselves are tried by tests/package/wheels.

Usage: wheel_test.py DISPARITYCTL SOURCE
"""
import base64
import csv
import hashlib
import pathlib
import subprocess
import sys
import tempfile
import unittest
import zipfile

from pairs import SOURCE, drawn_pair, numpy

import disparity_matcher

MODULE = pathlib.Path(disparity_matcher._matcher.__file__)
PACKAGE = SOURCE / "bindings/python/disparity_matcher"
OBJDUMP = """
_matcher.so:     file format elf64-x86-64

Dynamic Section:
  NEEDED               libm.so.6
  NEEDED               libgcc_s.so.1
  NEEDED               libpthread.so.0
  NEEDED               libc.so.6
  NEEDED               ld-linux-x86-64.so.2
  INIT                 0x0000000000016000

DYNAMIC SYMBOL TABLE:
000000000001a048 l    d  .init\t0000000000000000              .init
0000000000000000      DF *UND*\t0000000000000000 (GLIBC_2.2.5) getenv
0000000000000000      DF *UND*\t0000000000000000 (GLIBC_2.14) memcpy
0000000000000000      DF *UND*\t0000000000000000  Base        PyList_New
0000000000000000  w   D  *UND*\t0000000000000000  Base        __gmon_start__
0000000000000000      DF *UND*\t0000000000000000 (GCC_4.2.0)  _Unwind_GetIPInfo
0000000000000000  w   DF *UND*\t0000000000000000 (GLIBC_2.9)  pipe2
000000000003a436 g    DF .text\t000000000000027a  Base        PyInit__matcher
"""
# Debian's name of it whatever this build's is, as cross builds have .so alone.
NAME = f"_matcher.cpython-{sys.version_info[0]}{sys.version_info[1]}-x86_64-linux-gnu.so"


class Wheel(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)

    def make(self, objdump=OBJDUMP, name=NAME, content=b"a module"):
        module = self.folder / name
        module.write_bytes(content)
        sources = [path for path in PACKAGE.iterdir() if path.suffix in (".py", ".pyi", ".typed")]
        return subprocess.run([sys.executable, "-B", SOURCE / "tools/setup/wheel_archive.py", module, "--version", "1.2.3", "--sources", *sources,
                               "--licences", SOURCE / "LICENSE", "--folder", self.folder], input=objdump, capture_output=True, text=True, check=False)

    def refusal(self, objdump):
        made = self.make(objdump)
        self.assertEqual((made.returncode, list(self.folder.glob("*.whl"))), (1, []))
        self.assertEqual(made.stderr.count("\n"), 1, made.stderr)
        return made.stderr.split(f"{NAME}: ")[1].rstrip()

    def test_files(self):
        made = self.make()
        self.assertEqual((made.returncode, made.stderr), (0, ""))
        path = pathlib.Path(made.stdout.strip())
        python = f"cp{sys.version_info[0]}{sys.version_info[1]}"
        self.assertEqual(path, self.folder / f"disparity_matcher-1.2.3-{python}-{python}-manylinux_2_14_x86_64.whl")
        with zipfile.ZipFile(path) as archive:
            contents = {name: archive.read(name) for name in archive.namelist()}
            executable = [entry.filename for entry in archive.infolist() if entry.external_attr >> 16 & 0o111]
        info = "disparity_matcher-1.2.3.dist-info/"
        self.assertEqual(executable, [f"disparity_matcher/{NAME}"])
        self.assertLessEqual({f"disparity_matcher/{name}" for name in ("__init__.py", "py.typed", "_matcher.pyi", "sgbm.py", NAME)}
                             | {info + name for name in ("METADATA", "WHEEL", "RECORD", "LICENSE")}, set(contents))
        self.assertFalse([name for name in contents if "_sources.cpython" in name])
        self.assertEqual(contents[info + "LICENSE"], (SOURCE / "LICENSE").read_bytes())
        rows = list(csv.reader(contents[info + "RECORD"].decode().splitlines()))
        self.assertEqual(sorted(row[0] for row in rows), sorted(contents))
        for name, digest, size in rows:
            if name == info + "RECORD":
                self.assertEqual((digest, size), ("", ""))
            else:
                expected = base64.urlsafe_b64encode(hashlib.sha256(contents[name]).digest()).decode().rstrip("=")
                self.assertEqual((digest, size), (f"sha256={expected}", str(len(contents[name]))), name)
        metadata = contents[info + "METADATA"].decode().splitlines()
        self.assertLessEqual({"Metadata-Version: 2.1", "Name: disparity-matcher", "Version: 1.2.3", "License: Apache-2.0", "License-File: LICENSE",
                              "Requires-Dist: numpy>=1.19"}, set(metadata))
        self.assertEqual([line for line in metadata if line.startswith("Requires-Dist")], ["Requires-Dist: numpy>=1.19"])
        self.assertEqual(contents[info + "WHEEL"].decode().splitlines()[2:],
                         ["Root-Is-Purelib: false", f"Tag: {python}-{python}-manylinux_2_14_x86_64"])
        first = path.read_bytes()
        self.make()
        self.assertEqual(path.read_bytes(), first)  # the same files, the same bytes

    def test_newest_symbol_is_the_tag(self):
        for symbol, tag in [("GLIBC_2.31) stat", "2_31"), ("GLIBC_2.9) pipe2", "2_14"), ("GLIBC_2.3.4) sched_getaffinity", "2_14")]:
            made = self.make(OBJDUMP + f"0000000000000000      DF *UND*\t0000000000000000 ({symbol}\n")
            self.assertIn(f"-manylinux_{tag}_x86_64.whl", made.stdout, symbol)
        aarch64 = self.make(OBJDUMP.replace("x86-64.so.2", "aarch64.so.1"), NAME.replace("x86_64", "aarch64"))
        self.assertIn("-manylinux_2_14_aarch64.whl", aarch64.stdout)

    def test_what_a_wheel_may_not_need(self):
        symbol = "0000000000000000      DF *UND*\t0000000000000000"
        for line, said in [
                (f"{symbol} (GLIBC_2.34) pthread_create", "the module needs pthread_create of glibc 2.34, allowed: up to 2.31; build it in the root of tools/setup/wheel-root"),
                (f"{symbol} (GLIBCXX_3.4.29) _ZNSo3putEc", "the module needs _ZNSo3putEc of GLIBCXX_3.4.29, allowed: glibc's and GCC_7.0; link it statically"),
                (f"{symbol} (GCC_14.0.0) __floatbitintdf", "the module needs __floatbitintdf of GCC_14.0.0, allowed: glibc's and GCC_7.0; link it statically"),
                (f"{symbol}  Base        sqlite3_open", "the module needs sqlite3_open, which no library that it names has; link what has it"),
                ("0000000000000010 g    DF .text\t0000000000000000  Base        _ZNSt6vectorIiE", "the module exports _ZNSt6vectorIiE, allowed: PyInit_*, as other "
                 "libraries of a program may have the same name"),
                ("  NEEDED               libopencv_core.so.406", "the module needs libopencv_core.so.406, allowed: the C library and libgcc_s.so.1; link it statically, "
                 "or leave out what uses it")]:
            self.assertEqual(self.refusal((line + "\n" + OBJDUMP) if "NEEDED" in line else OBJDUMP + line + "\n"), said)
        self.assertEqual(self.refusal(OBJDUMP + "0000 ?\n"), "objdump says what is not understood: 0000 ?")
        self.assertEqual(self.refusal("a file of another kind\n"), "standard input is no output of objdump -p -T")
        self.assertIn("is no module of CPython for Linux", self.make(name="_matcher.so").stderr)

    def test_a_program_uses_it(self):
        with zipfile.ZipFile(self.make(content=MODULE.read_bytes()).stdout.strip()) as archive:
            archive.extractall(self.folder / "installed")
        (self.folder / "installed/disparity_matcher" / NAME).rename(self.folder / "installed/disparity_matcher" / MODULE.name)
        program = """
import hashlib, numpy, sys, disparity_matcher as disparity
pair = numpy.load(sys.argv[1])
print(disparity.__file__.startswith(sys.argv[2]), hashlib.sha256(disparity.match(*pair, disparities=32).disparity).hexdigest())
try:
    disparity.open("walk.mkv")
except RuntimeError as error:
    print(error)
"""
        pair = drawn_pair()
        numpy.save(self.folder / "pair.npy", pair)
        said = subprocess.run([sys.executable, "-B", "-c", program, self.folder / "pair.npy", self.folder], capture_output=True, text=True, check=False,
                              env={"PYTHONPATH": str(self.folder / "installed")})
        self.assertEqual(said.stderr, "")
        self.assertEqual(said.stdout.splitlines(), [
            "True " + hashlib.sha256(disparity_matcher.match(*pair, disparities=32).disparity).hexdigest(),
            "source walk.mkv: a wheel of disparity_matcher reads no sources: give match() arrays of OpenCV, PyAV or imageio, or install Debian's package "
            "python3-disparity-matcher"])


if __name__ == "__main__":
    unittest.main()

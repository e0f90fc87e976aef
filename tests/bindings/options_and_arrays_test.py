# SPDX-License-Identifier: Apache-2.0
"""What users of the Python matcher may give, and the line that refuses what they may not.

Usage: options_and_arrays_test.py DISPARITYCTL SOURCE
"""
import pathlib
import subprocess
import sys
import tempfile
import unittest

from pairs import DISPARITYCTL, drawn_pair, numpy, write_pnm

import disparity_matcher as disparity
from disparity_matcher import _matcher

# Each is refused by the command line and by Python in one line.
REFUSED = [
    {"median": 4}, {"disparities": 60}, {"speckle_size": -1}, {"p1": 60, "p2": 50}, {"noise_level": 2, "preset": "paper"}, {"preset": "fast"},
    {"method": "bm"}, {"method": "census", "p1": 3}, {"method": "sad", "cost": "census-9x7"},
]


class OptionsAndArrays(unittest.TestCase):
    def refusal(self, *arguments, **options):
        with self.assertRaises(ValueError) as refused:
            disparity.match(*arguments, **options)
        self.assertNotIn("\n", str(refused.exception))
        return str(refused.exception)

    def test_lines_are_those_of_the_command_line(self):
        pair = drawn_pair(64, 32)
        with tempfile.TemporaryDirectory() as folder:
            for eye, image in zip(("left", "right"), pair):
                write_pnm(pathlib.Path(folder) / f"{eye}.pgm", image)
            for options in REFUSED:
                words = [word for name, value in options.items() for word in (f"--{name.replace('_', '-')}", str(value))]
                said = subprocess.run([DISPARITYCTL, "process", f"{folder}/left.pgm", f"{folder}/right.pgm", "-o", f"{folder}/out", *words],
                                      capture_output=True, text=True, check=False)
                self.assertEqual(said.returncode, 2, said.stderr)
                line = said.stderr.strip().splitlines()[0].removeprefix("disparityctl: error: ").removeprefix("error: ")
                line = line.removesuffix("; see disparityctl process --help")
                for name in options:
                    line = line.replace(f"--{name.replace('_', '-')}", name)
                self.assertEqual(self.refusal(*pair, **options), line)

    def test_every_row_of_the_table_is_an_option(self):
        pair = drawn_pair(64, 32)
        usual = disparity.Matcher().options
        for name, is_switch, _, text in _matcher.fields():
            value = usual[name]
            self.assertIs(type(value), bool if is_switch else int)
            self.assertEqual(disparity.Matcher(**{name: value}).options, usual)
            self.assertIn(f"{name} (", disparity.Matcher.__doc__)
            self.assertIn(text, disparity.Matcher.__doc__)
            self.assertIn(name, self.refusal(*pair, **{name: 10**12}))
        self.assertFalse(disparity.Matcher(interpolate=False).options["interpolate"])
        with self.assertRaisesRegex(TypeError, "^no option of matching is called 'medain'; there are d_min, "):
            disparity.Matcher(medain=3)

    def test_values_that_are_no_numbers(self):
        pair = drawn_pair(64, 32)
        self.assertEqual(self.refusal(*pair, median=3.0), "median: found '3.0', allowed: 0, 3 or 5")
        self.assertEqual(self.refusal(*pair, interpolate="no"), "interpolate: found 'no', allowed: True or False")
        self.assertEqual(self.refusal(*pair, threads=1000), "threads: found '1000', allowed: a whole number from 0 to 256")
        self.assertEqual(self.refusal(*pair, f=float("nan"), baseline_mm=1), "f: found 'nan', allowed: a number from 0 to 1e+06")
        self.assertEqual(self.refusal(*pair, f=700), "f and baseline_mm: one of them is missing, distances need both")
        self.assertRegex(self.refusal(*pair, backend="fpga"), '^no back end "fpga" on this machine: there are auto, ')

    def test_strided_arrays(self):
        left, right = drawn_pair()
        expected = disparity.match(left, right, disparities=32).disparity
        wide = numpy.zeros((120, 400), numpy.uint8)
        wide[:, 50:370] = left
        doubled = numpy.repeat(numpy.repeat(left, 2, axis=0), 3, axis=1)
        read_only = left.copy()
        read_only.setflags(write=False)
        for name, image in {"part of a wider one": wide[:, 50:370], "every other": doubled[::2, ::3], "reversed twice": left[::-1, ::-1].copy()[::-1, ::-1],
                            "Fortran": numpy.asfortranarray(left), "read-only": read_only, "transposed": left.T.copy().T,
                            "one channel": left[:, :, None], "bytes": numpy.frombuffer(left.tobytes(), numpy.uint8).reshape(120, 320),
                            "nested lists": numpy.array(left.tolist(), numpy.uint8), "not aligned": numpy.frombuffer(b"x" + left.tobytes(), numpy.uint8)[1:].reshape(120, 320),
                            "a subclass": left.view(numpy.matrix)}.items():
            with self.subTest(name):
                numpy.testing.assert_array_equal(disparity.match(image, right, disparities=32).disparity, expected)
        same = numpy.broadcast_to(left[:1], left.shape)
        numpy.testing.assert_array_equal(disparity.match(same, same, disparities=32).disparity, disparity.match(same.copy(), same.copy(), disparities=32).disparity)
        row = numpy.repeat(left[:1], 2, axis=1)[:, ::2]
        alone = disparity.match(left[:1], right[:1], disparities=32)
        for name, image in {"every other of one row": row, "reversed rows, one of them": left[:1].repeat(3, axis=0)[::-1][:1], "a row as an image": left[0][None, :]}.items():
            with self.subTest(name):
                found = disparity.match(image, right[0][None, :], disparities=32)
                numpy.testing.assert_array_equal(found.left, left[:1])
                numpy.testing.assert_array_equal(found.disparity, alone.disparity)

    def test_results_stay_as_they_were_found(self):
        left, right = drawn_pair()
        buffers = left.copy(), right.copy()
        found = disparity.match(*buffers, disparities=32)
        for buffer in buffers:
            buffer[:] = 0  # as a loop that takes each picture to the same memory
        numpy.testing.assert_array_equal(found.left, left)
        numpy.testing.assert_array_equal(found.right, right)
        for name in ("disparity", "confidence", "left", "right"):
            with self.assertRaisesRegex(ValueError, "read-only"):
                getattr(found, name)[0, 0] = 1
            with self.assertRaises(AttributeError):
                setattr(found, name, left)

    def test_measures_read_only_what_is_there(self):
        sixteenths, confidence = numpy.zeros((8, 20), numpy.int16), numpy.ones((8, 20), numpy.uint8)
        refused = "^disparity and confidence: allowed are arrays of one shape \\(height, width\\), without gaps between their pixels$"
        for wrong in (sixteenths[:, ::2], sixteenths.T, sixteenths[0]):
            for measure in (lambda of: _matcher.disparity_px(of, -16), lambda of: _matcher.depth_m(of, -16, 1, 0),
                            lambda of: _matcher.depth_error_m(of, confidence, 1, 0, 1)):
                with self.assertRaisesRegex(ValueError, refused):
                    measure(wrong)
        for wrong in (confidence[:4], confidence[:, ::2], confidence.T.copy().T, confidence[0]):
            with self.assertRaisesRegex(ValueError, refused):
                _matcher.depth_error_m(sixteenths, wrong, 1, 0, 1)

    def test_nothing_is_written_to_images(self):
        pair = drawn_pair(channels=3)
        before = [image.copy() for image in pair]
        disparity.match(*pair, preset="obstacles", disparities=32)
        for image, copy in zip(pair, before):
            numpy.testing.assert_array_equal(image, copy)

    def test_sixteen_bits(self):
        left, right = drawn_pair()
        expected = disparity.match(left, right, disparities=32).disparity
        for bits in (9, 10, 12, 16):
            deep = [image.astype(numpy.uint16) << (bits - 8) for image in (left, right)]
            numpy.testing.assert_array_equal(disparity.match(*deep, disparities=32, bits=bits).disparity, expected)
            swapped = [image.astype(">u2") for image in deep]
            numpy.testing.assert_array_equal(disparity.match(*swapped, disparities=32, bits=bits).disparity, expected)
        beyond = numpy.full((8, 64), 5000, numpy.uint16)  # more than 12 bits: 255
        self.assertEqual(set(disparity.match(beyond, beyond, bits=12).left.ravel()), {255})
        self.assertEqual(self.refusal(beyond, beyond),
                         "left: found an array of uint16: say with bits=9 to 16 how many bits the values have, such as 10 of a camera with 10 bits")
        self.assertEqual(self.refusal(left.astype(numpy.uint16), right, bits=8), "bits: found '8', allowed: a whole number from 9 to 16")

    def test_what_is_no_pair(self):
        left, right = drawn_pair(64, 32)
        colour = drawn_pair(64, 32, channels=3)[0]
        allowed = "allowed: uint8, or uint16 with its number of bits"
        nan = numpy.full((32, 64), numpy.nan)
        for image, kind in [(nan, "float64"), (left.astype(bool), "bool"), (left.astype(numpy.int8), "int8"), (left.astype(numpy.uint32), "uint32"),
                            (None, "object"), ("left.png", "<U8"), ([[1, 2]], "int64")]:
            self.assertEqual(self.refusal(image, right), f"left: found an array of {kind}, {allowed}")
        self.assertEqual(self.refusal(numpy.ma.masked_array(left), right), "left: found a masked array, whose mask would be lost: give its data, or filled()")
        self.assertEqual(self.refusal(left, left[0]), "right: found an array of shape (64,), allowed: (height, width) for grey, (height, width, 3) for BGR")
        self.assertIn("shape (32, 64, 4)", self.refusal(left, numpy.zeros((32, 64, 4), numpy.uint8)))
        self.assertEqual(self.refusal(left[:0], right[:0]), "left: image size 64x0: allowed is 1 to 8192 each")
        self.assertEqual(self.refusal(numpy.zeros((1, 8193), numpy.uint8), right), "left: image size 8193x1: allowed is 1 to 8192 each")
        self.assertEqual(self.refusal(left, right[:, 1:]), "left is 64x32 grey, right 63x32 grey: the images of a pair must be alike")
        self.assertEqual(self.refusal(left, colour), "left is 64x32 grey, right 64x32 BGR: the images of a pair must be alike")

    def test_smallest_images(self):
        for shape in [(1, 1), (1, 300), (300, 1), (7, 16)]:
            image = numpy.full(shape, 100, numpy.uint8)
            found = disparity.match(image, image, disparities=256, f=1, baseline_mm=1)
            self.assertEqual((found.disparity.shape, found.depth_m.shape), (shape, shape))
            self.assertTrue(numpy.isnan(found.disparity_px).all())  # no texture: unknown


class WithoutTheMatcher(unittest.TestCase):
    def test_client_says_what_to_install(self):
        """The client's package alone, as where the matcher is not installed."""
        program = """
import sys
class Absent:
    def find_spec(self, name, path=None, target=None):
        if name == "disparity_matcher":
            raise ModuleNotFoundError("No module named 'disparity_matcher'", name=name)
sys.meta_path.insert(0, Absent())
import disparity
print(disparity.Frame.__name__, hasattr(disparity, "match"))
try:
    disparity.match
except AttributeError as error:
    print(error)
try:
    from disparity import match
except ImportError as error:
    print(error)
try:
    disparity.macth
except AttributeError as error:
    print(error)
"""
        said = subprocess.run([sys.executable, "-B", "-c", program], capture_output=True, text=True, check=False)
        if "No module named 'google'" in said.stderr:
            self.skipTest("the client needs python3-protobuf")
        self.assertEqual(said.stderr, "")
        self.assertEqual(said.stdout.splitlines(), [
            "Frame False", *["disparity.match is part of the matcher, which is not installed: install the package python3-disparity-matcher, as docs/python.md says"] * 2,
            "module 'disparity' has no attribute 'macth'"])

    def test_client_has_the_names_of_the_matcher(self):
        program = "import disparity, disparity_matcher as m; print([n for n in m.__all__ if getattr(disparity, n) is not getattr(m, n)])"
        said = subprocess.run([sys.executable, "-B", "-c", program], capture_output=True, text=True, check=False)
        if "No module named 'google'" in said.stderr:
            self.skipTest("the client needs python3-protobuf")
        self.assertEqual((said.stdout, said.stderr), ("[]\n", ""))


if __name__ == "__main__":
    unittest.main()

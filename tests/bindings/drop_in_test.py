# SPDX-License-Identifier: Apache-2.0
"""StereoSGM takes the place of OpenCV's StereoSGBM: the calls of its samples, the meaning of its results. Beside OpenCV's own
where python3-opencv is installed.

Usage: drop_in_test.py DISPARITYCTL SOURCE
"""
import unittest
import warnings

from pairs import drawn_pair, numpy

import disparity_matcher as disparity

try:
    import cv2
except ImportError:
    cv2 = None
    print("skipped where it is compared with OpenCV: cv2 is not installed (python3-opencv)")

SHARED = {"minDisparity": 0, "numDisparities": 64, "blockSize": 5, "P1": 8 * 25, "P2": 32 * 25, "disp12MaxDiff": 1, "uniquenessRatio": 5,
          "speckleWindowSize": 50, "speckleRange": 2}


class DropIn(unittest.TestCase):
    def test_calls_of_the_sample_in_python(self):
        """samples/python/stereo_match.py of OpenCV makes it so, for BGR pictures."""
        window_size, min_disp = 3, 16
        num_disp = 112 - min_disp
        stereo = disparity.StereoSGM_create(minDisparity=min_disp, numDisparities=num_disp, blockSize=16, P1=8 * 3 * window_size**2,
                                            P2=32 * 3 * window_size**2, disp12MaxDiff=1, uniquenessRatio=10, speckleWindowSize=100, speckleRange=32)
        disp = stereo.compute(*drawn_pair(channels=3)).astype(numpy.float32) / 16.0
        self.assertEqual(disp.min(), min_disp - 1)  # where there is none, as the sample's mask disp > disp.min() has it
        self.assertAlmostEqual(float(numpy.median(disp[70:, 140:][disp[70:, 140:] > disp.min()])), 20, delta=0.1)

    def test_calls_of_the_sample_in_cpp(self):
        """samples/cpp/stereo_match.cpp sets all of it afterwards."""
        sgbm = disparity.StereoSGM_create(0, 16, 3)
        with self.assertWarnsRegex(UserWarning, "^preFilterCap = 63 changes nothing here: a census compares order, not amounts$"):
            sgbm.setPreFilterCap(63)
        sgbm.setBlockSize(3)
        sgbm.setP1(8 * 9)
        sgbm.setP2(32 * 9)
        sgbm.setMinDisparity(0)
        sgbm.setNumDisparities(64)
        sgbm.setUniquenessRatio(10)
        sgbm.setSpeckleWindowSize(100)
        sgbm.setSpeckleRange(32)
        sgbm.setDisp12MaxDiff(1)
        for mode in (sgbm.MODE_SGBM, sgbm.MODE_HH, sgbm.MODE_SGBM_3WAY, sgbm.MODE_HH4):
            sgbm.setMode(mode)
            disp = sgbm.compute(*drawn_pair())
            self.assertEqual((disp.dtype, disp.min()), (numpy.int16, -16))
            self.assertAlmostEqual(float(numpy.median(disp[70:, 140:])) / 16, 20, delta=0.1)
        self.assertEqual([sgbm.getP1(), sgbm.getP2(), sgbm.getBlockSize(), sgbm.getNumDisparities(), sgbm.getPreFilterCap(), sgbm.getMode()],
                         [72, 288, 3, 64, 63, 3])

    def test_what_parameters_become(self):
        def options(**given):
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                return disparity.StereoSGM_create(**{**SHARED, **given})._made().options

        usual = options()
        self.assertEqual([usual[name] for name in ("d_min", "disparities", "uniqueness", "speckle_size", "speckle_step", "interpolate", "paths", "p1", "p2")],
                         [0, 64, 5, 51, 2, False, 4, 15, 60])
        self.assertEqual(options(P1=0, P2=0)["p2"], 55)
        self.assertEqual(options(mode=1)["paths"], 8)
        self.assertEqual([options(blockSize=size)["cost"] for size in (1, 7, 8, 21)], ["census-7x5+gradient"] * 2 + ["census-9x7"] * 2)
        self.assertEqual((options(blockSize=9)["p1"], options(blockSize=9)["p2"]), (22, 88))
        self.assertEqual((options(disp12MaxDiff=-1)["left_right_check"], options(disp12MaxDiff=0)["left_right_check"]), (False, True))
        self.assertEqual(options(speckleWindowSize=0)["speckle_size"], 0)

    def test_what_has_no_counterpart(self):
        for given, line in [({"numDisparities": 320}, "numDisparities: found '320', allowed: a whole number from 16 to 256"),
                            ({"numDisparities": 60}, "numDisparities: found '60', allowed: a multiple of 16, 16 .. 256"),
                            ({"blockSize": 25}, "blockSize: found '25', allowed: a whole number from 1 to 21"),
                            ({"disp12MaxDiff": 10}, "disp12MaxDiff: found '10', allowed: 0 or 1 (left and right differ by at most 1 px), less than 0 (no such check)"),
                            ({"uniquenessRatio": 100}, "uniquenessRatio: found '100', allowed: a whole number from 0 to 99"),
                            ({"preFilterCap": 64}, "preFilterCap: found '64', allowed: a whole number from 0 to 63"),
                            ({"P1": 100, "P2": 50}, "P1 and P2: found 100 and 50, allowed: both 0 (tuned values), or P2 more than P1 and at most 12.9 times P1, of "
                                                    "which the ratio counts"),
                            ({"P1": 0, "P2": 50}, "P1 and P2: found 0 and 50, "), ({"P1": 1, "P2": 50}, "P1 and P2: found 1 and 50, "),
                            ({"mode": 4}, "mode: found '4', allowed: a whole number from 0 to 3"),
                            ({"speckleRange": 1.5}, "speckleRange: found '1.5', allowed: a whole number from 0 to 256")]:
            with self.subTest(**given), self.assertRaises(ValueError) as refused:
                disparity.StereoSGM_create(**{**SHARED, **given}).compute(*drawn_pair(64, 32))
            self.assertTrue(str(refused.exception).startswith(line), refused.exception)

    def test_fills_an_array_of_the_user(self):
        stereo = disparity.StereoSGM_create(**SHARED)
        pair = drawn_pair()
        mine = numpy.zeros((120, 320), numpy.int16)
        self.assertIs(stereo.compute(*pair, mine), mine)
        numpy.testing.assert_array_equal(mine, stereo.compute(*pair))
        self.assertTrue(stereo.compute(*pair).flags.writeable)
        allowed = r", allowed: None, or an array of int16, shape \(120, 320\)$"
        with self.assertRaisesRegex(ValueError, r"^disparity: found an array of int16, shape \(3, 3\)" + allowed):
            stereo.compute(*pair, numpy.zeros((3, 3), numpy.int16))
        with self.assertRaisesRegex(ValueError, r"^disparity: found an array of uint8, shape \(120, 320\)" + allowed):
            stereo.compute(*pair, numpy.zeros((120, 320), numpy.uint8))

    def test_images_of_eight_bits_only(self):
        left, right = drawn_pair()
        with self.assertRaisesRegex(ValueError, "^right: found an array of uint16, allowed: uint8$"):
            disparity.StereoSGM_create().compute(left, right.astype(numpy.uint16))

    def test_made_directly(self):
        made = disparity.StereoSGM(), disparity.StereoSGM_create()
        self.assertEqual(*(of._values for of in made))
        numpy.testing.assert_array_equal(*(of.compute(*drawn_pair()) for of in made))

    @unittest.skipIf(cv2 is None, "needs python3-opencv")
    def test_beside_opencv(self):
        pair = drawn_pair()
        theirs = cv2.StereoSGBM_create(**SHARED).compute(*pair)
        ours = disparity.StereoSGM_create(**SHARED).compute(*pair)
        self.assertEqual((ours.dtype, ours.shape, ours.min()), (theirs.dtype, theirs.shape, theirs.min()))
        both = (ours >= 0) & (theirs >= 0)
        self.assertGreater(both.mean(), 0.6)
        self.assertGreater((abs(ours.astype(int) - theirs)[both] <= 8).mean(), 0.98)  # half a pixel
        for name in ("MinDisparity", "NumDisparities", "BlockSize", "P1", "P2", "Disp12MaxDiff", "PreFilterCap", "UniquenessRatio", "SpeckleWindowSize",
                     "SpeckleRange", "Mode"):
            made = cv2.StereoSGBM_create(), disparity.StereoSGM_create()
            self.assertEqual(getattr(made[0], f"get{name}")(), getattr(made[1], f"get{name}")(), name)
        stereo = disparity.StereoSGM
        self.assertEqual((stereo.MODE_SGBM, stereo.MODE_HH, stereo.MODE_SGBM_3WAY, stereo.MODE_HH4),
                         (cv2.StereoSGBM_MODE_SGBM, cv2.StereoSGBM_MODE_HH, cv2.StereoSGBM_MODE_SGBM_3WAY, cv2.StereoSGBM_MODE_HH4))


if __name__ == "__main__":
    unittest.main()

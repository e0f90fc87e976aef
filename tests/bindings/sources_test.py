# SPDX-License-Identifier: Apache-2.0
"""Python takes frames of sources, calibrations and rectification as disparityctl process does.

Usage: sources_test.py DISPARITYCTL SOURCE
"""
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import unittest

from pairs import DISPARITYCTL, drawn_pair, numpy, process, write_pnm

import disparity_matcher as disparity

SCENE = "scene:vga?width=320&height=180&frames=3"
# A frame's noise level comes from those before it in a sequence, and from itself for a pair alone.
OPTIONS = {"preset": "obstacles", "disparities": 32, "adaptive_noise": False}
WORDS = ["--disparities", "32", "--no-adaptive-noise"]


class Sources(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)

    def pictures(self, count=3, channels=1):
        for i in range(count):
            for eye, image in zip(("left", "right"), drawn_pair(160, 90, channels=channels, seed=i)):
                write_pnm(self.folder / f"{eye}_{i}.{'pgm' if channels == 1 else 'ppm'}", image)

    def test_rectified_frames_are_those_of_process(self):
        with disparity.open(SCENE) as source:
            self.assertEqual((source.width, source.height, source.frame_count, source.synthetic, source.live), (320, 180, 3, True, False))
            matcher = disparity.Matcher(rectifier=disparity.Rectifier(source.calibration), **OPTIONS)
            found = [matcher.match(frame.left, frame.right) for frame in source]
        expected = process([SCENE], *WORDS)
        self.assertEqual([one.disparity_px.tobytes() for one in found], [one.tobytes() for one in expected])
        self.assertGreater(found[0].f, 100)
        self.assertTrue((found[0].depth_m > 0.3).any())

    def test_recording(self):
        recording = self.folder / "walk.mkv"
        subprocess.run([DISPARITYCTL, "record", "--source", SCENE, recording], check=True, capture_output=True)
        with disparity.open(SCENE) as drawn, disparity.open(recording) as recorded:
            self.assertEqual(recorded.calibration.to_opencv_yaml(), drawn.calibration.to_opencv_yaml())
            frames, kept = list(drawn), list(recorded)
        # Of a recording in real time frames are lost where the machine is busy.
        self.assertTrue(kept)
        self.assertEqual([frame.sequence for frame in frames], [0, 1, 2])
        self.assertLessEqual(recorded.dropped, kept[-1].sequence + 1 - len(kept))
        for frame in kept:
            numpy.testing.assert_array_equal(frame.left, frames[frame.sequence].left)
            numpy.testing.assert_array_equal(frame.right, frames[frame.sequence].right)
        times = [0] + [frame.monotonic_ns for frame in kept]
        self.assertEqual(times, sorted(set(times)))

    def test_images(self):
        self.pictures(channels=3)
        with disparity.open(f"{self.folder}/left_%d.ppm,{self.folder}/right_%d.ppm") as source:
            self.assertIsNone(source.calibration)
            frames = list(source)
        self.assertEqual([frame.name for frame in frames], ["left_0.ppm", "left_1.ppm", "left_2.ppm"])
        for i, frame in enumerate(frames):
            left, right = drawn_pair(160, 90, channels=3, seed=i)
            numpy.testing.assert_array_equal(frame.left, left)
            numpy.testing.assert_array_equal(frame.right, right)
        with self.assertRaisesRegex(ValueError, "^calibration: found 'None', allowed: what load_calibration\\(\\) returns, and this source has none$"):
            disparity.Rectifier(source.calibration)

    def test_losses_are_counted(self):
        self.pictures()
        (self.folder / "right_1.pgm").write_bytes(b"no picture")
        name = f"{self.folder}/left_%d.pgm,{self.folder}/right_%d.pgm"
        with self.assertLogs("disparity") as said, disparity.open(name, skip_damaged=True) as source:
            self.assertEqual([(frame.name, frame.dropped_before) for frame in source], [("left_0.pgm", 0), ("left_2.pgm", 1)])
            self.assertEqual(source.dropped, 1)
        self.assertIn("right_1.pgm", said.output[-1])
        with disparity.open(name) as source:
            next(source)
            with self.assertRaisesRegex((RuntimeError, ValueError), "right_1.pgm"):
                next(source)

    def test_names_that_are_no_utf_8(self):
        self.folder = pathlib.Path(os.fsdecode(os.fsencode(self.folder) + b"/\xff"))
        self.folder.mkdir()
        self.pictures()
        (self.folder / "right_1.pgm").write_bytes(b"no picture")
        name = f"{self.folder}/left_%d.pgm,{self.folder}/right_%d.pgm"
        with self.assertLogs("disparity") as said, disparity.open(name, skip_damaged=True) as source:
            self.assertEqual((source.name, len(list(source))), (name, 2))
        self.assertIn(f"{self.folder}/right_1.pgm", said.output[-1])
        with disparity.open(SCENE) as source:
            (self.folder / "stereo.yml").write_text(source.calibration.to_opencv_yaml())
        self.assertEqual(disparity.load_calibration(self.folder / "stereo.yml", (320, 180)).origin, f"{self.folder}/stereo.yml")
        for missing in (lambda: disparity.open(self.folder / "nothing.mkv"), lambda: disparity.load_calibration(self.folder / "no.yml", (320, 180))):
            with self.assertRaises(ValueError) as refused:
                missing()
            self.assertIs(type(refused.exception), ValueError)
            self.assertIn(str(self.folder), str(refused.exception))

    def test_closed_or_not_there(self):
        source = disparity.open(SCENE)
        frame = next(source)
        source.close()
        source.close()
        with self.assertRaisesRegex(ValueError, "^the source is closed$"):
            next(source)
        self.assertGreater(int(frame.left.max()), 0)  # frames stay
        with self.assertRaisesRegex(ValueError, "nothing.mkv: cannot open the recording: No such file"):
            disparity.open(self.folder / "nothing.mkv")

    def test_close_ends_a_wait(self):
        source = disparity.open("scene:vga@0.1?width=320&height=180", real_time=True)
        next(source)
        ended = []
        waits = threading.Thread(target=lambda: ended.append(list(source)))
        self.addCleanup(sys.setswitchinterval, sys.getswitchinterval())
        sys.setswitchinterval(1000)  # so that start() returns when the thread lets Python's lock go, to wait for a frame
        waits.start()
        source.close()
        waits.join(30)
        self.assertEqual(ended, [[]])

    def test_ctrl_c_ends_a_wait(self):
        program = ("import disparity_matcher\nsource = disparity_matcher.open('scene:vga@0.1?width=320&height=180', real_time=True)\nnext(source)\n"
                   "print('waits', flush=True)\nnext(source)\nprint('came', flush=True)")
        child = subprocess.Popen([sys.executable, "-B", "-c", program], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.assertEqual(child.stdout.readline(), "waits\n")
        child.send_signal(signal.SIGINT)
        said = child.communicate(timeout=60)
        self.assertIn("KeyboardInterrupt", said[1])
        self.assertEqual(said[0], "")  # the next frame comes after 10 s

    def test_calibration_files(self):
        with disparity.open(SCENE) as source:
            drawn = source.calibration
            frame = next(source)
        path = self.folder / "stereo.yml"
        path.write_text(drawn.to_opencv_yaml())
        read = disparity.load_calibration(path, (320, 180))
        numpy.testing.assert_array_equal(read.camera_matrices, drawn.camera_matrices)
        numpy.testing.assert_array_equal(read.T, drawn.T)
        one, other = disparity.Rectifier(read), disparity.Rectifier(drawn)
        self.assertEqual((one.calibration_id, one.f, one.baseline_mm), (other.calibration_id, other.f, other.baseline_mm))
        with self.assertRaisesRegex(ValueError, f"^calibration {path}: "):
            disparity.load_calibration(path, (640, 360))
        with self.assertRaisesRegex(ValueError, "^size: found '320', allowed: \\(width, height\\)$"):
            disparity.load_calibration(path, 320)
        with self.assertRaisesRegex(ValueError, "^images are 319x180, and the calibration of .* is for 320x180$"):
            one.rectify(frame.left[:, 1:], frame.right[:, 1:])
        with self.assertRaisesRegex(ValueError, "region"):
            disparity.Rectifier(drawn, region=(0, 0, 400, 100))

    def test_regions_and_sizes(self):
        with disparity.open(SCENE) as source:
            frame = next(source)
            rectifier = disparity.Rectifier(source.calibration, size=(240, 136), region=(8, 16, 200, 100))
            found = disparity.Matcher(rectifier=rectifier, **OPTIONS).match(frame.left, frame.right)
        expected = process([SCENE], *WORDS, "--size", "240x136", "--region", "8,16,200,100", "--frames", "1")[0]
        self.assertEqual(found.disparity_px.tobytes(), expected.tobytes())

    def test_colour_is_rectified(self):
        with disparity.open(SCENE) as source:
            frame = next(source)
            rectifier = disparity.Rectifier(source.calibration)
        grey = rectifier.rectify(frame.left, frame.right)
        colour = rectifier.rectify(*(numpy.repeat(numpy.ascontiguousarray(image)[:, :, None], 3, axis=2) for image in (frame.left, frame.right)))
        for one, three in zip(grey, colour):
            for channel in range(3):
                numpy.testing.assert_array_equal(three[:, :, channel], one)


if __name__ == "__main__":
    unittest.main()

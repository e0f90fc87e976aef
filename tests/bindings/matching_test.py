# SPDX-License-Identifier: Apache-2.0
"""The matcher for Python finds what disparityctl process finds, byte for byte; by itself, in threads, and after a fork.

Usage: matching_test.py DISPARITYCTL SOURCE
"""
import concurrent.futures
import multiprocessing
import pathlib
import pickle
import resource
import sys
import threading
import unittest

from pairs import drawn_pair, numpy, process_pair

import disparity_matcher as disparity

CASES = [
    {"preset": "dense", "disparities": 32},
    {"preset": "obstacles", "disparities": 64},
    {"preset": "paper", "disparities": 48, "d_min": -5, "threads": 1},
    {"method": "census", "disparities": 48, "cost": "census-7x5+gradient"},
    {"method": "sad", "disparities": 16, "median": 5, "left_right_check": False},
    {"preset": "dense", "disparities": 32, "backend": "reference", "speckle_size": 0, "interpolate": False},
]


def arguments_of(options):
    """Returns what the command line calls the options."""
    words = []
    for name, value in options.items():
        name = {"threads": "workers"}.get(name, name).replace("_", "-")
        words += [f"--{name}" if value is True else f"--no-{name}"] if isinstance(value, bool) else [f"--{name}", str(value)]
    return words


def others_run_during(work, attempts):
    """Returns whether this thread could go on before another one had ended `work`. Python takes its lock from no thread
    here, so that it is `work` that lets it go. On a busy machine the other one may be too quick: it gets some attempts."""
    usual = sys.getswitchinterval()
    sys.setswitchinterval(1000)
    try:
        for _ in range(attempts):
            ended = []
            thread = threading.Thread(target=lambda ended=ended: ended.append(work()))
            thread.start()  # returns as soon as this thread has the lock again
            goes_on = not ended
            thread.join()
            if goes_on:
                return True
        return False
    finally:
        sys.setswitchinterval(usual)


def in_child(matcher, pair, queue):
    queue.put(matcher.match(*pair).disparity)


def in_child_without_memory(matcher, pair, expected):
    usual = resource.getrlimit(resource.RLIMIT_AS)
    held = int(pathlib.Path("/proc/self/statm").read_text(encoding="ascii").split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (held + 2_000_000, usual[1]))
    refused = 0
    for _ in range(2):
        try:
            matcher.match(*pair)
        except (MemoryError, RuntimeError):
            refused += 1
    resource.setrlimit(resource.RLIMIT_AS, usual)
    sys.exit(0 if refused == 2 and numpy.array_equal(matcher.match(*pair).disparity, expected) else 1)


class Matching(unittest.TestCase):
    def test_same_bytes_as_disparityctl(self):
        pair = drawn_pair(200, 80)
        for options in CASES:
            with self.subTest(**options):
                found = disparity.match(*pair, **options).disparity_px
                expected = process_pair(pair, *arguments_of(options))
                self.assertEqual(found.dtype, numpy.float32)
                self.assertEqual(found.tobytes(), expected.tobytes())
                self.assertGreater(numpy.isfinite(found).mean(), 0.5)

    def test_same_bytes_of_colour(self):
        pair = drawn_pair(channels=3)
        found = disparity.match(*pair, preset="obstacles", disparities=32)
        self.assertEqual(found.disparity_px.tobytes(), process_pair(pair, "--disparities", "32").tobytes())
        blue, green, red = (pair[0][:, :, channel].astype(int) for channel in range(3))
        numpy.testing.assert_array_equal(found.left, (3735 * blue + 19235 * green + 9798 * red + 16384) >> 15)

    def test_finds_what_was_drawn(self):
        found = disparity.match(*drawn_pair(), preset="paper", disparities=32)
        self.assertAlmostEqual(float(numpy.nanmedian(found.disparity_px[:50, 40:])), 9, delta=0.1)
        self.assertAlmostEqual(float(numpy.nanmedian(found.disparity_px[70:, 40:])), 20, delta=0.1)

    def test_types_and_unknown_pixels(self):
        found = disparity.match(*drawn_pair(), preset="obstacles", disparities=32, d_min=-3)
        rejected = found.disparity == found.invalid
        self.assertEqual((found.disparity.dtype, found.confidence.dtype, found.invalid), (numpy.int16, numpy.uint8, -64))
        self.assertTrue(rejected.any())
        numpy.testing.assert_array_equal(numpy.isnan(found.disparity_px), rejected)
        numpy.testing.assert_array_equal(found.confidence == 0, rejected)

    def test_metres(self):
        found = disparity.match(*drawn_pair(), preset="dense", disparities=32, f=700, baseline_mm=120, disparity_offset=0.5,
                                subpixel_error_px=0.5)
        shift = found.disparity / 16 + 0.5
        known = ~numpy.isnan(found.disparity_px)
        numpy.testing.assert_array_equal(numpy.isnan(found.depth_m), ~known)
        numpy.testing.assert_allclose(found.depth_m[known], (84 / shift)[known], rtol=1e-6)
        measured = found.confidence > 0
        self.assertTrue((known & ~measured).any())  # interpolated: a depth whose error nobody knows
        numpy.testing.assert_array_equal(numpy.isnan(found.depth_error_m), ~measured)
        numpy.testing.assert_allclose(found.depth_error_m[measured], (84 * 0.5 / shift**2)[measured], rtol=1e-6)
        self.assertTrue(numpy.isinf(disparity.match(*drawn_pair(), f=700, baseline_mm=120, disparity_offset=-12).depth_m).any())
        with self.assertRaisesRegex(ValueError, "^no distances without a calibration: give a rectifier, or f in px and baseline_mm$"):
            disparity.match(*drawn_pair()).depth_m

    def test_kept_memory_changes_nothing(self):
        matcher = disparity.Matcher(preset="dense", disparities=32)
        for seed, size in enumerate([(200, 80), (200, 80), (160, 90), (200, 80)]):
            pair = drawn_pair(*size, seed=seed)
            kept, fresh = matcher.match(*pair), disparity.match(*pair, preset="dense", disparities=32)
            self.assertEqual(kept.disparity.tobytes(), fresh.disparity.tobytes())
            self.assertEqual(kept.confidence.tobytes(), fresh.confidence.tobytes())

    def test_result_outlives_the_next_call(self):
        matcher = disparity.Matcher(disparities=32)
        first = matcher.match(*drawn_pair(seed=1))
        before = first.disparity.copy()
        matcher.match(*drawn_pair(seed=2))
        numpy.testing.assert_array_equal(first.disparity, before)

    def test_threads_share_a_matcher_or_have_their_own(self):
        pairs = [drawn_pair(200, 80, seed=seed) for seed in range(4)]
        expected = [disparity.match(*pair, disparities=32).disparity.tobytes() for pair in pairs]
        shared = disparity.Matcher(disparities=32)
        for matcher_of in (lambda: shared, lambda: disparity.Matcher(disparities=32, threads=1)):
            all_here = threading.Barrier(4)

            def work(matcher, pair):
                all_here.wait(60)
                return [matcher.match(*pair).disparity.tobytes() for _ in range(5)]

            with concurrent.futures.ThreadPoolExecutor(4) as threads:
                found = list(threads.map(work, [matcher_of() for _ in pairs], pairs))
            self.assertEqual(found, [[one] * 5 for one in expected])

    def test_other_threads_run_while_one_matches(self):
        pair = drawn_pair(640, 360)
        matcher = disparity.Matcher(preset="paper", disparities=128, threads=1)
        matcher.match(*pair)
        self.assertTrue(others_run_during(lambda: matcher.match(*pair), attempts=50))
        self.assertFalse(others_run_during(lambda: sum(range(100_000)), attempts=5))  # what keeps Python's lock is seen to

    def test_goes_on_after_a_fork(self):
        pair = drawn_pair()
        matcher = disparity.Matcher(disparities=32, threads=2)
        expected = matcher.match(*pair).disparity
        context = multiprocessing.get_context("fork")
        queue = context.Queue()
        child = context.Process(target=in_child, args=(matcher, pair, queue))
        with matcher._lock:  # as of another thread that is just making its memory
            child.start()
        numpy.testing.assert_array_equal(queue.get(timeout=60), expected)
        child.join(60)
        self.assertEqual(child.exitcode, 0)

    def test_a_child_without_memory_goes_on_when_it_has_some(self):
        pair = drawn_pair()
        matcher = disparity.Matcher(preset="paper", disparities=256, threads=1)
        expected = matcher.match(*pair).disparity
        child = multiprocessing.get_context("fork").Process(target=in_child_without_memory, args=(matcher, pair, expected))
        child.start()
        child.join(60)
        self.assertEqual(child.exitcode, 0)

    def test_what_is_pickled(self):
        with disparity.open("scene:vga?width=320&height=180&frames=1") as source:
            frame = next(source)
        rectifier = disparity.Rectifier(source.calibration, region=(10, 20, 200, 100))
        again = pickle.loads(pickle.dumps(rectifier))
        self.assertEqual(again.calibration_id, rectifier.calibration_id)
        matcher = disparity.Matcher(preset="paper", disparities=32, median=5, rectifier=rectifier)
        other = pickle.loads(pickle.dumps(matcher))
        self.assertEqual(other.options, matcher.options)
        self.assertEqual(*(of.match(frame.left, frame.right).depth_m.tobytes() for of in (matcher, other)))
        for one, other in zip(rectifier.rectify(frame.left, frame.right), again.rectify(frame.left, frame.right)):
            self.assertEqual(one.shape, (100, 200))
            numpy.testing.assert_array_equal(one, other)


if __name__ == "__main__":
    unittest.main()

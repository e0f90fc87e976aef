# SPDX-License-Identifier: Apache-2.0
"""What tools/benchmarks --against makes of measurements, with made-up numbers."""
import json
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools" / "setup"))
import benchmark_verdict as verdict  # noqa: E402

KERNELS = """nanoseconds (TSC ticks) per pixel of 640x48, least of 25 runs in alternation, one thread
kernel                         D            reference                 AVX2                 SSE4
census                                  9.500 (20.01)        0.052 (0.11)        0.104 (0.22)
sad_row                       64        12.123 (25.00)        0.500 (1.00)        1.000 (2.00)
"""


def times(step=1e-6, **values):
    return {name: verdict.Time(value, step) for name, value in values.items()}


class Reading(unittest.TestCase):
    def test_reads_each_kernel_and_instruction_set(self):
        self.assertEqual(verdict.read_kernel_table(KERNELS), {
            "census AVX2": verdict.Time(0.052, 0.001), "census SSE4": verdict.Time(0.104, 0.001),
            "sad_row D64 AVX2": verdict.Time(0.5, 0.001), "sad_row D64 SSE4": verdict.Time(1.0, 0.001)})

    def test_reads_a_table_without_cycles(self):
        text = "kernel  D  reference  NEON\nmedian        1.500   0.250\n"
        self.assertEqual(verdict.read_kernel_table(text), {"median NEON": verdict.Time(0.25, 0.001)})

    def test_refuses_what_is_no_table(self):
        for text in ("", "no kernel here\n", KERNELS + "census 1.0\n", KERNELS.replace("0.052 (0.11)", "nan")):
            with self.subTest(text=text), self.assertRaises(ValueError):
                verdict.read_kernel_table(text)

    def test_reads_frames(self):
        one = {"name": "cpu/sgm", "isa": "AVX2", "width": 450, "height": 375, "disparities": 128, "threads": 2,
               "median_ms": 7.5, "min_ms": 7.0}
        self.assertEqual(verdict.read_frames(json.dumps([one])),
                         {"cpu/sgm AVX2 450x375x128 threads 2": verdict.Time(7.5, 1e-4)})
        with self.assertRaises(ValueError):
            verdict.read_frames("nothing")


class Judging(unittest.TestCase):
    def test_equal_times_are_good(self):
        rows = verdict.judge([(times(a=2.0), times(a=2.0))] * 3)
        self.assertEqual([(row.kernel, row.before, row.after, row.ratio) for row in rows], [("a", 2.0, 2.0, 1.0)])
        self.assertEqual(verdict.slower(rows, 5), [])

    def test_the_limit_is_exceeded_beyond_it_only(self):
        for after, limit, bad in ((1.06, 5, True), (1.04, 5, False), (1.04, 3, True), (0.5, 5, False), (1.2, 25, False)):
            rows = verdict.judge([(times(a=1.0), times(a=after))] * 5)
            with self.subTest(after=after, limit=limit):
                self.assertEqual(bool(verdict.slower(rows, limit)), bad)

    def test_pairs_count_and_not_the_medians_of_sides(self):
        # The machine is three times as slow in two of the rounds; in each pair the new version takes 10 % longer.
        pairs = [(times(a=speed), times(a=1.1 * speed)) for speed in (1.0, 3.0, 1.0, 3.0, 1.0)]
        self.assertAlmostEqual(verdict.judge(pairs)[0].ratio, 1.1)
        self.assertEqual(len(verdict.slower(verdict.judge(pairs), 5)), 1)

    def test_a_disturbed_minority_does_not_count(self):
        pairs = [(times(a=1.0), times(a=value)) for value in (1.0, 1.01, 2.0, 0.99, 5.0)]
        self.assertEqual(verdict.slower(verdict.judge(pairs), 5), [])

    def test_a_difference_within_the_printed_digits_does_not_count(self):
        self.assertEqual(verdict.slower(verdict.judge([(times(0.001, a=0.010), times(0.001, a=0.011))]), 5), [])
        self.assertEqual(len(verdict.slower(verdict.judge([(times(0.001, a=0.010), times(0.001, a=0.013))]), 5)), 1)
        self.assertEqual(verdict.slower(verdict.judge([(times(0.001, a=0.0), times(0.001, a=0.001))]), 5), [])

    def test_what_one_side_has_is_told_and_not_judged(self):
        rows = verdict.judge([(times(old=1.0, both=1.0), times(new=9.0, both=1.0))])
        self.assertEqual([row.kernel for row in rows], ["new", "both", "old"])
        self.assertEqual(verdict.slower(rows, 5), [])
        lines = verdict.table(rows, 5)
        self.assertIn("new: not judged", lines[1])
        self.assertIn("gone: not judged", lines[3])

    def test_the_table_marks_what_is_slower(self):
        rows = verdict.judge([(times(a=1.0, b=1.0), times(a=1.5, b=1.0))])
        lines = verdict.table(rows, 5)
        self.assertRegex(lines[1], r"^a +1 +1\.5 +1\.500  SLOWER$")
        self.assertNotIn("SLOWER", lines[2])


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: Apache-2.0
"""Reads what the benchmark programs print, and judges two versions by pairs of measurements.

A measurement is a dictionary from the name of a kernel to its Time.
"""
import collections
import json
import re
import statistics

# value: of any unit, less is better. step: the distance of two values that the program can print.
Time = collections.namedtuple("Time", "value step")
# ratio: the median over the pairs of after / before, None where only one side has the kernel. least_ratio: the same
# where each value is taken at that end of its printed digits which speaks for the new version.
Row = collections.namedtuple("Row", "kernel before after ratio least_ratio")


def read_kernel_table(text):
    """Of `cpu_kernels_check --bench`: "NAME D64 AVX2" for each row and each column but the reference's."""
    lines = text.splitlines()
    heads = [number for number, line in enumerate(lines) if re.match(r"kernel +D +reference\b", line)]
    if not heads:
        raise ValueError("cpu_kernels_check printed no table of kernels")
    sets = lines[heads[0]].split()[3:]
    cells = re.compile(r"^(\S+)" + r"(?: +(\d+))?" + r" +(\d+\.\d+)(?: \([\d.]+\))?" * (len(sets) + 1) + r"\s*$")
    found = {}
    for line in lines[heads[0] + 1:]:
        match = cells.match(line)
        if not match:
            raise ValueError(f"cpu_kernels_check printed a row that is none of its table: {line!r}")
        name, disparities, _, *values = match.groups()
        for instruction_set, value in zip(sets, values):
            kernel = f"{name} D{disparities} {instruction_set}" if disparities else f"{name} {instruction_set}"
            found[kernel] = Time(float(value), 10.0 ** -len(value.partition(".")[2]))
    return found


def read_frames(text):
    """Of `disparity-bench --json -`: "cpu/sgm AVX2 450x375x128 threads 2" for each contestant."""
    found = {}
    for one in json.loads(text):
        kernel = (f"{one['name']} {one['isa']} {one['width']}x{one['height']}x{one['disparities']} "
                  f"threads {one['threads']}")
        found[kernel] = Time(one["median_ms"], 1e-4)
    return found


def judge(pairs):
    """Rows for [(before, after), ...], a pair of measurements for each round; in the order of the newer version."""
    names = list(dict.fromkeys(kernel for side in (1, 0) for pair in pairs for kernel in pair[side]))
    rows = []
    for kernel in names:
        both = [(before[kernel], after[kernel]) for before, after in pairs if kernel in before and kernel in after]
        before = [times[kernel].value for times, _ in pairs if kernel in times]
        after = [times[kernel].value for _, times in pairs if kernel in times]
        rows.append(Row(kernel, statistics.median(before) if before else None,
                        statistics.median(after) if after else None,
                        statistics.median(ratio(old.value, new.value) for old, new in both) if both else None,
                        statistics.median(ratio(old.value + old.step / 2, new.value - new.step / 2)
                                          for old, new in both) if both else None))
    return rows


def ratio(before, after):
    """How many times as long; a time too short to be printed is no slower than another one."""
    return after / before if before > 0 else 1.0


def slower(rows, limit):
    """The rows that are more than `limit` percent slower, whatever the digits that were not printed."""
    return [row for row in rows if row.least_ratio is not None and row.least_ratio > 1 + limit / 100]


def table(rows, limit):
    """The lines of the table; what is slower is marked."""
    width = max([len("kernel")] + [len(row.kernel) for row in rows])
    bad = slower(rows, limit)
    lines = [f"{'kernel':{width}}  {'before':>9}  {'after':>9}  {'ratio':>6}"]
    for row in rows:
        before, after = (f"{value:9.4g}" if value is not None else f"{'-':>9}" for value in (row.before, row.after))
        if row.ratio is not None:
            verdict = f"{row.ratio:6.3f}" + ("  SLOWER" if row in bad else "")
        else:
            verdict = f"{'-':>6}  " + ("new: not judged" if row.before is None else "gone: not judged")
        lines.append(f"{row.kernel:{width}}  {before}  {after}  {verdict}")
    return lines

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Looks for loops over pixels that use no vector register in the NEON kernels, in the disassembly of the built library.

A loop counts when it is innermost and reads or writes bytes or 16-bit words, which all planes consist of. Where a pixel
leads to a place in memory that no vector instruction of NEON can go to, or work is by runs of pixels, a scalar loop is
right: see EXPECTED."""
import collections
import re
import subprocess
import sys

EXPECTED = {
    r"::winner\(|::census\(|::sad\(|WinnerSearch|PackedArgmin": "the sums beside a winner, three places of their own per pixel",
    r"LeftRightCheck::pixels": "looks up a right pixel per left pixel; NEON gathers nothing",
    r"MappedRows<.*>::(row|last_pixels)": "collects a pixel's neighbours from the raw frame",
    r"rectify_yuyv_colour|\brectify\(": "collects a pixel's neighbours from the raw frame",
    r"SpeckleFilter::|\bspeckle\(": "regions of runs, a few per row",
    r"TextureVotes::|ColumnSums::": "looks up a right pixel per left pixel, and sums a run; NEON gathers nothing",
    r"Interpolation::fill_band|\binterpolate\(": "runs of rejected pixels, a few per row",
    r"\bscan_counts\(": "edges of sectors, once per group of rows; HOT asks for the vectors of its pixels",
}
REMAINDER = 8  # instructions: the compiler's own loop for what is left over of vectors that it made
# Where the time goes: the check would mean nothing if one of these were missing or had no vectors.
HOT = ("PathRows", "MatchingCostRow", "::winner(", "::sad(", "::census(", "census_row", "census_right", "median_rows",
       "guided_median", "adaptive_p2", "scan_counts")

VECTOR = re.compile(r"\b[vqd]\d+(\.\d*[bhsd])?\b")
BRANCH = re.compile(r"(?:b\.\w+|b|cbn?z|tbn?z)\s+(?:.*,\s*)?([0-9a-f]+) <(.*?)(\+0x[0-9a-f]+)?>$")
LEAVES = re.compile(r"(bl|blr|ret)\b")
MEMORY = re.compile(r"(ld|st)[a-z0-9]*\b")
PIXELS = re.compile(r"(ldu?rs?|stu?r)[bh]\b")


def functions(library, objdump):
    """Yields (name, [(address, instruction)]) of each NEON function."""
    listing = subprocess.run([objdump, "-d", "-C", "--no-show-raw-insn", library], capture_output=True, text=True, check=True)
    name, body = "", []
    for line in listing.stdout.splitlines():
        if start := re.match(r"[0-9a-f]+ <(.*)>:$", line):
            if "N_NEON" in name:
                yield name, body
            name, body = start[1], []
        elif instruction := re.match(r"\s+([0-9a-f]+):\s+(.*\S)", line):
            body.append((int(instruction[1], 16), instruction[2]))
    if "N_NEON" in name:
        yield name, body


def innermost_loops(name, body):
    place = {address: i for i, (address, _) in enumerate(body)}
    loops = set()
    for i, (_, text) in enumerate(body):
        branch = BRANCH.match(text)
        # A branch to another function is not linked yet and seems to lead to the beginning of this one.
        if branch and branch[2] == name and branch[3] and place.get(int(branch[1], 16), i + 1) <= i:
            loops.add((place[int(branch[1], 16)], i))
    # One that only asks for memory (prfm) is part of the loop around it.
    loops = {(first, last) for first, last in loops if any(MEMORY.match(text) for _, text in body[first : last + 1])}
    for first, last in loops:
        if not any((a, b) != (first, last) and first <= a and b <= last for a, b in loops):
            yield [text for _, text in body[first : last + 1]]


def short(name):
    return name.replace("disparityd::cpu::N_NEON::", "").replace("hwy::N_NEON::", "")[:140]


def main():
    if len(sys.argv) != 3:
        sys.exit("usage: neon_loops.py LIBRARY OBJDUMP")
    with_vectors, scalar = collections.Counter(), []
    for name, body in functions(*sys.argv[1:]):
        for loop in innermost_loops(name, body):
            if any(VECTOR.search(text) for text in loop):
                with_vectors.update(hot for hot in HOT if hot in name)
            elif any(PIXELS.match(text) for text in loop) and not any(LEAVES.match(text) for text in loop):
                scalar.append((short(name), len(loop)))
    unexpected = [(name, size) for name, size in scalar
                  if size > REMAINDER and not any(re.search(known, name) for known in EXPECTED)]
    for hot in HOT:
        print(f"{with_vectors[hot]:5d} innermost loops in vectors: {hot}")
    for name, size in unexpected:
        print(f"error: scalar loop of {size} instructions in {name}")
    missing = [hot for hot in HOT if not with_vectors[hot]]
    for hot in missing:
        print(f"error: no loop in vectors found in {hot}: renamed, or not vectorised any more")
    print(f"{len(scalar) - len(unexpected)} scalar loops that are expected, {len(unexpected)} that are not")
    sys.exit(1 if unexpected or missing else 0)


main()

# SPDX-License-Identifier: Apache-2.0
"""Blocks that hand rows to each other order their memory as the PTX memory model asks (tests/emulation cannot see it).

Usage: check_memory_order.py NVCC ROOT: compiles tests/cuda/block_sync.cu to PTX and looks at the order of what is in it; exit
status 1 says which order is wrong.

Who announces: the data, a barrier of the warp, a fence, the flag. Who waits: the flag, a fence, the data. Flags are relaxed
operations of device scope. PTX ISA, "Memory Consistency Model": a fence covers what other threads have written only where
their writes are ordered before it, here by the barrier.
"""
import re
import subprocess
import sys
import tempfile
from pathlib import Path

FENCE = r"(?:membar\.gl|fence\.(?:acq_rel|sc)\.gpu)"
STEPS = re.compile(rf"\b(?P<barrier>bar\.warp\.sync)|\b(?P<fence>{FENCE})|\b(?P<flag>(?:st|ld)\.relaxed\.gpu\.\S+)"
                   r"|\b(?P<data>(?:st|ld)\.global(?:\.\w+)*)|\b(?P<volatile>(?:st|ld)\.volatile\S*)")


def steps(ptx, kernel):
    """What a kernel does to memory, in the order of its text."""
    body = re.search(rf"\.entry {kernel}\(.*?\n\{{(.*?)\n\}}", ptx, re.DOTALL)
    if not body:
        return []
    return [match.lastgroup for match in STEPS.finditer(body[1])]


def problems(ptx):
    """One line for each order that is wrong."""
    announces, waits = steps(ptx, "announces"), steps(ptx, "waits")
    if announces != ["data", "barrier", "fence", "flag"]:
        yield f"announce_rows: found {announces}, allowed: data, barrier, fence, flag"
    # The flag is polled: it is loaded before the loop and in it.
    if [step for i, step in enumerate(waits) if step != "flag" or i == 0] != ["flag", "fence", "data", "data"]:
        yield f"wait_for_rows: found {waits}, allowed: flag (again and again), fence, data"


def compiled(nvcc, root):
    with tempfile.TemporaryDirectory() as folder:
        ptx = Path(folder) / "block_sync.ptx"
        subprocess.run([nvcc, "-std=c++17", "-arch=compute_80", "-I", root, "-ptx", "-o", ptx,
                        Path(root) / "tests/cuda/block_sync.cu"], check=True)
        return ptx.read_text(encoding="utf-8")


def main():
    found = list(problems(compiled(*sys.argv[1:3])))
    print("\n".join(found) or "memory is ordered as it must be")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())

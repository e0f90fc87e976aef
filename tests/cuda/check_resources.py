# SPDX-License-Identifier: Apache-2.0
"""What each CUDA kernel takes: registers and shared memory per architecture; no kernel may spill registers or use a stack.

Usage: check_resources.py FOLDER: reads the *.resources that cmake/keep_resource_report.py left there, prints a table; exit
status 1 when a kernel spills or there is nothing to read.
"""
import pathlib
import re
import subprocess
import sys

ENTRY = re.compile(r"Compiling entry function '(\S+)' for '(\S+)'")
MEMORY = re.compile(r"(\d+) bytes stack frame, (\d+) bytes spill stores, (\d+) bytes spill loads")
USED = re.compile(r"Used (\d+) registers(?:.*?(\d+) bytes smem)?")


def kernels(text):
    """Rows (architecture, kernel, registers, shared, stack, spilled) of one report."""
    entry, memory = None, (0, 0, 0)
    for line in text.splitlines():
        if match := ENTRY.search(line):
            entry, memory = match.groups(), (0, 0, 0)
        elif match := MEMORY.search(line):
            memory = tuple(int(n) for n in match.groups())
        elif entry and (match := USED.search(line)):
            yield entry[1], entry[0], int(match[1]), int(match[2] or 0), memory[0], memory[1] + memory[2]
            entry = None


def readable(names):
    """Without namespaces and parameters, where c++filt is at hand."""
    try:
        shown = subprocess.run(["c++filt"], input="\n".join(names), capture_output=True, text=True, check=True).stdout
    except (OSError, subprocess.CalledProcessError):
        return list(names)
    # The parameters are the last parentheses; "(anonymous namespace)::" and the casts of enumerators are dropped.
    return [re.sub(r"\(.*$", "", re.sub(r"\((?:anonymous namespace|[\w:]+)\)(?:::)?", "", name)).split("::")[-1]
            for name in shown.splitlines()]


def table(rows):
    names = readable([row[1] for row in rows])
    yield "architecture  registers  shared  stack  spilled  kernel"
    for (architecture, _, registers, shared, stack, spilled), name in sorted(zip(rows, names)):
        yield f"{architecture:12}  {registers:9}  {shared:6}  {stack:5}  {spilled:7}  {name}"


def main():
    rows = [row for report in sorted(pathlib.Path(sys.argv[1]).rglob("*.resources"))
            for row in kernels(report.read_text(encoding="utf-8"))]
    print("\n".join(table(rows)))
    bad = [row for row in rows if row[4] or row[5]]
    for architecture, name, *_, stack, spilled in bad:
        print(f"{name} for {architecture}: {stack} bytes of stack, {spilled} bytes spilled; allowed: none")
    if not rows:
        print(f"no report of a kernel in {sys.argv[1]}")
    return 1 if bad or not rows else 0


if __name__ == "__main__":
    sys.exit(main())

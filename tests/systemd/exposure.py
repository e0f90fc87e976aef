# SPDX-License-Identifier: Apache-2.0
"""The units are restricted as far as their work allows: systemd-analyze security gives each at most 1.5.

Usage: exposure.py PAGE UNIT...: PAGE (docs/operations.md) gives the reason for each restriction that a unit goes without, in a
row that begins with its name. Prints each mistake; exit status 1 if there is one, 77 with the reason where systemd is
missing or too old to look at a file.
"""
import json
import pathlib
import re
import shutil
import subprocess
import sys

MOST = 1.5
SKIPPED = 77
ROW = re.compile(r"^\| (`[^|]*`[^|]*) \|")
NAME = re.compile(r"`(\w+)=")


class NothingToCheck(Exception):
    """Says why."""


def analyse(*arguments):
    if shutil.which("systemd-analyze") is None:
        raise NothingToCheck("systemd-analyze is not installed")
    return subprocess.run(["systemd-analyze", "--no-pager", "security", "--offline=true", *arguments],
                          capture_output=True, text=True, check=False)


def exposure(unit):
    """The overall exposure, and the names of the restrictions that add to it."""
    told = analyse(unit)
    overall = re.search(r"Overall exposure level for .*: ([0-9.]+)", told.stdout)
    if overall is None:
        if "unrecognized option" in told.stderr:
            raise NothingToCheck("this systemd-analyze looks at no files: systemd 250 or newer can")
        raise RuntimeError(f"{unit}: systemd-analyze says {told.stderr.strip() or told.stdout.strip()}")
    table = json.loads(analyse("--json=short", unit).stdout)
    return float(overall[1]), {row["name"].partition("=")[0] for row in table if row.get("exposure")}


def given_reasons(page):
    """The restrictions that the rows of a table begin with: | `PrivateDevices=`, `DeviceAllow=` | reason |."""
    rows = [ROW.match(line) for line in page.splitlines()]
    return {name for row in rows if row for name in NAME.findall(row[1])}


def mistakes(page, units, measure=exposure):
    reasons = given_reasons(page.read_text(encoding="utf-8"))
    found = []
    for unit in units:
        level, open_ones = measure(unit)
        print(f"{pathlib.Path(unit).name}: {level}")
        if level > MOST:
            found.append(f"{unit}: exposure {level}, allowed: at most {MOST}; systemd-analyze security --offline=true {unit} "
                         "shows what adds to it")
        found += [f"{page}: no reason for {name}=, which {pathlib.Path(unit).name} goes without"
                  for name in sorted(open_ones - reasons)]
    return found


def main():
    try:
        found = mistakes(pathlib.Path(sys.argv[1]), sys.argv[2:])
    except NothingToCheck as reason:
        print(f"the exposure of the units is not checked: {reason}")
        return SKIPPED
    if found:
        print("\n".join(found))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())

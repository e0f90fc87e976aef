# SPDX-License-Identifier: Apache-2.0
"""The version stands in CMakeLists.txt; the newest entry of debian/changelog, which Debian's tools read, must say the same.

Usage: check_version.py [ROOT]. Prints where they differ; exit status 1 if they do.
"""
import pathlib
import re
import sys

PROJECT = re.compile(r"^project\(\s*\w+\s+VERSION\s+([0-9.]+)", re.MULTILINE)
ENTRY = re.compile(r"^disparityd \(([^)]+)\) ")


def mistakes(root):
    project = PROJECT.search((root / "CMakeLists.txt").read_text(encoding="utf-8"))
    if project is None:
        return ["CMakeLists.txt:1: found no project(... VERSION number), which decides the version"]
    first = (root / "debian/changelog").read_text(encoding="utf-8").partition("\n")[0]
    entry = ENTRY.match(first)
    if entry is None:
        return [f"debian/changelog:1: found '{first}', allowed: 'disparityd ({project[1]}) ...'"]
    if entry[1] != project[1]:
        return [f"debian/changelog:1: found version {entry[1]}, allowed: {project[1]}, the VERSION of CMakeLists.txt; "
                "add an entry for it on top"]
    return []


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()
    found = mistakes(root)
    print("\n".join(found) if found else "the versions agree")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())

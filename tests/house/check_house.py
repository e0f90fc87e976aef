# SPDX-License-Identifier: Apache-2.0
"""House rules that a compiler does not see: licence lines, file sizes, direction of includes.

Usage: check_house.py [ROOT]. Prints each violation as FILE:LINE: text; exit status 1 if there is one.
"""
import pathlib
import re
import subprocess
import sys

MAX_LINES = 500
SPDX = "SPDX-License-Identifier: Apache-2.0"
# Formats that cannot carry a comment, and the licence itself.
WITHOUT_COMMENTS = {".json", ".md", ".png", ".pgm", ".ppm", ".pfm", ".mkv", ".bin"}
SOURCES = {".h", ".hpp", ".c", ".cpp", ".cu", ".py", ".sh", ".cmake"}

# What a folder may include besides itself.
ARROWS = {
    "kernels": set(),
    "proto": set(),
    "capture": {"kernels"},
    "calibration": {"kernels", "capture"},
    "pipeline": {"kernels", "capture"},
    "clients": {"proto"},
    "daemon": {"kernels", "capture", "calibration", "pipeline", "proto"},
    "tools": {"kernels", "capture", "calibration", "pipeline", "proto", "clients"},
}
FOLDERS = set(ARROWS) | {"tests"}
# The only headers of capture that the pipeline may know.
PIPELINE_SEES = {"capture/frame_source.h", "capture/rectification.h", "capture/rectification_schedule.h",
                 "capture/start_thread.h", "capture/calibration.h"}
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]')


def project_files(root):
    """Files that git tracks or would track; every file where there is no git."""
    command = ["git", "-C", str(root), "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    listed = subprocess.run(command, capture_output=True, check=False)
    if listed.returncode == 0:
        names = [name for name in listed.stdout.decode().split("\0") if name]
    else:
        names = [str(p.relative_to(root)) for p in root.rglob("*") if p.relative_to(root).parts[0] != "build"]
    return [name for name in sorted(set(names)) if (root / name).is_file()]


# Inputs of the fuzzers: bytes as parsers get them.
INPUTS = "tests/fuzz/corpus/"


def check_licence(name, lines):
    if pathlib.Path(name).suffix in WITHOUT_COMMENTS or name in ("LICENSE", ".gitignore", ".clang-format"):
        return []
    if name.startswith(INPUTS):
        return []
    if any(SPDX in line for line in lines[:2]):
        return []
    return [f"{name}:1: no line '{SPDX}' at the top"]


def check_size(name, lines):
    if pathlib.Path(name).suffix in SOURCES and len(lines) > MAX_LINES:
        return [f"{name}:{len(lines)}: {len(lines)} lines, allowed {MAX_LINES}: one idea per file"]
    return []


def check_arrows(name, lines):
    folder = name.split("/")[0]
    if folder not in ARROWS or pathlib.Path(name).suffix not in {".h", ".hpp", ".c", ".cpp", ".cu"}:
        return []
    found = []
    for number, line in enumerate(lines, 1):
        match = INCLUDE.match(line)
        if not match:
            continue
        header = match.group(1)
        target = header.split("/")[0]
        if folder == "kernels" and target == "opencv2":
            found.append(f"{name}:{number}: kernels know no OpenCV")
        if target not in FOLDERS or target == folder:
            continue
        if target not in ARROWS[folder]:
            allowed = ", ".join(sorted(ARROWS[folder])) or "nothing else"
            found.append(f"{name}:{number}: {folder} includes {header}; allowed: {allowed}")
        elif folder == "pipeline" and target == "capture" and header not in PIPELINE_SEES:
            found.append(f"{name}:{number}: pipeline includes {header}; allowed: {', '.join(sorted(PIPELINE_SEES))}")
        elif folder == "capture" and target == "kernels" and "/reference/" in header:
            found.append(f"{name}:{number}: capture includes {header}; it takes types from kernels, not algorithms")
    return found


def violations(root):
    found = []
    for name in project_files(root):
        try:
            lines = (root / name).read_text(encoding="utf-8").splitlines()
        except UnicodeDecodeError:
            continue
        for check in (check_licence, check_size, check_arrows):
            found += check(name, lines)
    return found


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()
    found = violations(root)
    print("\n".join(found) if found else "house rules hold")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())

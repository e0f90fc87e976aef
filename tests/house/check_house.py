# SPDX-License-Identifier: Apache-2.0
"""House rules that a compiler does not see: licence lines, file sizes, direction of includes, names of types.

Usage: check_house.py [ROOT]. Prints each violation as FILE:LINE: text; exit status 1 if there is one.
"""
import collections
import pathlib
import re
import subprocess
import sys

MAX_LINES = 600
SPDX = "SPDX-License-Identifier: Apache-2.0"
# Formats that cannot carry a comment, and the licence itself.
WITHOUT_COMMENTS = {".json", ".md", ".png", ".pgm", ".ppm", ".pfm", ".mkv", ".bin"}
SOURCES = {".h", ".hpp", ".c", ".cpp", ".cu", ".py", ".sh", ".cmake"}

# What a folder may include besides itself.
ARROWS = {
    "base": set(),
    "formats": {"base"},
    "kernels": set(),
    "proto": set(),
    "calibration": {"base", "kernels"},
    "capture": {"base", "calibration", "formats", "kernels"},
    "obstacles": {"base", "kernels", "proto"},
    "trust": {"kernels", "proto"},
    "pipeline": {"base", "calibration", "capture", "formats", "kernels"},
    "products": {"base", "calibration", "capture", "formats", "kernels", "pipeline", "proto"},
    "clients": {"proto"},
    "bridges": {"base", "clients", "formats", "proto"},
    "bindings": {"base", "calibration", "capture", "formats", "kernels", "pipeline"},
    "daemon": {"base", "kernels", "capture", "calibration", "formats", "obstacles", "pipeline", "products", "proto", "trust"},
    "tools": {"base", "bridges", "kernels", "capture", "calibration", "formats", "obstacles", "pipeline", "products", "proto",
              "clients", "trust"},
    "lab": {"base", "kernels", "capture", "calibration", "formats", "obstacles", "pipeline", "products", "proto", "clients",
            "bridges", "tools", "trust"},
}
FOLDERS = set(ARROWS) | {"tests"}
# The only headers of a folder that another one may know.
SEES = {("pipeline", "capture"): {"capture/frame_source.h"}, ("bindings", "pipeline"): {"pipeline/worker_pool.h"}, ("obstacles", "proto"): {"proto/doubt.h", "proto/scan.h"},
        ("trust", "proto"): {"proto/doubt.h"},
        # Files hold the messages that bridges send: tools write them with the same encoders, and know no bridge.
        ("tools", "bridges"): {"bridges/ros_messages/" + name for name in (
            "camera_info_message.h", "contents.h", "encode.h", "frame_names.h", "image_messages.h", "message_definitions.h",
            "raw_messages.h", "static_transforms.h", "topics.h", "transform_message.h")}}
# The folders of capture/ that are kinds of sources, and which of the others each may know.
KINDS = {"bag": {"images", "recording"}, "camera": {"usb", "sensors"}, "gstreamer": {"recording"}, "images": set(), "recording": set(), "scene": set(), "sensors": {"usb"},
         "svo": {"images", "recording"}, "usb": set()}
# The one file of capture/ itself that knows the kinds.
KNOWS_KINDS = "capture/source_table.cpp"
MAX_FILES = 40
VAGUE_NAMES = {"utils", "util", "helpers", "helper", "common", "misc"}
NAMESPACE = re.compile(r"(?:inline )?namespace ?([\w:]*) ?\{")
TYPE = re.compile(r"(?:struct|class|union|enum class|enum) (?:alignas\([^)]*\) )?(?:[A-Z_]+ )?(\w+)(?: final)?(?: ?:[^:;].*)?\s*\{")
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
# Files of Debian's whose formats have no comments.
DEBIAN = {"debian/changelog", "debian/copyright", "debian/source/format"}


def check_licence(name, lines):
    if pathlib.Path(name).suffix in WITHOUT_COMMENTS or name in ("LICENSE", ".gitignore", ".clang-format"):
        return []
    if name.startswith(INPUTS) or name in DEBIAN:
        return []
    if any(SPDX in line for line in lines[:2]):
        return []
    return [f"{name}:1: no line '{SPDX}' at the top"]


def check_size(name, lines):
    if pathlib.Path(name).suffix in SOURCES and len(lines) > MAX_LINES:
        return [f"{name}:{len(lines)}: {len(lines)} lines, allowed {MAX_LINES}: a class or an idea is one file, or a pair"]
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
        elif header not in SEES.get((folder, target), {header}):
            allowed = ", ".join(sorted(SEES[folder, target]))
            found.append(f"{name}:{number}: {folder} includes {header}; allowed: {allowed}")
        elif folder == "capture" and target == "kernels" and "/reference/" in header:
            found.append(f"{name}:{number}: capture includes {header}; it takes types from kernels, not algorithms")
    return found


def check_kinds(name, lines):
    """Only the table of sources knows the kinds; a kind knows the contract of capture/ and few of its neighbours."""
    parts = name.split("/")
    if parts[0] != "capture" or pathlib.Path(name).suffix not in {".h", ".cpp"} or name == KNOWS_KINDS:
        return []
    kind = parts[1] if len(parts) > 2 else None
    allowed = KINDS.get(kind, set()) | {kind}
    found = []
    for number, line in enumerate(lines, 1):
        match = INCLUDE.match(line)
        target = match.group(1).split("/") if match else []
        if len(target) > 2 and target[0] == "capture" and target[1] in KINDS and target[1] not in allowed:
            found.append(f"{name}:{number}: includes {match.group(1)}; "
                         + (f"capture/{kind} may know {', '.join(sorted(allowed - {kind})) or 'no other kind'}" if kind
                            else f"kinds of sources are known to {KNOWS_KINDS} alone"))
    return found


def check_name(name):
    stem = pathlib.Path(name).stem.lower()
    if stem in VAGUE_NAMES or set(pathlib.Path(name).parent.parts) & VAGUE_NAMES:
        return [f"{name}:1: '{stem}' says nothing of what is inside: name the one idea of the file"]
    return []


def types_of(lines):
    """Yields (line number, name with its namespaces) of the types that other files may see."""
    spaces = []
    for number, line in enumerate(lines, 1):
        if opened := NAMESPACE.match(line):
            spaces.append(opened[1])
        elif line.startswith("}  // namespace") and spaces:
            spaces.pop()
        elif (defined := TYPE.match(line)) and "" not in spaces:
            yield number, "::".join([*spaces, defined[1]])


class TypesOnce:
    """A linker takes one of two types that have one name, and says nothing: with another size it overwrites memory.
    Programs of tests are linked apart, so theirs may be alike."""

    def __init__(self):
        self.seen = {}

    def check(self, name, lines):
        if not name.endswith((".h", ".hpp", ".cpp", ".cu")) or name.startswith("tests/"):
            return []
        found = []
        for number, qualified in types_of(lines):
            before = self.seen.setdefault(qualified, f"{name}:{number}")
            if not before.startswith(name + ":"):
                found.append(f"{name}:{number}: {qualified} is also a type in {before}: give it another name")
        return found


def check_folders(names):
    """A folder with many files and no sub-folders hides its architecture."""
    files, split = collections.Counter(), set()
    for name in names:
        path = pathlib.PurePath(name)
        if path.suffix in SOURCES:
            files[path.parent] += 1
            split.add(path.parent.parent)
    return [f"{folder}:1: {count} source files, allowed {MAX_FILES} in a folder without sub-folders"
            for folder, count in sorted(files.items()) if count > MAX_FILES and folder not in split]


def violations(root):
    names = project_files(root)
    found = check_folders(names)
    types = TypesOnce()
    for name in names:
        found += check_name(name)
        try:
            lines = (root / name).read_text(encoding="utf-8").splitlines()
        except UnicodeDecodeError:
            continue
        for check in (check_licence, check_size, check_arrows, check_kinds, types.check):
            found += check(name, lines)
    return found


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()
    found = violations(root)
    print("\n".join(found) if found else "house rules hold")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())

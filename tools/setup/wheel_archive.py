# SPDX-License-Identifier: Apache-2.0
"""Checks one built module of the Python matcher and puts it into a wheel; tools/wheel calls it.

What the module needs of the system is read from `objdump -p -T`, on standard input: which libraries, and of the C library the
newest version, which becomes the wheel's tag (manylinux_2_31: glibc 2.31). What a wheel may not need is refused.
"""
import argparse
import base64
import hashlib
import pathlib
import re
import sys
import zipfile

NEWEST_GLIBC = (2, 31)  # of Debian 11, in whose root it is built; clusters have 2.34
LIBRARIES = re.compile(r"(lib(c|m|pthread|dl|rt)|ld-linux-(x86-64|aarch64))\.so\.\d+|libgcc_s\.so\.1")
NEWEST_GCC = (7, 0)  # of libgcc_s.so.1, which every system of that age has
PACKAGE = "disparity_matcher"
# Of a file in a zip archive. The date is the oldest that there is: the same files make the same bytes.
DATE = (1980, 1, 1, 0, 0, 0)

DESCRIPTION = """# disparity-matcher

The stereo matcher of disparityd, rectification and calibration files: numpy arrays in and out, nothing else needed.

    import disparity_matcher as disparity

    found = disparity.match(left, right, preset="dense", disparities=64)
    print(found.disparity_px, found.confidence)

docs/python.md of the project has the rest. The wheel reads no sources of frames: arrays of OpenCV, PyAV or imageio are taken.
"""


class Refused(Exception):
    """One line on what the module has and a wheel may not have."""


def numbers(version):
    return tuple(int(part) for part in version.split("."))


def glibc_needed(objdump):
    """Returns (major, minor) of the C library that the module needs. Refused where it needs what the system may not have."""
    for library in re.findall(r"^\s+NEEDED\s+(\S+)", objdump, re.MULTILINE):
        if not LIBRARIES.fullmatch(library):
            raise Refused(f"the module needs {library}, allowed: the C library and libgcc_s.so.1; link it statically, or leave out "
                          "what uses it")
    symbols = []
    for line in objdump.partition("DYNAMIC SYMBOL TABLE:\n")[2].splitlines():
        if not line or re.match("[0-9a-f]{8,} l", line):  # local: a section's own
            continue
        # Address, flags, section, size, version (in parentheses where it is another library's), visibility, name.
        read = re.fullmatch(r"[0-9a-f]{8,} .(.).{5} (\S+)\t[0-9a-f]+ +(?:Base|\(?([A-Za-z_]+)_([0-9.]+)\)?) +(?:\.\w+ +)?(\S+)", line)
        if not read:
            raise Refused(f"objdump says what is not understood: {line}")
        symbols.append(read.groups())
    if not symbols:
        raise Refused("standard input is no output of objdump -p -T")
    newest = (2, 0)
    for weak, section, kind, version, name in symbols:
        if section != "*UND*":
            if not name.startswith("PyInit_"):
                raise Refused(f"the module exports {name}, allowed: PyInit_*, as other libraries of a program may have the same name")
        elif kind == "GLIBC":
            newest = max(newest, numbers(version))
            if newest > NEWEST_GLIBC:
                raise Refused(f"the module needs {name} of glibc {version}, allowed: up to {'.'.join(map(str, NEWEST_GLIBC))}; build it in "
                              "the root of tools/setup/wheel-root")
        elif not kind and not re.match("_?Py", name) and not weak.strip():
            raise Refused(f"the module needs {name}, which no library that it names has; link what has it")
        elif kind and not (kind == "GCC" and numbers(version) <= NEWEST_GCC):
            raise Refused(f"the module needs {name} of {kind}_{version}, allowed: glibc's and GCC_{'.'.join(map(str, NEWEST_GCC))}; link it "
                          "statically")
    return newest[:2]


def hashed(content):
    """Returns what RECORD says of a file's content."""
    return "sha256=" + base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode() + f",{len(content)}"


def metadata(version, licences):
    lines = ["Metadata-Version: 2.1", "Name: disparity-matcher", f"Version: {version}",
             "Summary: Stereo matching, rectification and calibration files: numpy in and out", "License: Apache-2.0",
             *(f"License-File: {name}" for name in licences),
             "Classifier: License :: OSI Approved :: Apache Software License", "Classifier: Operating System :: POSIX :: Linux",
             "Classifier: Typing :: Typed", "Requires-Python: >=3.9", "Requires-Dist: numpy>=1.19", "Description-Content-Type: text/markdown"]
    return "\n".join(lines) + "\n\n" + DESCRIPTION


def write_wheel(folder, version, tag, module, sources, licences):
    """Writes the wheel into the folder and returns its path. sources: the package's other files; licences: those of all that
    is inside, the project's own first."""
    info = f"{PACKAGE}-{version}.dist-info"
    files = {f"{PACKAGE}/{source.name}": source.read_bytes() for source in sorted([*sources, module])}
    for licence in licences:
        files[f"{info}/{licence.name}"] = licence.read_bytes()
    files[f"{info}/METADATA"] = metadata(version, [licence.name for licence in licences]).encode()
    files[f"{info}/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: disparityd tools/wheel\nRoot-Is-Purelib: false\nTag: {tag}\n".encode()
    record = "".join(f"{name},{hashed(content)}\n" for name, content in files.items())
    files[f"{info}/RECORD"] = (record + f"{info}/RECORD,,\n").encode()
    path = folder / f"{PACKAGE}-{version}-{tag}.whl"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for name, content in files.items():
            entry = zipfile.ZipInfo(name, DATE)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (0o100755 if name.endswith(".so") else 0o100644) << 16
            archive.writestr(entry, content)
    return path


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("module", type=pathlib.Path, help="_matcher.cpython-311-x86_64-linux-gnu.so; its name says what it is for")
    parser.add_argument("--version", required=True, help="of the project")
    parser.add_argument("--sources", type=pathlib.Path, nargs="+", required=True, help="the package's other files")
    parser.add_argument("--licences", type=pathlib.Path, nargs="+", required=True, help="LICENSE and those of what is inside")
    parser.add_argument("--folder", type=pathlib.Path, required=True, help="where the wheel is written to")
    arguments = parser.parse_args()
    name = re.fullmatch(r"_matcher\.cpython-(\d+)-(\w+)-linux-gnu\.so", arguments.module.name)
    if not name:
        sys.exit(f"wheel_archive.py: error: {arguments.module.name} is no module of CPython for Linux, such as "
                 "_matcher.cpython-311-x86_64-linux-gnu.so")
    try:
        major, minor = glibc_needed(sys.stdin.read())
    except Refused as refused:
        sys.exit(f"wheel_archive.py: error: {arguments.module}: {refused}")
    python = f"cp{name[1]}"
    print(write_wheel(arguments.folder, arguments.version, f"{python}-{python}-manylinux_{major}_{minor}_{name[2]}", arguments.module,
                      arguments.sources, arguments.licences))


if __name__ == "__main__":
    main()

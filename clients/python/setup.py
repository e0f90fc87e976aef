# SPDX-License-Identifier: Apache-2.0
"""Adds to setup.cfg what the project around this folder says: its version, and its messages, of which protoc makes
disparity_pb2.py. A source archive (sdist) is without the project: it has disparity.proto inside, and the version in PKG-INFO.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

from setuptools import setup
from setuptools.command.build_py import build_py
from setuptools.command.sdist import sdist

HERE = pathlib.Path(__file__).resolve().parent
PROJECT = HERE.parent.parent
PROTO = "disparity.proto"
IN_ARCHIVE = (HERE / PROTO).is_file()


def refuse(text):
    sys.exit(f"error: {text}")


def version():
    """Returns the version of the project, which only CMakeLists.txt says."""
    path, line = PROJECT / "CMakeLists.txt", r"^project\(disparityd VERSION ([0-9.]+)"
    if IN_ARCHIVE:
        path, line = HERE / "PKG-INFO", r"^Version: ([0-9.]+)$"
    found = re.search(line, path.read_text(encoding="utf-8"), re.MULTILINE) if path.is_file() else None
    if found is None:
        refuse(f"{path}: found no version, expected the project's: build the package in a checkout of disparityd, or of its sdist")
    return found[1]


def proto_file():
    return HERE / PROTO if IN_ARCHIVE else PROJECT / "proto" / PROTO


def generated():
    """Returns what protoc makes of the messages, {name of the file: text}."""
    protoc = os.environ.get("PROTOC") or shutil.which("protoc")
    if not protoc:
        refuse(f"protoc: not found in PATH, but it makes disparity_pb2.py of {PROTO}: install Debian's protobuf-compiler and libprotobuf-dev, "
               "or set PROTOC to its path")
    try:
        knows = subprocess.run([protoc, "--help"], stdout=subprocess.PIPE, text=True, check=True).stdout
        with tempfile.TemporaryDirectory() as folder:
            # Types for mypy; protoc 3.20 is the first that makes them.
            types = [f"--pyi_out={folder}"] if "--pyi_out" in knows else []
            subprocess.run([protoc, f"-I{proto_file().parent}", f"--python_out={folder}", *types, PROTO], check=True)
            return {path.name: path.read_text(encoding="utf-8") for path in sorted(pathlib.Path(folder).iterdir())}
    except (OSError, subprocess.CalledProcessError) as error:
        refuse(f"{proto_file()}: protoc made no Python of it: {error}")


def needed_protobuf(made):
    """Returns the Protobuf that can run the code that protoc made: every protoc makes it for the runtimes from its own on."""
    checks = re.search(r"ValidateProtobufRuntimeVersion\(\s*[\w.]+,\s*(\d+),\s*(\d+),\s*(\d+),", made)
    if checks:
        return "protobuf>=" + ".".join(checks.groups())
    return "protobuf>=3.20" if "internal import builder" in made else "protobuf>=3.12,<4"


MADE = generated()


class BuildWithMessages(build_py):
    def run(self):
        super().run()
        editable = getattr(self, "editable_mode", False)
        folder = (HERE if editable else pathlib.Path(self.build_lib)) / "disparity"
        for name, text in MADE.items():
            (folder / name).write_text(text, encoding="utf-8")


class ArchiveWithMessages(sdist):
    def make_release_tree(self, base_dir, files):
        super().make_release_tree(base_dir, files)
        shutil.copy(proto_file(), base_dir)


setup(
    version=version(),
    install_requires=["numpy>=1.21", needed_protobuf(MADE["disparity_pb2.py"])],
    cmdclass={"build_py": BuildWithMessages, "sdist": ArchiveWithMessages},
)

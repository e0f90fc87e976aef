# SPDX-License-Identifier: Apache-2.0
"""The guest's file system: an archive (cpio, format "newc") that the kernel unpacks into memory."""
import os
import pathlib
import re
import stat
import subprocess


class Archive:
    """Collects files by their place in the guest, each once; folders above them come by themselves."""

    def __init__(self):
        self._entries = {}

    def _add_folders(self, place):
        for folder in reversed(pathlib.PurePosixPath(place).parents):
            if str(folder) != "/":
                self._entries.setdefault(str(folder), (stat.S_IFDIR | 0o755, b""))

    def add_bytes(self, place, content, mode=0o644):
        self._add_folders(place)
        self._entries.setdefault(str(place), (stat.S_IFREG | mode, content))

    def add_file(self, place, source):
        if str(place) not in self._entries:
            source = pathlib.Path(source)
            self.add_bytes(place, source.read_bytes(), 0o755 if os.access(source, os.X_OK) else 0o644)

    def add_program(self, place, source):
        """A program; the libraries that it is linked with go to /vm/lib, its interpreter keeps its place."""
        self.add_file(place, source)
        listed = subprocess.run(["ldd", source], capture_output=True, text=True, check=False).stdout
        for name, library in re.findall(r"^\s*(\S+) => (/\S+) \(0x", listed, re.MULTILINE):
            self.add_file(f"/vm/lib/{name}", library)
        for interpreter in re.findall(r"^\s*(/\S+) \(0x", listed, re.MULTILINE):
            self.add_file(interpreter, interpreter)

    def write(self, path):
        with open(path, "wb") as out:
            for number, (place, (mode, content)) in enumerate(self._entries.items(), 1):
                self._write_entry(out, number, place.lstrip("/"), mode, content)
            self._write_entry(out, 0, "TRAILER!!!", 0, b"")

    @staticmethod
    def _write_entry(out, number, name, mode, content):
        links = 2 if stat.S_ISDIR(mode) else 1
        # inode, mode, owner, group, links, time, size, device (twice two), name's length with its end, no checksum
        fields = (number, mode, 0, 0, links, 0, len(content), 0, 0, 0, 0, len(name) + 1, 0)
        header = b"070701" + b"".join(b"%08X" % field for field in fields) + name.encode() + b"\0"
        out.write(header + bytes(-len(header) % 4))
        out.write(content + bytes(-len(content) % 4))

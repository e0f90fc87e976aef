# SPDX-License-Identifier: Apache-2.0
"""The guest's file system: an archive (cpio, format "newc") that the kernel unpacks into memory."""
import os
import pathlib
import re
import stat
import subprocess


# As Debian has it: these folders are in /usr.
IN_USR = ("bin", "sbin", "lib", "lib64")


class Archive:
    """Collects files by their place in the guest, each once; folders above them come by themselves."""

    def __init__(self):
        self._entries = {f"/{name}": (stat.S_IFLNK | 0o777, f"usr/{name}".encode()) for name in IN_USR}
        self._libraries = set()  # names of those that a tree brought
        for name in IN_USR:
            self._add_folders(f"/usr/{name}/.")

    @staticmethod
    def _place(place):
        first = str(place).split("/")[1]
        return f"/usr{place}" if first in IN_USR else str(place)

    def _add_folders(self, place):
        for folder in reversed(pathlib.PurePosixPath(place).parents):
            if str(folder) not in ("/", "//"):
                self._entries.setdefault(str(folder), (stat.S_IFDIR | 0o755, b""))

    def _add(self, place, mode, content):
        place = self._place(place)
        self._add_folders(place)
        self._entries.setdefault(place, (mode, content))

    def add_bytes(self, place, content, mode=0o644):
        self._add(place, stat.S_IFREG | mode, content)

    def add_link(self, place, target):
        self._add(place, stat.S_IFLNK | 0o777, target.encode())

    def add_tree(self, folder):
        """All files and links of a folder; its libraries take the place of this machine's."""
        for path in sorted(folder.rglob("*")):
            place = f"/{path.relative_to(folder)}"
            if path.parent == folder and path.name in IN_USR and path.is_symlink():
                continue  # it is there
            if path.is_symlink():
                self.add_link(place, os.readlink(path))
            elif path.is_file():
                self.add_file(place, path)
            if ".so" in path.name:
                self._libraries.add(path.name)

    def add_file(self, place, source):
        if self._place(place) not in self._entries:
            source = pathlib.Path(source)
            self.add_bytes(place, source.read_bytes(), 0o755 if os.access(source, os.X_OK) else 0o644)

    def add_program(self, place, source):
        """A program; the libraries that it is linked with go to /vm/lib, its interpreter keeps its place."""
        self.add_file(place, source)
        listed = subprocess.run(["ldd", source], capture_output=True, text=True, check=False).stdout
        for name, library in re.findall(r"^\s*(\S+) => (/\S+) \(0x", listed, re.MULTILINE):
            if name not in self._libraries:
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

# SPDX-License-Identifier: Apache-2.0
"""Debian's kernel, from its package: fetched and unpacked into a folder, installed nowhere."""
import lzma
import pathlib
import re
import shutil
import struct
import subprocess

KEPT = ("./boot/vmlinuz-*", "./lib/modules/*/kernel/drivers/*", "./lib/modules/*/kernel/fs/*",
        "./lib/modules/*/kernel/lib/*", "./lib/modules/*/kernel/crypto/*", "./lib/modules/*/kernel/arch/*")
LEFT_OUT = ("*/drivers/gpu/*", "*/drivers/net/*", "*/drivers/infiniband/*", "*/drivers/scsi/*", "*/drivers/staging/*")


class Unavailable(Exception):
    """What a test needs is not to be had here; the text says what."""


def output_of(command, what, **options):
    """Standard output of a command; Unavailable, with what was wanted, when it fails or is not there."""
    try:
        return subprocess.run(command, check=True, capture_output=True, text=True, **options).stdout
    except FileNotFoundError as error:
        raise Unavailable(f"{what}: {command[0]} is not installed") from error
    except subprocess.CalledProcessError as error:
        lines = error.stderr.strip().splitlines()
        raise Unavailable(f"{what}: {lines[-1] if lines else error}") from error


def newest_package():
    if output_of(["dpkg", "--print-architecture"], "no Debian kernel").strip() != "amd64":
        raise Unavailable("the guest's kernel is Debian's for amd64, this machine is another one")
    depends = output_of(["apt-cache", "depends", "linux-image-amd64"], "no Debian kernel")
    names = re.findall(r"^ *Depends: (linux-image-\S+)", depends, re.MULTILINE)
    if not names:
        raise Unavailable("apt has no package linux-image-amd64 (not Debian, or apt-get update was never run)")
    return names[0]


def uncompressed(image):
    """The kernel as an ELF file, which QEMU starts directly, out of the compressed one (Linux's x86 boot protocol)."""
    start = (image[0x1F1] + 1) * 512 + struct.unpack_from("<I", image, 0x248)[0]
    end = start + struct.unpack_from("<I", image, 0x24C)[0]
    begin = image.find(b"\xfd7zXZ\0", start, end)
    if begin < 0:
        raise Unavailable("Debian's kernel is packed in another way than xz")
    return lzma.LZMADecompressor().decompress(image[begin:end])


def unpack(package, folder):
    partial = folder.with_name(folder.name + ".partial")
    shutil.rmtree(partial, ignore_errors=True)
    partial.mkdir(parents=True)
    with subprocess.Popen(["dpkg-deb", "--fsys-tarfile", package], stdout=subprocess.PIPE) as archive:
        subprocess.run(["tar", "-x", "-C", partial, "--wildcards", *(f"--exclude={name}" for name in LEFT_OUT), *KEPT],
                       stdin=archive.stdout, stderr=subprocess.DEVNULL, check=False)
    image = next((partial / "boot").glob("vmlinuz-*"), None)
    if image is None:
        raise Unavailable(f"{package.name} holds no kernel")
    (partial / "vmlinux").write_bytes(uncompressed(image.read_bytes()))
    partial.rename(folder)


class Kernel:
    """An unpacked kernel: `image` to start, modules with what they depend on."""

    def __init__(self, folder):
        self.image = folder / "vmlinux"
        self._modules = {self._plain(path.stem): path for path in folder.glob("lib/modules/*/kernel/**/*.ko")}

    @staticmethod
    def _plain(name):
        return name.replace("-", "_")

    def load_order(self, names):
        """Files of these modules and of all that they need, each after what it needs. What is built in has no file."""
        ordered = []

        def add(name):
            path = self._modules.get(self._plain(name))
            if path is None or path in ordered:
                return
            needs = re.search(rb"\0depends=([^\0]*)\0", b"\0" + path.read_bytes())
            for need in (needs.group(1).decode().split(",") if needs else []):
                add(need)
            ordered.append(path)

        for name in names:
            if self._plain(name) not in self._modules:
                raise Unavailable(f"Debian's kernel has no module {name}")
            add(name)
        return ordered


def fetch(cache):
    """The kernel, from the cache folder or, when it is not there yet, from Debian's archive."""
    cache = pathlib.Path(cache)
    name = newest_package()
    folder = cache / name
    if not folder.is_dir():
        cache.mkdir(parents=True, exist_ok=True)
        if not list(cache.glob(f"{name}_*.deb")):
            output_of(["apt-get", "download", "--quiet", name], f"{name} cannot be fetched", cwd=cache, timeout=300)
        package = next(cache.glob(f"{name}_*.deb"), None)
        if package is None:
            raise Unavailable(f"apt-get left no package {name}")
        unpack(package, folder)
        package.unlink()
    return Kernel(folder)

# SPDX-License-Identifier: Apache-2.0
"""A root with systemd and udev out of Debian's packages: fetched and unpacked into a folder, installed nowhere."""
import pathlib
import re
import shutil
import subprocess

from kernel_package import Unavailable, output_of

# Beside these, the libraries that they depend on. procps: kill, for the unit's ExecReload=.
PACKAGES = ("systemd", "udev", "procps")
KEPT = ("./bin", "./sbin", "./lib", "./lib64", "./usr/bin", "./usr/sbin", "./usr/lib", "./etc/udev")
LEFT_OUT = ("*/hwdb.d/*", "*/gconv/*", "*/locale/*", "*/systemd/catalog/*", "*/kernel/install.d/*", "*/environment.d/*")

# Nothing of it is needed to start a service, and each takes time under emulation.
MASKED = ("systemd-hwdb-update.service", "systemd-update-done.service", "systemd-random-seed.service",
          "systemd-machine-id-commit.service", "systemd-modules-load.service", "systemd-remount-fs.service",
          "systemd-firstboot.service", "systemd-journal-flush.service", "systemd-journal-catalog-update.service",
          "systemd-pstore.service", "systemd-boot-system-token.service", "systemd-binfmt.service",
          "kmod-static-nodes.service", "dev-hugepages.mount", "dev-mqueue.mount", "sys-fs-fuse-connections.mount",
          "sys-kernel-config.mount", "sys-kernel-debug.mount", "sys-kernel-tracing.mount",
          "proc-sys-fs-binfmt_misc.automount", "systemd-ask-password-console.path", "systemd-ask-password-wall.path",
          "systemd-tmpfiles-clean.timer")

FILES = {
    "/etc/machine-id": "0123456789abcdef0123456789abcdef\n",
    "/etc/hostname": "guest\n",
    "/etc/nsswitch.conf": "passwd: files\ngroup: files\nhosts: files\n",
    "/etc/hosts": "127.0.0.1 localhost\n",
    "/etc/systemd/journald.conf": "[Journal]\nStorage=volatile\n",
    "/etc/systemd/system/default.target":
        "[Unit]\nRequires=basic.target\nAfter=basic.target\nWants=vm-test.service\nAllowIsolate=yes\n",
}

TEST_UNIT = """[Unit]
After=basic.target systemd-udev-trigger.service
Wants=systemd-udev-trigger.service
[Service]
Type=oneshot
Environment=HOME=/tmp PATH=/vm:/usr/bin LD_LIBRARY_PATH=/vm/lib
ExecStart=/init {command}
StandardOutput=tty
StandardError=tty
TTYPath=/dev/ttyS0
TimeoutStartSec=infinity
"""


def depends(names):
    """Names of the packages that these need directly."""
    switches = [f"--no-{kind}" for kind in ("recommends", "suggests", "conflicts", "breaks", "replaces", "enhances")]
    text = output_of(["apt-cache", "depends", *switches, *names], "no packages of systemd")
    return set(re.findall(r"^ *\|?(?:Pre)?Depends: ([a-z0-9.+-]+)$", text, re.MULTILINE))


def package_names():
    """PACKAGES and all libraries behind them."""
    names, new = set(), set(PACKAGES)
    while new:
        names |= new
        new = {name for name in depends(sorted(new)) if name.startswith("lib")} - names
    return sorted(names)


def unpack(packages, folder):
    partial = folder.with_name(folder.name + ".partial")
    shutil.rmtree(partial, ignore_errors=True)
    partial.mkdir(parents=True)
    for package in packages:
        with subprocess.Popen(["dpkg-deb", "--fsys-tarfile", package], stdout=subprocess.PIPE) as archive:
            subprocess.run(["tar", "-x", "-C", partial, *(f"--exclude={name}" for name in LEFT_OUT), *KEPT],
                           stdin=archive.stdout, stderr=subprocess.DEVNULL, check=False)
    if not (partial / "lib/systemd/systemd").is_file() or not (partial / "bin/udevadm").is_file():
        raise Unavailable("Debian's packages hold no systemd or no udev")
    partial.rename(folder)


def fetch(cache):
    """The root's folder, from the cache or, when it is not there yet, from Debian's archive."""
    cache = pathlib.Path(cache)
    policy = output_of(["apt-cache", "policy", "systemd"], "no systemd")
    version = re.search(r"Candidate: (\d\S*)", policy)
    if version is None:
        raise Unavailable("apt has no package systemd (not Debian, or apt-get update was never run)")
    folder = cache / f"systemd-{version.group(1)}"
    if not folder.is_dir():
        downloads = cache / "systemd-packages"
        shutil.rmtree(downloads, ignore_errors=True)
        downloads.mkdir(parents=True)
        output_of(["apt-get", "download", "--quiet", *package_names()], "systemd cannot be fetched", cwd=downloads,
                  timeout=300)
        unpack(sorted(downloads.glob("*.deb")), folder)
        shutil.rmtree(downloads)
    return folder


def add_to(archive, root, command):
    """Puts a system into the archive, from the folder of its root; its systemd runs one command, after udev is there."""
    # What comes first stays: of these files, a root has others.
    for place, text in FILES.items():
        archive.add_bytes(place, text.encode())
    for unit in MASKED:
        archive.add_link(f"/etc/systemd/system/{unit}", "/dev/null")
    archive.add_tree(root)
    archive.add_bytes("/etc/systemd/system/vm-test.service", TEST_UNIT.format(command=command).encode())

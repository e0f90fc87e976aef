# SPDX-License-Identifier: Apache-2.0
"""What can fail while tools/demo and tools/test set a machine up ends in one line that says what to do, and the next run goes on.
apt and sudo are stand-ins; libraries are missing because pkg-config is shown an empty folder."""
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

PROJECT = pathlib.Path(__file__).resolve().parents[2]
PARTS = ("CMakeLists.txt", "cmake", "tools/demo", "tools/packages", "tools/setup")
REPLACED = ("apt-get", "apt-cache", "dpkg-query", "sudo", "df")
FOLDERS = subprocess.run(["pkg-config", "--variable=pc_path", "pkg-config"], capture_output=True, check=True,
                         text=True).stdout.strip().split(":")
# By name. The last of a name counts: where apt's Highway is too old, tools/setup/highway has built one.
LIBRARIES = {path.name: path for folder in [*FOLDERS, PROJECT / "build/deps/lib/pkgconfig"]
             for path in pathlib.Path(folder).glob("*.pc")}
ASK = 'cd "$1" && source tools/setup/needs.sh && ensure_needs 1 "" build && echo all is there'
APT_OFFERS_ALL = 'echo "  Candidate: 99"'
APT_HAS_NONE = 'echo "  Candidate: (none)"'


class Machine:
    """A copy of the set-up scripts, and a PATH in which the programs that change the system are stand-ins."""

    def __init__(self, folder):
        self.root = pathlib.Path(folder)
        self.project, self.bin, self.libraries = self.root / "project", self.root / "bin", self.root / "libraries"
        for part in PARTS:
            target = self.project / part
            target.parent.mkdir(parents=True, exist_ok=True)
            if (PROJECT / part).is_dir():
                shutil.copytree(PROJECT / part, target)
            else:
                shutil.copy(PROJECT / part, target)
        self.bin.mkdir()
        self.libraries.mkdir()
        for place in os.get_exec_path():
            for program in pathlib.Path(place).glob("*"):
                # ccache in the place of a compiler would look for that here, and find itself.
                if program.name not in REPLACED and program.resolve().name != "ccache" and not (self.bin / program.name).is_symlink():
                    (self.bin / program.name).symlink_to(program)
        self.stand_in("sudo", 'exec "$@"')
        self.stand_in("apt-cache", APT_OFFERS_ALL)
        self.stand_in("apt-get", "exit 0")

    def stand_in(self, name, script):
        path = self.bin / name
        path.unlink(missing_ok=True)
        path.write_text(f"#!/bin/bash\n{script}\n", encoding="utf-8")
        path.chmod(0o755)

    def bring_libraries(self):
        """Returns the script of an apt-get that installs all."""
        listed = self.root / "listed"
        listed.write_text("".join(f"{path}\n" for path in LIBRARIES.values()), encoding="utf-8")
        return f'[[ " $* " != *" install "* ]] || xargs ln -sf -t {self.libraries} <{listed}'

    def run(self, script=ASK, **options):
        """Returns the exit status, what was printed, and the lines of errors."""
        environment = {"PATH": str(self.bin), "HOME": str(self.root), "LANG": "C.UTF-8", "PKG_CONFIG_LIBDIR": str(self.libraries)}
        environment.update(options.pop("environment", {}))
        ran = subprocess.run([shutil.which("bash"), "-c", script, "bash", str(self.project)], capture_output=True, check=False,
                             text=True, stdin=subprocess.DEVNULL, env=environment, **options)
        return ran.returncode, ran.stdout, [line for line in ran.stderr.splitlines() if "error:" in line]


class Failures(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        os.chmod(folder.name, 0o755)
        self.machine = Machine(folder.name)

    def fails(self, *texts, **options):
        status, said, errors = self.machine.run(**options)
        self.assertEqual((status, len(errors)), (1, 1), f"{said}\n{errors}")
        for text in texts:
            self.assertIn(text, errors[0])

    def goes_on(self):
        self.machine.stand_in("apt-cache", APT_OFFERS_ALL)
        self.machine.stand_in("apt-get", self.machine.bring_libraries())
        status, said, errors = self.machine.run()
        self.assertEqual((status, errors), (0, []), said)
        self.assertIn("all is there", said)

    def test_no_network(self):
        self.machine.stand_in("apt-get", 'echo "E: Failed to fetch" >&2; exit 100')
        self.fails("apt-get update failed", "no network?", "run this again when it works")
        self.goes_on()

    def test_no_network_ends_the_demo(self):
        self.machine.stand_in("apt-get", "exit 100")
        self.fails("apt-get update failed", script='"$1/tools/demo" --yes')

    def test_apt_is_locked(self):
        self.machine.stand_in("apt-get", '[[ " $* " != *" install "* ]] || { echo "E: Could not get lock" >&2; exit 100; }')
        self.fails("could not install", "another package manager at work?", "run this again when it can")
        self.goes_on()

    def test_apt_has_none(self):
        self.machine.stand_in("apt-cache", APT_HAS_NONE)
        status, _, errors = self.machine.run()
        self.assertEqual(status, 1)
        # Where apt has no lists at all, that is what is said.
        if not any(pathlib.Path("/var/lib/apt/lists").glob("*_Packages*")):
            self.assertIn("apt offers nothing at all here", errors[0])
        else:
            needs = (self.machine.project / "build/needs/needs.tsv").read_text(encoding="utf-8").splitlines()
            missing = [need for need in needs if need.startswith("missing\tbuild\t") and "Highway" not in need]
            self.assertEqual(len(errors), len(missing), errors)
            self.assertGreater(len(missing), 3)
            self.assertTrue(all("and apt has none here" in line and "docs/install.md" in line for line in errors), errors)
        self.goes_on()

    def test_apt_brings_something_else(self):
        status, _, errors = self.machine.run()
        self.assertEqual(status, 1)
        self.assertTrue(errors and all("is not found although packages for it are installed" in line for line in errors), errors)
        self.goes_on()

    def test_without_root_and_sudo(self):
        (self.machine.bin / "sudo").unlink()
        options = {}
        if os.geteuid() == 0:
            options["user"] = options["group"] = 65534
            (self.machine.project / "build").mkdir(mode=0o777)
            (self.machine.project / "build").chmod(0o777)
        self.fails("sudo is not here", "run this as root", **options)

    def test_sudo_is_not_used_unasked(self):
        options = {"script": ASK.replace('ensure_needs 1 ""', 'ensure_needs 0 ""')}
        if os.geteuid() == 0:
            options["user"] = options["group"] = 65534
            (self.machine.project / "build").mkdir()
            (self.machine.project / "build").chmod(0o777)
        self.fails("cannot ask here", "sudo apt-get update && sudo", "--yes", **options)

    def test_compiler_is_too_old(self):
        compiler = self.machine.root / "old-g++"
        compiler.write_text('#!/bin/bash\nexec g++ -U__GNUC__ -D__GNUC__=10 "$@"\n', encoding="utf-8")
        compiler.chmod(0o755)
        self.machine.stand_in("apt-get", self.machine.bring_libraries())
        self.fails("g++ 11 or clang 14 or newer; found GNU 10.", "set CXX to it", environment={"CXX": str(compiler)})
        self.goes_on()

    def test_cmake_is_too_old(self):
        self.machine.stand_in("cmake", 'echo "cmake version 3.18.4"')
        self.fails("CMake 3.22 or newer is needed; found '3.18.4'", "docs/install.md")

    def test_archive_with_a_wrong_checksum(self):
        archive = self.machine.root / "highway.tar.gz"
        archive.write_bytes(b"not Highway")
        self.fails(str(archive), "SHA-256 is", "get the archive again", script=f'"$1/tools/setup/highway" --file {archive}')

    def test_archive_cannot_be_fetched(self):
        self.fails("cannot download", "give it with --file", script='"$1/tools/setup/highway" --url http://127.0.0.1:9/highway.tar.gz')

    def test_disk_is_full(self):
        script = 'cd "$1" && source tools/setup/full_disk.sh && { echo "error: the build failed$(why_build_failed 1)" >&2; exit 1; }'
        self.machine.stand_in("df", 'printf "Avail\\n5\\n"')
        self.fails(f"the disk of {self.machine.project} is full", "run this again, it goes on where it stopped", script=script)
        self.machine.stand_in("df", 'printf "Avail\\n5000\\n"')
        self.fails("the build failed, see above", script=script)


if __name__ == "__main__":
    unittest.main()

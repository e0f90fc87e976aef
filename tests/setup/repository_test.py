# SPDX-License-Identifier: Apache-2.0
"""apt takes a folder that tools/setup/repository.sh has made as a source: with an apt state of its own, without root or network."""
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

PROJECT = pathlib.Path(__file__).resolve().parents[2]
ADD = f'set -e; source {PROJECT}/tools/setup/repository.sh; add_to_repository "$@"'


class Repository(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        self.repository = self.root / "a folder"
        for part in ("state/lists/partial", "cache/archives/partial"):
            (self.root / part).mkdir(parents=True)
        (self.root / "status").touch()

    def package(self, name, version, depends=""):
        tree = self.root / "tree"
        shutil.rmtree(tree, ignore_errors=True)
        (tree / "DEBIAN").mkdir(parents=True)
        (tree / "DEBIAN/control").write_text(
            f"Package: {name}\nVersion: {version}\nArchitecture: all\nMaintainer: nobody <nobody@example.invalid>\n"
            f"{depends}Description: made by a test\n", encoding="utf-8")
        file = self.root / f"{name}_{version}_all.deb"
        subprocess.run(["dpkg-deb", "--root-owner-group", "--build", tree, file], check=True, stdout=subprocess.DEVNULL)
        return file

    def add(self, *packages):
        return subprocess.run(["bash", "-c", ADD, "bash", self.repository, *packages], check=True, capture_output=True,
                              text=True).stdout

    def apt(self, *words):
        options = {"Dir::State": self.root / "state", "Dir::State::status": self.root / "status", "Dir::Cache": self.root / "cache",
                   "Dir::Etc::SourceList": self.root / "sources.list", "Dir::Etc::SourceParts": "/dev/null",
                   "Acquire::Languages": "none", "APT::Update::Error-Mode": "any", "Debug::NoLocking": "true"}
        command = ["apt-get", "--quiet", "--quiet"]
        for name, value in options.items():
            command += ["-o", f"{name}={value}"]
        return subprocess.run([*command, *words], check=True, capture_output=True, text=True).stdout

    def test_apt_installs_the_newest_with_what_it_needs(self):
        said = self.add(self.package("camera-library", "1.0"), self.package("camera", "1.0", "Depends: camera-library\n"))
        # The line that it tells.
        line = said.split("echo '")[1].split("'")[0]
        (self.root / "sources.list").write_text(line + "\n", encoding="utf-8")
        self.apt("update")
        self.assertIn("Inst camera (1.0", self.apt("--simulate", "install", "camera"))

        self.add(self.package("camera", "1.1", "Depends: camera-library\n"))
        self.apt("update")
        simulated = self.apt("--simulate", "install", "camera")
        self.assertIn("Inst camera (1.1", simulated)
        self.assertIn("Inst camera-library (1.0", simulated)
        fetched = self.apt("--print-uris", "install", "camera=1.0")
        self.assertIn("camera_1.0_all.deb", fetched, "what lay there before stays")


if __name__ == "__main__":
    for program in ("dpkg-scanpackages", "apt-get"):
        if not shutil.which(program):
            print(f"skipped: {program} is not here")
            sys.exit(77)
    unittest.main(argv=sys.argv[:1])

# SPDX-License-Identifier: Apache-2.0
"""What is installed into any folder works there, and its pages lead only to pages that are there.

Usage: installed_prefix.py CMAKE SOURCE BUILD: installs the build into a folder that it was not configured for.
"""
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

CMAKE, SOURCE, BUILD = sys.argv[1:4]
sys.path.insert(0, str(Path(SOURCE) / "tests/docs"))
import check_docs  # noqa: E402

# What would hide that a program does not find its libraries by itself.
HIDING = ("LD_LIBRARY_PATH", "LD_PRELOAD", "DISPARITY_CLIENT_LIBRARY", "PYTHONPATH")
PROGRAMS = {"disparityd", "disparityctl", "disparity-bench", "disparity-eval", "disparity-mavlink", "disparity-web"}
# Built where Cyclone DDS is.
if (Path(BUILD) / "bin/disparity-ros2").exists():
    PROGRAMS.add("disparity-ros2")


def said_by(*command, **more):
    environment = {name: value for name, value in os.environ.items() if name not in HIDING} | more
    outcome = subprocess.run([str(part) for part in command], capture_output=True, text=True, env=environment)
    assert outcome.returncode == 0, f"{command}: {outcome.returncode}: {outcome.stdout}{outcome.stderr}"
    return outcome.stdout


class InstalledPrefix(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        installed = Path(cls.folder.name).resolve() / "installed"
        subprocess.run([CMAKE, "--install", BUILD, "--prefix", installed], check=True, stdout=subprocess.DEVNULL)
        # Nothing may lead to where it was installed.
        cls.prefix = installed.with_name("moved")
        installed.rename(cls.prefix)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_every_program_starts(self):
        programs = list((self.prefix / "bin").iterdir())
        self.assertEqual({program.name for program in programs}, PROGRAMS)
        for program in programs:
            with self.subTest(program=program.name):
                self.assertTrue(said_by(program, "--version").startswith(program.name))

    def test_the_daemon_matches(self):
        said_by(self.prefix / "bin/disparityd", "--source", "scene:vga?frames=1", "--check")

    def test_python_finds_the_library(self):
        packages = [path.parent for path in self.prefix.rglob("disparity") if (path / "__init__.py").exists()]
        self.assertEqual(len(packages), 1)
        loaded = said_by(sys.executable, "-B", "-c", "import disparity.shared_memory as m; print(m._open_library()._name)",
                         PYTHONPATH=str(packages[0])).strip()
        self.assertTrue(loaded.startswith(str(self.prefix)), loaded)

    def test_nothing_is_looked_for_in_the_build(self):
        for path in [*self.prefix.glob("bin/*"), *self.prefix.rglob("*.so*")]:
            with self.subTest(path=path.name):
                for folders in re.findall(r"\(R(?:UN)?PATH\).*\[(.*)\]", said_by("readelf", "--dynamic", path, LC_ALL="C")):
                    self.assertNotIn(str(Path(BUILD).resolve()), folders)

    def test_no_page_leads_nowhere(self):
        pages = next(self.prefix.rglob("operations.md")).parent

        def anchors_of(file):
            return check_docs.anchors(file.read_text(encoding="utf-8")) if file.suffix == ".md" else set()

        found = []
        for page in sorted(pages.rglob("*.md")):
            found += check_docs.check_links(pages, str(page.relative_to(pages)), page.read_text(encoding="utf-8"), anchors_of)
        self.assertEqual(found, [])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])

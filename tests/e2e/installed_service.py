# SPDX-License-Identifier: Apache-2.0
"""The installed unit starts the installed program with the configuration that was installed, whatever the prefix.

Usage: installed_service.py CMAKE SOURCE: configures the project for several prefixes, installs the service into a folder of
its own and compares the paths.
"""
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

CMAKE, SOURCE = sys.argv[1:3]


def run(*command, environment=None):
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, env=environment)


class InstalledService(unittest.TestCase):
    def paths(self, prefix):
        """The program and the configuration that the unit names, and the folder that stands for /."""
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        folder = Path(temporary.name)
        run(CMAKE, "-S", SOURCE, "-B", folder / "build", "-G", "Ninja", f"-DCMAKE_INSTALL_PREFIX={prefix}",
            "-DDISPARITYD_TESTS=OFF", "-DDISPARITYD_CUDA=OFF", "--log-level=WARNING")
        root = folder / "root"
        run(CMAKE, "--install", folder / "build", "--component", "service", environment=os.environ | {"DESTDIR": str(root)})
        units = list(root.rglob("disparityd.service"))
        self.assertEqual(len(units), 1)
        start = re.search(r"^ExecStart=(\S+) --config (\S+)$", units[0].read_text(encoding="utf-8"), re.MULTILINE)
        return start[1], start[2], root

    def test_the_unit_finds_what_is_installed(self):
        for prefix in ("/usr", "/usr/local", "/opt/disparityd"):
            with self.subTest(prefix=prefix):
                program, configuration, root = self.paths(prefix)
                self.assertEqual(program, f"{prefix}/bin/disparityd")
                installed = list(root.rglob("disparityd.toml"))
                self.assertEqual(installed, [root / configuration.lstrip("/")])
                self.assertRegex(installed[0].read_text(encoding="utf-8"), r'(?m)^uri = "v4l2:auto"$')
                instances = list(root.rglob("disparityd@.service"))
                self.assertEqual(len(instances), 1)
                self.assertIn(f"\nExecStart={prefix}/bin/disparityd --config {configuration.rpartition('/')[0]}/%i.toml --name %i\n",
                              instances[0].read_text(encoding="utf-8"))
                self.assertEqual(len(list(root.rglob("disparityd.slice"))), 1)
                self.assertIn("\nSlice=disparityd.slice\n", instances[0].read_text(encoding="utf-8"))
                bridges = ["mavlink", "web"]
                if list(root.rglob("disparity-ros2.service")):  # built where Cyclone DDS is
                    bridges.append("ros2")
                for bridge in bridges:
                    units = list(root.rglob(f"disparity-{bridge}.service"))
                    self.assertEqual(len(units), 1)
                    unit = units[0].read_text(encoding="utf-8")
                    options = f"$DISPARITY_{bridge.upper()}_OPTIONS"
                    self.assertIn(f"\nExecStart={prefix}/bin/disparity-{bridge} {options}\n", unit)
                    folder = Path(configuration).parent.relative_to("/")
                    self.assertIn(f"\nEnvironmentFile=-/{folder}/{bridge}.conf\n", unit)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])

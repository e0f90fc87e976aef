# SPDX-License-Identifier: Apache-2.0
"""exposure.py must find a unit that is too open, and one whose reasons are not written down."""
import pathlib
import tempfile
import unittest

import exposure

PAGE = "| without | reason |\n| --- | --- |\n| `PrivateDevices=`, `DeviceAllow=` | cameras |\n| text with `Other=` | no |\n"


class Exposure(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.page = pathlib.Path(folder.name) / "page.md"
        self.page.write_text(PAGE, encoding="utf-8")
        self.unit = pathlib.Path(folder.name) / "open.service"

    def found(self, level, names):
        return exposure.mistakes(self.page, ["a.service"], lambda unit: (level, names))

    def test_accepts_what_has_reasons(self):
        self.assertEqual(self.found(1.5, {"PrivateDevices", "DeviceAllow"}), [])

    def test_finds_a_unit_that_is_too_open(self):
        self.assertIn("exposure 1.6, allowed: at most 1.5", self.found(1.6, set())[0])

    def test_finds_a_missing_reason(self):
        self.assertEqual(len(self.found(1.0, {"PrivateUsers", "DeviceAllow", "Other"})), 2)

    def test_systemd_finds_an_open_unit(self):
        self.unit.write_text("[Service]\nExecStart=/bin/true\n", encoding="utf-8")
        try:
            level, names = exposure.exposure(str(self.unit))
        except exposure.NothingToCheck as reason:
            self.skipTest(str(reason))
        self.assertGreater(level, 8)
        self.assertIn("PrivateDevices", names)
        self.assertIn("SystemCallFilter", names)


if __name__ == "__main__":
    unittest.main()

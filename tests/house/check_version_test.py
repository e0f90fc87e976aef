# SPDX-License-Identifier: Apache-2.0
"""check_version.py must find versions that differ."""
import pathlib
import tempfile
import unittest

import check_version

PROJECT = "# comment\nproject(disparityd VERSION 1.2.0 LANGUAGES C)\n"


class CheckVersion(unittest.TestCase):
    def found(self, project, changelog):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            (root / "debian").mkdir()
            (root / "CMakeLists.txt").write_text(project, encoding="utf-8")
            (root / "debian/changelog").write_text(changelog, encoding="utf-8")
            return check_version.mistakes(root)

    def test_accepts_the_same(self):
        self.assertEqual(self.found(PROJECT, "disparityd (1.2.0) unstable; urgency=medium\n\n  * x\n"), [])

    def test_finds_another_version(self):
        found = self.found(PROJECT, "disparityd (1.1.0) unstable; urgency=medium\n\ndisparityd (1.2.0) unstable\n")
        self.assertIn("found version 1.1.0, allowed: 1.2.0", found[0])

    def test_finds_what_is_no_entry(self):
        self.assertEqual(len(self.found(PROJECT, "\n")), 1)
        self.assertEqual(len(self.found("project(disparityd)\n", "disparityd (1.2.0) unstable\n")), 1)


if __name__ == "__main__":
    unittest.main()

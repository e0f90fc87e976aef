# SPDX-License-Identifier: Apache-2.0
"""check_commands.py must find what it is there to find."""
import pathlib
import tempfile
import unittest

import check_commands

PROGRAM = """#!/bin/sh
case "$1" in
    --help) echo "  --version  shows it" ;;
    status) echo "  --json     as JSON" ;;
    *) exit 2 ;;
esac
"""


class CheckCommands(unittest.TestCase):
    def found_in(self, page):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder).resolve()
            (root / "page.md").write_text(page, encoding="utf-8")
            program = root / "disparityctl"
            program.write_text(PROGRAM, encoding="utf-8")
            program.chmod(0o755)
            return check_commands.mistakes(root, check_commands.Programs(root, [str(program)]))

    def test_accepts_what_exists(self):
        self.assertEqual(self.found_in(
            "Text --none, `disparityctl status --json` and `disparityctl --version`, `other --none`.\n"
            "```sh\nNAME=1 build/release/bin/disparityctl status --json | grep --none   # --none\n```\n"
            "    sudo disparityctl status --help && other --none\n"), [])

    def test_finds_what_does_not(self):
        for page in ("`disparityctl status --none`", "`disparityctl none`", "    disparityctl status --json --none=1",
                     "```\nother && disparityctl --none\n```", "`disparityctl --none`"):
            with self.subTest(page=page):
                self.assertEqual(len(self.found_in(page)), 1)


if __name__ == "__main__":
    unittest.main()

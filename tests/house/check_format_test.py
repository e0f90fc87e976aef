# SPDX-License-Identifier: Apache-2.0
"""The formatting step of tools/test (check_format in tools/setup/checks.sh) on folders made for it."""
import pathlib
import shutil
import subprocess
import tempfile
import unittest

PROJECT = pathlib.Path(__file__).resolve().parents[2]
SCRIPT = f'set -uo pipefail; cd "$1"; results=$1 jobs=1; source {PROJECT}/tools/setup/checks.sh; PATH=$2; check_format'
GOOD = "int x = 0;\n"
BAD = "int  x=0;\n"


def has_version_14():
    program = shutil.which("clang-format")
    return bool(program) and b"version 14." in subprocess.run([program, "--version"], capture_output=True, check=True).stdout


class CheckFormat(unittest.TestCase):
    def outcome(self, files, clang_format=None):
        """(lines of steps.tsv, what was printed); clang_format: a script in its place, "" for none."""
        with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryDirectory() as programs:
            shutil.copy(PROJECT / ".clang-format", folder)
            for name, text in files.items():
                pathlib.Path(folder, name).write_text(text, encoding="utf-8")
            for name in ("git", "find", "grep", "sed", "sort", "xargs", "clang-format"):
                if shutil.which(name):
                    pathlib.Path(programs, name).symlink_to(shutil.which(name))
            if clang_format is not None:
                replaced = pathlib.Path(programs, "clang-format")
                replaced.unlink(missing_ok=True)
                if clang_format:
                    replaced.write_text(f"#!/bin/bash\n{clang_format}\n", encoding="utf-8")
                    replaced.chmod(0o755)
            ran = subprocess.run([shutil.which("bash"), "-c", SCRIPT, "bash", folder, programs], capture_output=True,
                                 check=False, text=True)
            steps = pathlib.Path(folder, "steps.tsv").read_text(encoding="utf-8")
            return steps.splitlines(), ran.stdout + ran.stderr

    @unittest.skipUnless(has_version_14(), "clang-format 14 is not installed")
    def test_passes_good_files(self):
        steps, _ = self.outcome({"a.cpp": GOOD, "b.h": GOOD, "c.py": BAD})
        self.assertEqual(steps, ["passed\tformatting (clang-format)"])

    @unittest.skipUnless(has_version_14(), "clang-format 14 is not installed")
    def test_names_bad_files_and_the_command(self):
        steps, printed = self.outcome({"a.cpp": BAD + BAD, "b.h": GOOD, "c.cu": BAD})
        self.assertEqual(len(steps), 1)
        self.assertRegex(steps[0], r"^failed\tformatting; to mend it: clang-format -i (\./)?a\.cpp (\./)?c\.cu$")
        self.assertRegex(printed, r"not formatted: (\./)?a\.cpp\n")
        self.assertNotIn("b.h", printed)

    def test_fails_when_the_program_does(self):
        steps, printed = self.outcome({"a.cpp": GOOD},
                                      '[[ $1 == --version ]] && echo "version 14.0" || { echo broken >&2; exit 1; }')
        self.assertEqual(steps, ["failed\tformatting (clang-format)"])
        self.assertIn("broken", printed)

    def test_goes_on_without_the_program(self):
        steps, printed = self.outcome({"a.cpp": BAD}, "")
        self.assertEqual(len(steps), 1)
        self.assertRegex(steps[0], "^skipped\t.*not installed")
        self.assertIn("skipped: ", printed)

    def test_goes_on_with_another_version(self):
        steps, _ = self.outcome({"a.cpp": BAD}, "echo version 16.0.6")
        self.assertRegex(steps[0], "^skipped\t.*16")


if __name__ == "__main__":
    unittest.main()

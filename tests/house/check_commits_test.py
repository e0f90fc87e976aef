# SPDX-License-Identifier: Apache-2.0
"""check_commits.py must find what it is there to find, in repositories made for it."""
import pathlib
import shutil
import subprocess
import tempfile
import unittest

import check_commits

AUTHOR = ["-c", "user.name=A", "-c", "user.email=a@example.org", "-c", "commit.gpgsign=false",
          "-c", "core.hooksPath=/dev/null"]
GOOD = "A subject\n\nThe reason.\n"


@unittest.skipUnless(shutil.which("git"), "git is not installed")
class CheckCommits(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.root = pathlib.Path(self.folder.name).resolve()
        self.run_git("init", "--quiet", "--initial-branch=main")
        self.base = self.commit("Before the rule anything went, however long the subject was, and nobody asked for a body")

    def run_git(self, *arguments):
        result = check_commits.git(self.root, *AUTHOR, *arguments)
        self.assertEqual(result.returncode, 0, result.stderr.decode())
        return result.stdout.decode().strip()

    def commit(self, message):
        self.run_git("commit", "--quiet", "--allow-empty", "--allow-empty-message", "--cleanup=verbatim",
                     "--message", message)
        return self.run_git("rev-parse", "HEAD")

    def found(self):
        return check_commits.violations(self.root, self.base)

    def test_nothing_new_is_good(self):
        self.assertEqual(self.found(), [])

    def test_accepts_good_messages(self):
        self.commit(GOOD)
        self.commit("x" * check_commits.MAX_SUBJECT + "\n\nOne line\nand another.\n\nSigned-off-by: A <a@example.org>\n")
        self.commit("ü" * check_commits.MAX_SUBJECT + "\n\nCharacters count, not bytes.")
        self.assertEqual(self.found(), [])

    def test_finds_bad_messages(self):
        for message, problem in (
            ("x" * (check_commits.MAX_SUBJECT + 1) + "\n\nThe reason.", "73 characters"),
            ("A subject", "no body"),
            ("A subject\n\n\n", "no body"),
            ("A subject\n\nSigned-off-by: A <a@example.org>\n", "no body"),
            ("A subject\nthat goes on\n\nThe reason.", "second line"),
            ("", "subject is empty"),
        ):
            with self.subTest(message=message):
                name = self.commit(message)
                found = self.found()
                self.assertTrue(any(problem in line and name[:7] in line for line in found), found)
                self.run_git("reset", "--quiet", "--hard", self.base)

    def test_finds_each_of_several(self):
        self.commit("First")
        self.commit(GOOD)
        self.commit("Second")
        self.assertEqual([line.split('"')[1] for line in self.found()], ["Second", "First"])

    def test_looks_at_merged_commits_but_not_at_merges(self):
        self.run_git("checkout", "--quiet", "-b", "side")
        self.commit("On the side")
        self.run_git("checkout", "--quiet", "main")
        self.commit(GOOD)
        self.run_git("merge", "--quiet", "--no-ff", "--message", "Merge branch side", "side")
        found = self.found()
        self.assertEqual(len(found), 1, found)
        self.assertIn("On the side", found[0])

    def test_says_why_it_looks_at_nothing(self):
        self.commit("Bad")
        inner = self.root / "export"
        inner.mkdir()
        outside = tempfile.TemporaryDirectory()
        self.addCleanup(outside.cleanup)
        shallow = pathlib.Path(outside.name).resolve() / "shallow"
        subprocess.run(["git", "clone", "--quiet", "--depth=1", f"file://{self.root}", str(shallow)], check=True)
        for root, reason in ((inner, "export"), (shallow, "shallow"), (shallow.parent, "no repository")):
            with self.subTest(reason=reason), self.assertRaisesRegex(check_commits.NothingToCheck, reason):
                check_commits.violations(root, self.base)


if __name__ == "__main__":
    unittest.main()

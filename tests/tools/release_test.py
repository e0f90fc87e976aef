# SPDX-License-Identifier: Apache-2.0
"""tools/release in a repository made for it: what it refuses, and what it makes."""
import hashlib
import os
import pathlib
import shutil
import subprocess
import tarfile
import tempfile
import unittest

PROJECT = pathlib.Path(__file__).resolve().parents[2]


@unittest.skipUnless(shutil.which("git"), "git is not installed")
class Release(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.home = pathlib.Path(folder.name).resolve()
        self.root = self.home / "project"
        (self.root / "tools").mkdir(parents=True)
        shutil.copy(PROJECT / "tools" / "release", self.root / "tools")
        self.write(".gitignore", "/build/\n")
        self.write("CMakeLists.txt", "project(disparityd VERSION 1.2.3 LANGUAGES C CXX)\n")
        self.write("CHANGELOG.md", "# Changes\n\n## 1.2.3\n\n- all\n\n## 1.2.2\n")
        self.git("init", "--quiet", "--initial-branch=main")
        self.commit()

    def write(self, name, text):
        path = self.root / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def run_here(self, *command):
        # No key of the user's, and no setting.
        environment = {"PATH": os.environ["PATH"], "HOME": str(self.home), "GNUPGHOME": str(self.home / "none"),
                       "GIT_CONFIG_NOSYSTEM": "1", "GIT_AUTHOR_NAME": "A", "GIT_AUTHOR_EMAIL": "a@example.org",
                       "GIT_COMMITTER_NAME": "A", "GIT_COMMITTER_EMAIL": "a@example.org"}
        return subprocess.run([str(part) for part in command], cwd=self.root, env=environment, stdin=subprocess.DEVNULL,
                              capture_output=True, text=True, check=False)

    def git(self, *arguments):
        made = self.run_here("git", *arguments)
        self.assertEqual(made.returncode, 0, made.stderr)
        return made.stdout

    def commit(self):
        self.git("add", "--all")
        self.git("commit", "--quiet", "--allow-empty", "--message", "A change")

    def release(self, *options):
        return self.run_here("tools/release", *options)

    def expect_refusal(self, pattern, *options, status=1):
        made = self.release(*options)
        self.assertEqual((made.returncode, made.stdout), (status, ""))
        self.assertRegex(made.stderr, rf"\Atools/release: error: {pattern}\n\Z")
        self.assertEqual(self.git("tag", "--list", "v1.2.3*"), "")
        self.assertFalse((self.root / "build").exists())

    def test_what_is_not_committed_is_refused(self):
        self.write("new.txt", "")
        self.expect_refusal(r"new\.txt: found changes that are not committed; .*", "--yes")

    def test_another_branch_is_refused(self):
        self.git("switch", "--quiet", "--create", "work")
        self.expect_refusal("HEAD: found work, allowed: main; .*", "--yes")
        self.git("switch", "--quiet", "--detach")
        self.expect_refusal("HEAD: found no branch, allowed: main; .*", "--yes")

    def test_versions_that_differ_are_refused(self):
        self.write("CHANGELOG.md", "# Changes\n\n## Unreleased\n\n## 1.2.3\n")
        self.commit()
        self.expect_refusal(r"CHANGELOG\.md: found 'Unreleased' on top, expected '1\.2\.3' as in CMakeLists\.txt; .*", "--dry-run")
        self.write("CHANGELOG.md", "# Changes\n\n## 1.2.3 (2026-11-26)\n")
        self.write("debian/changelog", "disparityd (1.2.2-1) unstable; urgency=medium\n")
        self.commit()
        self.expect_refusal(r"debian/changelog: found '1\.2\.2', expected '1\.2\.3' as in CMakeLists\.txt; .*", "--yes")
        self.write("CMakeLists.txt", "project(other)\n")
        self.commit()
        self.expect_refusal(r"CMakeLists\.txt: found no version, expected .*", "--yes")

    def test_a_second_release_of_a_version_is_refused(self):
        self.git("tag", "v1.2.3")
        made = self.release("--yes")
        self.assertRegex(made.stderr, r"\Atools/release: error: v1\.2\.3: the tag is there already; .*\n\Z")
        self.assertEqual(made.returncode, 1)

    def test_without_a_terminal_it_does_not_tag_unasked(self):
        made = self.release()
        self.assertEqual((made.returncode, made.stderr), (1, "tools/release: error: cannot ask here whether to tag; give --yes\n"))
        self.assertEqual(self.git("tag"), "")

    def test_options_and_places(self):
        self.expect_refusal("unknown option '--now'; allowed: --dry-run, --yes, --help", "--now", status=2)
        shutil.rmtree(self.root / ".git")
        made = self.release("--yes")
        self.assertRegex(made.stderr, r"\Atools/release: error: \S+/project: is no git checkout; .*\n\Z")

    def test_a_dry_run_makes_nothing(self):
        made = self.release("--dry-run")
        self.assertEqual((made.returncode, made.stderr), (0, ""))
        self.assertRegex(made.stdout, r"\Arelease 1\.2\.3 of [0-9a-f]{12}: build/archive/disparityd-1\.2\.3\.tar\.gz, tag v1\.2\.3 "
                                      r"\(not signed: no key\)\n\Z")
        self.assertEqual(self.git("tag"), "")
        self.assertFalse((self.root / "build").exists())

    def test_archive_packages_and_tag(self):
        self.write("debian/changelog", "disparityd (1:1.2.3-1) unstable; urgency=medium\n")
        self.write("tools/package", '#!/bin/sh\necho "packages $*"\n[ ! -e ../broken ]\n')
        (self.root / "tools" / "package").chmod(0o755)
        self.commit()
        (self.home / "broken").touch()
        self.assertEqual(self.release("--yes").returncode, 1)
        self.assertEqual(self.git("tag"), "")
        archive = self.root / "build/archive/disparityd-1.2.3.tar.gz"
        first = archive.read_bytes()
        (self.home / "broken").unlink()
        made = self.release("--yes")
        self.assertEqual((made.returncode, made.stderr), (0, ""))
        self.assertIn("\npackages --yes\n", made.stdout)
        self.assertTrue(made.stdout.endswith("tagged v1.2.3; to publish it: git push origin main v1.2.3\n"))
        self.assertEqual(archive.read_bytes(), first)
        self.assertEqual(archive.with_name(archive.name + ".sha256").read_text(encoding="utf-8"),
                         f"{hashlib.sha256(first).hexdigest()}  {archive.name}\n")
        with tarfile.open(archive) as opened:
            self.assertIn("disparityd-1.2.3/tools/package", opened.getnames())
        self.assertEqual(self.git("cat-file", "-t", "v1.2.3"), "tag\n")
        self.assertEqual(self.git("rev-parse", "v1.2.3^{commit}"), self.git("rev-parse", "HEAD"))


if __name__ == "__main__":
    unittest.main()

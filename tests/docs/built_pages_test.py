# SPDX-License-Identifier: Apache-2.0
"""Manual pages and completions that the build made know every option that --help shows, and those who read them accept them.

Usage: built_pages_test.py CASE FOLDER PROGRAM... with the folder of the pages and the paths of the programs. CASE is a class of this
file. Exit status 77 where what it needs is not installed, said on standard output.
"""
import functools
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

SKIP = 77
FOLDER = pathlib.Path(sys.argv[2]).resolve()
PROGRAMS = {pathlib.Path(path).name: pathlib.Path(path).resolve() for path in sys.argv[3:]}
# "  -o,--output DIR    folder to fill"
OPTIONS = re.compile(r"^  (-[^\s=]+)", re.MULTILINE)
COMMANDS = re.compile(r"^Subcommands:\n((?:  .*\n)+)", re.MULTILINE)


def run(*command, **options):
    return subprocess.run([str(part) for part in command], capture_output=True, text=True, timeout=120, check=False, **options)


@functools.lru_cache(maxsize=None)
def help_of(name, *command):
    made = run(PROGRAMS[name], *command, "--help")
    assert made.returncode == 0, made.stderr
    return made.stdout


def commands_of(name):
    found = COMMANDS.search(help_of(name))
    return [line.split()[0] for line in found[1].splitlines() if not line.startswith("   ")] if found else []


def paths():
    """[program] and [program, sub-command] of all there are."""
    return [[name] for name in PROGRAMS] + [[name, command] for name in PROGRAMS for command in commands_of(name)]


def options_of(path):
    """Names of the options that --help shows."""
    names = [name for found in OPTIONS.findall(help_of(*path)) for name in found.split(",")]
    assert len(names) > 1, path
    return names


def page(path):
    found = list(FOLDER.glob(f"man/man?/{'-'.join(path)}.[18]"))
    assert len(found) == 1, f"{path}: {found}"
    return found[0]


class Pages(unittest.TestCase):
    def test_they_have_every_option(self):
        for path in paths():
            text = page(path).read_text(encoding="utf-8")
            for name in options_of(path):
                self.assertIn("\\fB" + name.replace("-", "\\-") + "\\fR", text, page(path))

    def test_the_service_and_its_configuration_have_sections_of_their_own(self):
        self.assertEqual(page(["disparityd"]).name, "disparityd.8")
        text = (FOLDER / "man/man5/disparityd.toml.5").read_text(encoding="utf-8")
        self.assertIn("\n.SH [match]\n", text)
        self.assertIn("\\fBd_min\\fR = 0\n.TQ\n\\fBdisparities\\fR = 64\n", text)
        self.assertIn("d_min allowed: \\-256 ..\\& 256.\n", text)

    def test_examples_and_exit_status_are_there(self):
        for path in paths():
            text = page(path).read_text(encoding="utf-8")
            self.assertIn("\n.SH EXAMPLES\n.nf\n" + path[0].replace("-", "\\-"), text, page(path))
        for name in PROGRAMS:
            self.assertIn("\n.SH EXIT STATUS\n.TP\n\\fB0\\fR\n", page([name]).read_text(encoding="utf-8"), name)


class WellFormed(unittest.TestCase):
    """Of the programs that read manual pages, those that are here."""

    READERS = {"mandoc": ["mandoc", "-Tlint", "-Wwarning"], "groff": ["groff", "-man", "-ww", "-Tutf8", "-z"],
               "man": ["man", "--warnings", "-l"]}

    @staticmethod
    def missing():
        return "" if any(shutil.which(name) for name in WellFormed.READERS) else "no mandoc, groff or man is installed"

    def test_no_warning(self):
        found = sorted(FOLDER.glob("man/man?/*"))
        self.assertGreater(len(found), len(PROGRAMS))
        for name, command in self.READERS.items():
            if shutil.which(name):
                for one in found:
                    made = run(*command, one, env=os.environ | {"MANWIDTH": "80", "LC_ALL": "C.UTF-8", "MANPAGER": "cat"})
                    said = made.stderr + (made.stdout if name == "mandoc" else "")
                    self.assertEqual((made.returncode, said), (0, ""), f"{name}: {one}")


class Bash(unittest.TestCase):
    @staticmethod
    def missing():
        return "" if shutil.which("bash") else "bash is not installed"

    def completed(self, *words):
        """What Tab offers behind the last word."""
        script = 'source "$1" || exit 1; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); "_${1//-/_}"; printf "%s\\n" "${COMPREPLY[@]}"'
        made = run("bash", "--norc", "-c", script, "bash", FOLDER / "bash" / words[0], *words, cwd=self.folder)
        self.assertEqual((made.returncode, made.stderr), (0, ""))
        return made.stdout.split()

    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        (self.folder / "walk.mkv").touch()
        (self.folder / "out").mkdir()

    def test_options_and_sub_commands(self):
        for path in paths():
            self.assertEqual(sorted(self.completed(*path, "-")), sorted(options_of(path)), path)
        self.assertEqual(self.completed("disparityctl", ""), commands_of("disparityctl"))
        self.assertEqual(self.completed("disparityctl", "proc"), ["process"])
        self.assertEqual(self.completed("disparityctl", "process", "--pre"), ["--preset"])

    def test_values(self):
        self.assertEqual(sorted(self.completed("disparityctl", "process", "")), ["out", "walk.mkv"])
        self.assertEqual(self.completed("disparityctl", "process", "walk.mkv", "-o", ""), ["out"])
        self.assertEqual(self.completed("disparityctl", "process", "walk.mkv", "--output", "=", "o"), ["out"])
        self.assertEqual(self.completed("disparityctl", "process", "--output", "="), ["out"])
        self.assertEqual(self.completed("disparityctl", "process", "--method", ""), [])
        self.assertEqual(sorted(self.completed("disparityd", "--config", "")), ["out", "walk.mkv"])
        self.assertEqual(self.completed("disparityd", "--set", "match.dis"), ["match.disparities="])

    def test_shellcheck(self):
        if not shutil.which("shellcheck"):
            self.skipTest("shellcheck is not installed")
        made = run("shellcheck", "--exclude=SC2034", *sorted((FOLDER / "bash").iterdir()))
        self.assertEqual(made.stdout, "")


class Zsh(unittest.TestCase):
    @staticmethod
    def missing():
        return "" if shutil.which("zsh") else "zsh is not installed"

    def test_options_and_syntax(self):
        for path in paths():
            file = FOLDER / "zsh" / f"_{path[0]}"
            made = run("zsh", "-f", "-n", file)
            self.assertEqual((made.returncode, made.stderr), (0, ""))
            text = file.read_text(encoding="utf-8")
            if len(path) == 2:
                text = re.search(rf"^ +{path[1]}\)\n(.*?);;$", text, re.MULTILINE | re.DOTALL)[1]
            for name in options_of(path):
                self.assertRegex(text, rf"'(?:\*|\([^)]*\))?{name}=?\[", path)

    def test_the_shell_finds_them(self):
        script = 'fpath=("$1" $fpath); autoload -Uz compinit; compinit -u -D; print -l ${_comps[disparityctl]} ${_comps[disparityd]}'
        made = run("zsh", "-f", "-c", script, "zsh", FOLDER / "zsh")
        self.assertEqual(made.stdout.split(), ["_disparityctl", "_disparityd"], made.stderr)


class Fish(unittest.TestCase):
    @staticmethod
    def missing():
        return "" if shutil.which("fish") else "fish is not installed"

    def completed(self, name, line):
        with tempfile.TemporaryDirectory() as home:
            made = run("fish", "--no-config", "-c", "source $argv[1]; complete -C $argv[2]", FOLDER / "fish" / f"{name}.fish", line,
                       cwd=home, env=os.environ | {"HOME": home, "XDG_CONFIG_HOME": home, "XDG_DATA_HOME": home})
        self.assertEqual((made.returncode, made.stderr), (0, ""))
        return [one.partition("\t")[0] for one in made.stdout.splitlines()]

    def test_options_and_sub_commands(self):
        for path in paths():
            names = set(self.completed(path[0], " ".join(path) + " --")) | set(self.completed(path[0], " ".join(path) + " -"))
            self.assertLessEqual(set(options_of(path)), names, path)
        self.assertEqual(sorted(self.completed("disparityctl", "disparityctl ")), sorted(commands_of("disparityctl")))
        self.assertEqual(self.completed("disparityctl", "disparityctl process --prese"), ["--preset"])
        self.assertEqual(self.completed("disparityd", "disparityd --set match.dis"), ["match.disparities="])


def main():
    case = sys.argv[1]
    missing = getattr(globals()[case], "missing", str)()
    if missing:
        print(f"skipped: {missing}")
        return SKIP
    unittest.main(argv=[sys.argv[0], case])
    return 0


if __name__ == "__main__":
    sys.exit(main())

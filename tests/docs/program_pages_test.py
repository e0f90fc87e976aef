# SPDX-License-Identifier: Apache-2.0
"""tools/docs/program_pages.py on a program that is made up: text that roff and shells would misread."""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

TOOL = pathlib.Path(__file__).resolve().parents[2] / "tools/docs/program_pages.py"

EXAMPLE = """# SPDX-License-Identifier: Apache-2.0
# Not of a section.

[source]
# Where "frames" come from.
uri = "v4l2:auto"
# Two with one comment.
low = 1
#high = 2
"""


def option(*names, **facts):
    usual = {"names": list(names), "positional": False, "value": "", "several": False, "required": False, "default": "",
             "group": "Options", "description": "does it", "needs": [], "excludes": []}
    return usual | facts


def program(**facts):
    usual = {"name": "made-up", "description": "Makes something.", "footer": "", "options": [option("-h", "--help")], "commands": [],
             "keys": []}
    return usual | facts


class ProgramPages(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        (self.folder / "example.toml").write_text(EXAMPLE, encoding="utf-8")

    def make(self, tree):
        (self.folder / "tree.json").write_text(json.dumps(tree), encoding="utf-8")
        return subprocess.run([sys.executable, "-B", TOOL, "--version", "1.2.3", "--example", self.folder / "example.toml", self.folder,
                               self.folder / "tree.json"], capture_output=True, text=True, check=False,
                              env={"PATH": "/usr/bin:/bin", "SOURCE_DATE_EPOCH": "86400"})

    def made(self, tree, name):
        ran = self.make(tree)
        self.assertEqual((ran.returncode, ran.stderr), (0, ""))
        return (self.folder / name).read_text(encoding="utf-8")

    def test_text_stays_what_it_is(self):
        footer = ("A note of\ntwo lines.\nword: what it means.\nExamples: made-up '.x'\n          made-up \\n\n"
                  "Exit status: 0 done; 1 refused,\nfor a reason. Every end is one.")
        page = self.made(program(footer=footer, options=[option("--a-b", value="X", description=".5 isn't [one]: 'two' \\ three")]),
                         "man/man1/made-up.1")
        self.assertIn('.TH MADE\\-UP 1 "1970-01-02" "1.2.3" "disparityd"\n', page)
        self.assertIn(".TP\n\\fB\\-\\-a\\-b\\fR \\fIX\\fR\n\\&.5 isn\\(aqt [one]: \\(aqtwo\\(aq \\e three.\n", page)
        self.assertIn(".SH NOTES\nA note of two lines.\n.PP\nword: what it means. Every end is one.\n", page)
        self.assertIn(".SH EXIT STATUS\n.TP\n\\fB0\\fR\nDone.\n.TP\n\\fB1\\fR\nRefused, for a reason.\n", page)
        self.assertIn(".SH EXAMPLES\n.nf\nmade\\-up \\(aq.x\\(aq\nmade\\-up \\en\n.fi\n", page)

    def test_every_shell_reads_the_text(self):
        tree = program(options=[option("-o", "--out", value="DIR", description="a [b]: 'c' \\ $d `e` \"f\"; more"),
                                option("--set", value="SECTION.KEY=VALUE", several=True, description="sets it")])
        self.assertIn("'(-o --out)--out=[a \\[b\\]\\: '\\''c'\\'' \\\\ $d `e` \"f\"]:DIR:_files -/'", self.made(tree, "zsh/_made-up"))
        self.assertIn("-s o -l out -x -a '(__fish_complete_directories)' -d 'a [b]: \\'c\\' \\\\ $d `e` \"f\"'\n",
                      self.made(tree, "fish/made-up.fish"))
        self.assertIn("folders=' -o --out '\n", self.made(tree, "bash/made-up"))
        for name in ("bash/made-up", "zsh/_made-up"):
            self.assertEqual(subprocess.run(["bash", "-n", self.folder / name], capture_output=True, check=False).stderr, b"")

    def test_sub_commands_have_pages(self):
        tree = program(commands=[program(name="go", description="Goes.")])
        self.assertIn("made\\-up\\-go \\- goes\n", self.made(tree, "man/man1/made-up-go.1"))
        self.assertIn(".BR made\\-up\\-go (1)\n", self.made(tree, "man/man1/made-up.1"))

    def test_keys_are_those_of_the_example(self):
        keys = [{"name": f"source.{name}", "allowed": allowed} for name, allowed in
                (("uri", "a text"), ("low", "0 .. 2"), ("high", "0 .. 3"))]
        page = self.made(program(name="made-upd", keys=keys), "man/man5/disparityd.toml.5")
        self.assertIn("\\fBlow\\fR = 1\n.TQ\n\\fBhigh\\fR = 2\nTwo with one comment.\n.br\nlow allowed: 0 ..\\& 2.\n.br\n"
                      "high allowed: 0 ..\\& 3.\n", page)
        self.assertNotIn("Not of a section", page)
        for wrong, said in ((keys[:2], "explains source.high,"), (keys + [{"name": "source.loop", "allowed": ""}],
                                                                  "explains no source.loop,")):
            ran = self.make(program(keys=wrong))
            self.assertEqual(ran.returncode, 1)
            self.assertRegex(ran.stderr, rf"\A.*example.toml: the example of the configuration {said} expected: [^\n]*\n\Z")


if __name__ == "__main__":
    unittest.main()

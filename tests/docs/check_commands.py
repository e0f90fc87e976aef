# SPDX-License-Identifier: Apache-2.0
"""Commands that pages show must exist: each sub-command, and each option as the program's own --help has it.

Usage: check_commands.py ROOT PROGRAM... with the paths of the programs. Prints each mistake as FILE:LINE: text; exit status 1 if there
is one.
"""
import pathlib
import re
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "house"))
import check_house  # noqa: E402

SPAN = re.compile(r"`([^`]+)`")
OPTION = re.compile(r"(?<![\w-])--[a-z][a-z0-9-]*")
SCRIPTS = ("tools/demo", "tools/test", "tools/benchmarks", "tools/release", "lab/measure-ages", "lab/measure-daemon",
           "lab/measure-neighbours", "lab/measure-page", "lab/loop-cycles", "tests/kernels/instructions/instruction-counts")
WITH_SUB_COMMANDS = {"disparityctl"}
# What a shell would not hand to the program.
END_OF_COMMAND = re.compile(r"\s(?:#|&&|\||;|&\s*$|>|2>).*$")


def commands_of(text):
    """(line number, command) of every line in a block of code and every span of code."""
    fenced = False
    for number, line in enumerate(text.splitlines(), 1):
        if line.lstrip().startswith("```"):
            fenced = not fenced
        elif fenced or line.startswith("    "):
            for part in line.split("&&"):
                yield number, part.strip()
        else:
            for span in SPAN.findall(line):
                yield number, span.strip()


class Programs:
    def __init__(self, root, paths):
        self.paths = {pathlib.Path(path).name: [path] for path in paths}
        self.paths.update({script: [str(root / script)] for script in SCRIPTS if (root / script).is_file()})
        self.helps = {}

    def help(self, name, command=None):
        """What --help says, or None where the program has no such sub-command."""
        key = (name, command)
        if key not in self.helps:
            made = subprocess.run(self.paths[name] + ([command] if command else []) + ["--help"], capture_output=True,
                                  text=True, check=False, timeout=120)
            self.helps[key] = made.stdout if made.returncode == 0 else None
        return self.helps[key]

    def problem(self, command):
        """One line on what is wrong with a command of these programs; empty when nothing is, or when it is of another."""
        words = END_OF_COMMAND.sub("", command).split()
        while words and (re.match(r"^[A-Z_]+=", words[0]) or words[0] in ("sudo", "nice")):
            words.pop(0)
        if not words:
            return ""
        name = words[0].removeprefix("build/release/bin/")
        if name not in self.paths:
            return ""
        options = {option for word in words[1:] for option in OPTION.findall(word) if word.startswith("--")}
        sub = None
        if name in WITH_SUB_COMMANDS and len(words) > 1 and not words[1].startswith("-"):
            sub = words[1]
            if self.help(name, sub) is None:
                return f"{name} has no sub-command {sub}"
        known = set(OPTION.findall(self.help(name, sub) or "")) | {"--help"}
        unknown = sorted(options - known)
        return f"{' '.join(filter(None, (name, sub)))} has no option {', '.join(unknown)}" if unknown else ""


def mistakes(root, programs):
    found = []
    for name in check_house.project_files(root):
        if not name.endswith(".md"):
            continue
        text = (root / name).read_text(encoding="utf-8")
        for number, command in commands_of(text):
            problem = programs.problem(command)
            if problem:
                found.append(f"{name}:{number}: {problem}: {command}")
    return found


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    found = mistakes(root, Programs(root, sys.argv[2:]))
    print("\n".join(found) if found else "all commands of the documents exist")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())

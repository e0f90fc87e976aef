#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes the manual pages and shell completions of the programs, of what they print with --option-tree.

Usage: program_pages.py --version VERSION --example disparityd.example.toml FOLDER TREE.json...
Fills FOLDER/man, FOLDER/bash, FOLDER/zsh and FOLDER/fish; what was in these before is removed. The build does it.
"""
import argparse
import datetime
import os
import pathlib
import shutil
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import manual_page  # noqa: E402
import program_tree  # noqa: E402
import shell_completion  # noqa: E402

CONFIGURATION = ("disparityd.toml", 5)


def day_of_sources(example):
    """Returns the day that the pages bear: SOURCE_DATE_EPOCH's, the commit's, else that of the file. The same sources give the
    same pages."""
    seconds = os.environ.get("SOURCE_DATE_EPOCH", "")
    if not seconds.isdigit():
        asked = subprocess.run(["git", "-C", str(example.parent), "log", "-1", "--format=%ct", "--", "."], capture_output=True,
                               text=True, check=False) if shutil.which("git") else None
        seconds = asked.stdout.strip() if asked else ""
    if not seconds.isdigit():
        seconds = str(int(example.stat().st_mtime))
    return datetime.datetime.fromtimestamp(int(seconds), datetime.timezone.utc).strftime("%Y-%m-%d")


def section_of(program):
    """Returns 8 for the service, 1 for programs that people call."""
    return 8 if program.keys else 1


def pages(programs, example, date, version):
    """Returns {name of the file: text} of all manual pages."""
    made = {}
    of_programs = [(program.name, section_of(program)) for program in programs]
    for program in programs:
        section = section_of(program)
        others = [page for page in of_programs if page[0] != program.name]
        commands = [(f"{program.name}-{sub.name}", section) for sub in program.commands]
        also = others + commands + ([CONFIGURATION] if program.keys else [])
        made[f"man{section}/{program.name}.{section}"] = manual_page.program_page(
            program, [program.name], section, date, version, also)
        for sub in program.commands:
            made[f"man{section}/{program.name}-{sub.name}.{section}"] = manual_page.program_page(
                sub, [program.name, sub.name], section, date, version, [(program.name, section)])
        if program.keys:
            name, number = CONFIGURATION
            made[f"man{number}/{name}.{number}"] = manual_page.configuration_page(
                example, program.keys, date, version, [(program.name, section)])
    return made


def write(folder, files):
    shutil.rmtree(folder, ignore_errors=True)
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--version", required=True)
    parser.add_argument("--example", required=True, type=pathlib.Path, help="the example of the daemon's configuration")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("tree", nargs="+", type=pathlib.Path)
    arguments = parser.parse_args()
    programs = [program_tree.read_tree(path.read_text(encoding="utf-8")) for path in arguments.tree]
    try:
        made = pages(programs, arguments.example.read_text(encoding="utf-8"), day_of_sources(arguments.example), arguments.version)
    except ValueError as error:
        sys.exit(f"{arguments.example}: {error}")
    write(arguments.folder / "man", made)
    write(arguments.folder / "bash", {program.name: shell_completion.bash(program) for program in programs})
    write(arguments.folder / "zsh", {"_" + program.name: shell_completion.zsh(program) for program in programs})
    write(arguments.folder / "fish", {program.name + ".fish": shell_completion.fish(program) for program in programs})


if __name__ == "__main__":
    main()

# SPDX-License-Identifier: Apache-2.0
"""Lets g++ of a Debian that is only unpacked read sources of the project, with that Debian's headers.

Usage: read_with_compiler.py ROOT BUILD JOBS [FOLDER=FOLDER...]. ROOT: the unpacked Debian. BUILD: a configured build of this machine by
ninja, with what protoc makes: it knows how each file is compiled. A folder of headers of this machine is looked for at the same place
below ROOT, or where FOLDER=FOLDER says.

Read are the fewest sources that include every header which the project includes of libraries that differ there; those of one
target at once: large headers then are read once, and the house rule on names allows it. Nothing is optimised and nothing written
(-fsyntax-only).
"""
import concurrent.futures
import json
import re
import shlex
import subprocess
import sys
import time
from pathlib import Path

# Headers of libraries whose interface differs, and the project's own that stand for one.
DIFFERING = re.compile(r'^\s*#\s*include\s*[<"]((?:opencv2|libav\w+|libsw\w+|boost|fmt|spdlog)/[^">]+'
                       r'|toml\.hpp|daemon/config/toml_library\.h|blockingconcurrentqueue\.h|pipeline/stage_queue\.h)[">]', re.MULTILINE)
OWN = re.compile(r'^#include "([^"]+)"', re.MULTILINE)


def commands(build):
    """Of each source the target it belongs to and the words that compile it."""
    said = subprocess.run(["ninja", "-C", build, "-t", "compdb"], capture_output=True, text=True, check=True).stdout
    for entry in json.loads(said):
        target, inside, _ = entry["output"].partition(".dir/")
        file = Path(entry["directory"], entry["file"])
        if not inside or target.startswith("tests/") or file.suffix not in (".cpp", ".cxx"):
            continue
        together = re.findall(r'#include "([^"]+)"', file.read_text()) if "/Unity/" in entry["file"] else [str(file)]
        for source in together:
            if Path(build).resolve() in Path(source).parents:
                continue  # made by the build, of its own data
            yield source, target.replace("CMakeFiles/", ""), shlex.split(entry["command"])


def interfaces(source, project):
    """What a source and the project's headers that it names include of the libraries that differ."""
    text = Path(source).read_text(encoding="utf-8")
    headers = (project / name for name in OWN.findall(text))
    texts = [text, *(header.read_text(encoding="utf-8") for header in headers if header.is_file())]
    return {name for each in texts for name in DIFFERING.findall(each)}


def fewest(offers):
    """Sources that together have everything that any has, the most useful first."""
    left, chosen = set().union(*offers.values()), []
    while left:
        best = max(sorted(offers), key=lambda source: (len(offers[source] & left), -len(offers[source])))
        left -= offers[best]
        chosen.append(best)
    return chosen


def options_of(words, root, moved):
    """Of a command what decides how a file is understood: definitions, folders of headers, language, warnings."""
    kept, words = [], iter(words)
    for word in words:
        if word == "-isystem":
            folder = next(words)
            kept += [word, f"{root}{moved.get(folder, folder)}" if folder.startswith("/usr/") else folder]
        elif word.startswith(("-D", "-I", "-W", "-std=")) and word != "-Wno-error=restrict":
            kept.append(word)
    return kept


def compiler(root):
    """g++'s inner program, by its own loader and libraries, which needs no rights; and the headers that it would add itself."""
    inner = next(root.glob("usr/libexec/gcc/*/*/cc1plus"))
    version, machine = inner.parent.name, inner.parents[1].name
    headers = [f"include/c++/{version}", f"include/{machine}/c++/{version}", f"include/c++/{version}/backward",
               f"lib/gcc/{machine}/{version}/include", f"include/{machine}", "include"]
    start = [str(next(root.glob("lib64/ld-linux*"))), "--library-path", str(root / "usr/lib" / machine), str(inner)]
    return ([*start, "-quiet", "-fsyntax-only", "-o", "/dev/null", "-D_GNU_SOURCE", "-nostdinc"],
            [word for folder in headers for word in ("-isystem", str(root / "usr" / folder))])


def read(program, options, sources):
    began = time.monotonic()
    text = "".join(f'#include "{source}"\n' for source in sources)
    outcome = subprocess.run([*program[0], *options, "-Wno-shadow", "-Wno-subobject-linkage", *program[1]], input=text,
                             text=True, capture_output=True)
    return time.monotonic() - began, outcome.returncode, outcome.stdout + outcome.stderr


def main():
    root, build, jobs = Path(sys.argv[1]).resolve(), sys.argv[2], int(sys.argv[3])
    moved = dict(pair.split("=", 1) for pair in sys.argv[4:])
    known = {source: (target, words) for source, target, words in commands(build)}
    targets = {}
    for source in fewest({source: interfaces(source, Path.cwd()) for source in known}):
        target, words = known[source]
        targets.setdefault(target, (words, []))[1].append(source)
    refused = 0
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        reading = {target: pool.submit(read, compiler(root), options_of(words, root, moved), sources)
                   for target, (words, sources) in targets.items()}
        for target, outcome in reading.items():
            seconds, status, said = outcome.result()
            names = " ".join(sorted(Path(source).name for source in targets[target][1]))
            print(f"{target}: {names}: {'REFUSED' if status else 'taken'} after {seconds:.1f} s\n{said}", end="", flush=True)
            refused += status != 0
    return refused != 0


if __name__ == "__main__":
    sys.exit(main())

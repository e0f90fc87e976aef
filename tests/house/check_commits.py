# SPDX-License-Identifier: Apache-2.0
"""The rule for messages of commits: a subject of at most 72 characters, an empty line, a body with the reason.

Usage: check_commits.py [ROOT]. Looks at the commits that HEAD has and BASE, the last one before the rule, has not;
merges are exempt. Prints each violation; exit status 1 if there is one, 77 with the reason when there is nothing to
look at: no git, no repository (an export), or a clone without BASE (a shallow one).
"""
import os
import pathlib
import re
import subprocess
import sys

BASE = "947a75a4c3cd13c6e01b8536bbb64cdc9fbf791d"
MAX_SUBJECT = 72
SKIPPED = 77
# Lines for programs, which give no reason: "Signed-off-by: ...".
TRAILER = re.compile(r"^[A-Z][A-Za-z-]*-by: ")
# What a hook of git sets, which would lead to another repository.
ELSEWHERE = {"GIT_DIR", "GIT_WORK_TREE", "GIT_INDEX_FILE", "GIT_COMMON_DIR", "GIT_OBJECT_DIRECTORY", "GIT_PREFIX"}


class NothingToCheck(Exception):
    """Says why."""


def git(root, *arguments):
    """Runs git in this repository, whatever repository the caller's environment names."""
    environment = {name: value for name, value in os.environ.items() if name not in ELSEWHERE}
    command = ["git", "-C", str(root), *arguments]
    return subprocess.run(command, capture_output=True, check=False, env=environment)


def new_commits(root, base):
    """(short hash, message) of each new commit, newest first."""
    try:
        top = git(root, "rev-parse", "--show-toplevel")
    except FileNotFoundError:
        raise NothingToCheck("git is not installed") from None
    if top.returncode != 0:
        raise NothingToCheck(f"git sees no repository: {top.stderr.decode(errors='replace').strip()}")
    if pathlib.Path(top.stdout.decode().rstrip("\n")).resolve() != root:
        raise NothingToCheck("an export: the repository around it is another one")
    if git(root, "merge-base", "--is-ancestor", base, "HEAD").returncode != 0:
        raise NothingToCheck(f"HEAD does not descend from {base[:10]}, as in a shallow clone")
    log = git(root, "log", "-z", "--no-merges", "--encoding=UTF-8", "--format=%h%n%B", f"{base}..HEAD")
    if log.returncode != 0:
        raise RuntimeError(f"git log failed: {log.stderr.decode(errors='replace').strip()}")
    for entry in log.stdout.decode(errors="replace").split("\0"):
        if entry:
            name, _, message = entry.partition("\n")
            yield name, message


def problems(message):
    """What is wrong with a message, one text each."""
    subject, *rest = message.strip("\n").split("\n")
    found = []
    if not subject.strip():
        found.append("the subject is empty")
    if len(subject) > MAX_SUBJECT:
        found.append(f"the subject has {len(subject)} characters, allowed: {MAX_SUBJECT}")
    if rest and rest[0].strip():
        found.append("the second line is not empty")
    if not any(line.strip() and not TRAILER.match(line) for line in rest):
        found.append("there is no body: say why")
    return found


def violations(root, base=BASE):
    return [f'commit {name} "{message[:MAX_SUBJECT].splitlines()[0] if message.strip() else ""}": {problem}'
            for name, message in new_commits(root, base) for problem in problems(message)]


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()
    try:
        found = violations(root)
    except NothingToCheck as reason:
        print(f"messages of commits are not checked: {reason}")
        return SKIPPED
    if found:
        print("\n".join(found))
        print("CONTRIBUTING.md has the rule. To mend: git commit --amend, older ones: git rebase -i")
        return 1
    print("messages of commits follow the rule")
    return 0


if __name__ == "__main__":
    sys.exit(main())

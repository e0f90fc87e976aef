# SPDX-License-Identifier: Apache-2.0
"""Reads what tools/test left in a folder (ctest's JUnit files, steps.tsv) and says it in plain words.

Usage: test_report.py FOLDER. Exit status 1 when something failed or nothing passed.
"""
import collections
import pathlib
import re
import sys
import xml.etree.ElementTree as ElementTree

GTEST_REASON = re.compile(r"^\S+:\d+: Skipped\n(.+?)$", re.MULTILINE)
GTEST_CASE = re.compile(r"^\[ +(OK|SKIPPED|FAILED) +\] (\S+?),? .*\(\d+ ms\)$", re.MULTILINE)
UNITTEST_REASON = re.compile(r"\.\.\. skipped ['\"](.+)['\"]$", re.MULTILINE)


def skip_reason(case):
    output = case.findtext("system-out") or ""
    for pattern in (GTEST_REASON, UNITTEST_REASON):
        match = pattern.search(output)
        if match:
            return match.group(1).strip()
    lines = [line.strip() for line in output.splitlines() if line.strip()]
    return lines[-1] if lines else "no reason given"


def program_cases(name, output):
    """The same of each case of a GoogleTest program that ran as one test; nothing when it is none or was cut short."""
    if "Global test environment tear-down" not in output:
        return
    after = 0
    for match in GTEST_CASE.finditer(output):
        reason = GTEST_REASON.search(output, after, match.start())
        outcome = {"OK": "passed", "SKIPPED": "skipped", "FAILED": "failed"}[match.group(1)]
        yield outcome, f"{name}: {match.group(2)}", reason.group(1).strip() if reason else "no reason given"
        after = match.end()


def read_suite(path):
    """(outcome, name, reason) of each test of one ctest run."""
    for case in ElementTree.parse(path).getroot().iter("testcase"):
        name = f"{path.stem}: {case.get('name')}"
        cases = list(program_cases(name, case.findtext("system-out") or ""))
        if len(cases) > 1 and (case.find("failure") is None) == all(outcome != "failed" for outcome, _, _ in cases):
            yield from cases
        elif case.find("skipped") is not None or case.get("status") == "disabled":
            yield "skipped", name, skip_reason(case)
        elif case.get("status") == "run" and case.find("failure") is None:
            yield "passed", name, ""
        else:
            yield "failed", name, ""


def read_results(folder):
    for path in sorted(folder.glob("*.xml")):
        yield from read_suite(path)
    steps = folder / "steps.tsv"
    if steps.exists():
        for line in steps.read_text(encoding="utf-8").splitlines():
            outcome, what = line.split("\t", 1)
            yield outcome, what, what


def main():
    if len(sys.argv) != 2:
        sys.exit("usage: test_report.py FOLDER")
    count = collections.Counter()
    failed, skipped = [], collections.defaultdict(list)
    for outcome, name, reason in read_results(pathlib.Path(sys.argv[1])):
        count[outcome] += 1
        if outcome == "failed":
            failed.append(name)
        elif outcome == "skipped":
            skipped[reason].append(name)

    for reason, names in sorted(skipped.items()):
        print(f"skipped {len(names)}: {reason}")
        for name in names:
            print(f"  {name}")
    if failed:
        print(f"failed {len(failed)}:")
        for name in failed:
            print(f"  {name}")
    print(f"{count['passed']} passed, {count['failed']} failed, {count['skipped']} skipped")
    return 0 if count["passed"] and not count["failed"] else 1


if __name__ == "__main__":
    sys.exit(main())

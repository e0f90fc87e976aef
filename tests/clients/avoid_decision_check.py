# SPDX-License-Identifier: Apache-2.0
"""Runs the cases of avoid_cases.json with the decision of the Python example; avoid_decision_test.cpp does it with that in
C++. Needs neither numpy nor a daemon.

Usage: avoid_decision_check.py FOLDER-OF-DECISION.PY CASES. Prints each failure; exit status 1 if there is one.
"""
import json
import sys
import types

sys.path.insert(0, sys.argv[1])
import decision  # noqa: E402


def scan_of(frame):
    if "no_scan" in frame:
        return None
    if "only" in frame:
        sectors = frame["only"]
    else:
        named = {sector[0]: sector for sector in frame.get("sectors", [])}
        sectors = [named.get(edge, [edge, edge + 10, 1, 0, frame["free"]]) for edge in range(-90, 90, 10)]
    usual = [100, 0, 0]  # pixels, trust, doubts
    columns = list(zip(*([*sector, *usual[len(sector) - 5:]] for sector in sectors))) or [()] * 8
    names = ("from_deg", "to_deg", "state", "distance_m", "free_m", "pixels", "trust", "doubts")
    seen = frame.get("mounting")
    mounting = types.SimpleNamespace(height_m=seen[0], pitch_deg=seen[1]) if seen else None
    return types.SimpleNamespace(mounting=mounting, **dict(zip(names, columns)))


def take(decider, step):
    if "frame" in step:
        frame = step["frame"]
        return decider.see(frame["age"], frame.get("flags", 0), scan_of(frame), step["at"])
    if "gone" in step:
        return decider.gone(step["gone"])
    if "fail" in step:
        return decider.fail(step["fail"])
    return decider.wait(step["at"])


def failures_of(case):
    decider = decision.Decider(decision.Options(**case.get("options", {})))
    for number, step in enumerate(case["steps"]):
        where = f"{case['name']}, step {number}"
        patience, before = decider.patience_s(step["at"]), decider.decision
        now = take(decider, step)
        if "patience" in step and abs(patience - step["patience"]) > 1e-9:
            yield f"{where}: patience {patience}, expected {step['patience']}"
        if now.line() != step["line"]:
            yield f"{where}: {now.line()!r}, expected {step['line']!r}"
        if "change" in step and decision.is_change(before, now) != step["change"]:
            yield f"{where}: a change is expected to be {step['change']}"


def main():
    with open(sys.argv[2], encoding="utf-8") as file:
        table = json.load(file)
    failures = [text for case in table["cases"] for text in failures_of(case)]
    print("\n".join(failures) if failures else f"{len(table['cases'])} cases agree")
    return 1 if failures or not table["cases"] else 0


if __name__ == "__main__":
    sys.exit(main())

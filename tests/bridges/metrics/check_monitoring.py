# SPDX-License-Identifier: Apache-2.0
"""What docs/monitoring says must be so: every metric that page, rules and dashboard name is one that the program has.

Usage: check_monitoring.py ROOT PROGRAM. PROGRAM prints the metrics of a status that has everything. Prints each mistake as
FILE: text; exit status 1 if there is one.
"""
import pathlib
import re
import subprocess
import sys

import monitoring

PAGE, FOLDER = "docs/monitoring.md", "docs/monitoring"
RULES, RULE_TESTS, DASHBOARD = (f"{FOLDER}/disparityd.{end}" for end in ("rules.yml", "rules.test.yml", "dashboard.json"))
SEVERITIES = {"critical", "warning"}


def check_names(name, text, known):
    return [f"{name}: the program has no metric {metric}" for metric in sorted(set(monitoring.METRIC.findall(text)) - known)]


def check_page(page, text):
    found, has, names = monitoring.documented(page), monitoring.types(text), monitoring.labels(text)
    mistakes = [f"{PAGE}: no row for {metric}" for metric in sorted(has.keys() - found.keys())]
    mistakes += [f"{PAGE}: a row for {metric}, which the program does not have" for metric in sorted(found.keys() - has.keys())]
    for metric in sorted(found.keys() & has.keys()):
        kind, inside = found[metric]
        if kind != has[metric]:
            mistakes.append(f"{PAGE}: {metric} is a {has[metric]}, not a {kind}")
        if inside != names.get(metric, set()):
            mistakes.append(f"{PAGE}: the labels of {metric} are {sorted(names.get(metric, set()))}, not {sorted(inside)}")
    return mistakes


def check_rules(rules, tests):
    mistakes = []
    alerts = monitoring.alerts(rules)
    if not alerts:
        return [f"{RULES}: no alerts"]
    fire, wait = monitoring.tested(tests)
    for alert, rule in alerts.items():
        severity = re.search(r"^ +severity: (\w+)$", rule, re.MULTILINE)
        if not severity or severity.group(1) not in SEVERITIES:
            mistakes.append(f"{RULES}: {alert} has no severity, allowed: {', '.join(sorted(SEVERITIES))}")
        if not re.search(r"^ +summary: ['\"].+: .+\.['\"]$", rule, re.MULTILINE):
            mistakes.append(f"{RULES}: the summary of {alert} is one line: what is wrong, a colon, what to do")
        if alert not in fire:
            mistakes.append(f"{RULE_TESTS}: no test in which {alert} fires")
        if alert not in wait:
            mistakes.append(f"{RULE_TESTS}: no test in which {alert} does not fire")
    return mistakes


def check_dashboard(dashboard):
    mistakes, seen = [], set()
    for panel in monitoring.panels(dashboard):
        title = panel.get("title", "")
        if not title or not panel.get("description"):
            mistakes.append(f"{DASHBOARD}: panel {panel['id']} has no title or no description")
        if not panel["fieldConfig"]["defaults"].get("unit"):
            mistakes.append(f"{DASHBOARD}: panel '{title}' has no unit")
        if panel["id"] in seen:
            mistakes.append(f"{DASHBOARD}: panel '{title}' has the id of another one")
        seen.add(panel["id"])
        for target in panel["targets"]:
            if not monitoring.METRIC.search(target["expr"]):
                mistakes.append(f"{DASHBOARD}: panel '{title}' shows no metric of disparityd")
            if "$instance" not in target["expr"]:
                mistakes.append(f"{DASHBOARD}: panel '{title}' does not heed the chosen machine")
    return mistakes + check_places(monitoring.panels(dashboard))


def check_places(panels):
    taken, mistakes = {}, []
    for panel in panels:
        place = panel["gridPos"]
        for cell in ((x, y) for x in range(place["x"], place["x"] + place["w"]) for y in range(place["y"], place["y"] + place["h"])):
            if cell in taken or cell[0] >= 24:
                mistakes.append(f"{DASHBOARD}: panel '{panel['title']}' lies over {taken.get(cell, 'the edge')}")
                break
            taken[cell] = panel["title"]
    return mistakes


def mistakes(root, text):
    read = {name: (root / name).read_text(encoding="utf-8") for name in (PAGE, RULES, RULE_TESTS, DASHBOARD)}
    known = monitoring.series(text)
    found = check_names(PAGE, read[PAGE], known | monitoring.types(text).keys())
    for name in (RULES, RULE_TESTS):
        found += check_names(name, read[name], known)
    for expression in monitoring.expressions(read[DASHBOARD]):
        found += check_names(DASHBOARD, expression, known)
    return found + check_page(read[PAGE], text) + check_rules(read[RULES], read[RULE_TESTS]) + check_dashboard(read[DASHBOARD])


def main():
    text = subprocess.run([sys.argv[2]], check=True, capture_output=True).stdout.decode()
    found = mistakes(pathlib.Path(sys.argv[1]), text)
    print("\n".join(found) if found else f"{len(monitoring.types(text))} metrics agree")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())

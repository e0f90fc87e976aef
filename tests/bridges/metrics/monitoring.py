# SPDX-License-Identifier: Apache-2.0
"""Reads what docs/monitoring holds, and the metrics that the program has; without a YAML library, which not every machine has."""
import json
import re

METRIC = re.compile(r"\b(?:disparityd|disparity_web)_[a-z0-9_]*[a-z0-9]\b")
TYPE = re.compile(r"^# TYPE (\S+) (\S+)$", re.MULTILINE)
ROW = re.compile(r"^\| `((?:disparityd|disparity_web)_\w+)(?:\{([\w, ]+)\})?` \| (\w+) \|", re.MULTILINE)
SAMPLE = re.compile(r"^([a-z_]+)\{(.*)\} ", re.MULTILINE)
ALERT = re.compile(r"^ +- alert: (\w+)\n(.*?)(?=^ +- alert: |\Z)", re.MULTILINE | re.DOTALL)
TESTED = re.compile(r"^ +alertname: (\w+)\n +exp_alerts:( \[\])?$", re.MULTILINE)


def types(text):
    """{metric: type} of what the program prints."""
    return dict(TYPE.findall(text))


def series(text):
    """Names that an expression may use: histograms have three, and no sample of their own name."""
    names = set()
    for name, kind in types(text).items():
        names |= {name + end for end in ("_bucket", "_sum", "_count")} if kind == "histogram" else {name}
    return names


def labels(text):
    """{metric: set of label names} of the samples that have some, "le" left out."""
    found = {}
    for name, inside in SAMPLE.findall(text):
        name = re.sub(r"_(bucket|sum|count)$", "", name)
        found.setdefault(name, set()).update(set(re.findall(r'(\w+)="', inside)) - {"le"})
    return {name: names for name, names in found.items() if names}


def documented(page):
    """{metric: (type, set of label names)} of the tables in docs/monitoring.md."""
    return {name: (kind, set(re.findall(r"\w+", inside))) for name, inside, kind in ROW.findall(page)}


def alerts(rules):
    """{alert: the lines of its rule}"""
    return dict(ALERT.findall(rules))


def tested(tests):
    """(alerts that some test expects to fire, alerts that some test expects not to)"""
    found = TESTED.findall(tests)
    return {name for name, none in found if not none}, {name for name, none in found if none}


def panels(dashboard):
    """The panels of a dashboard that show something."""
    return [panel for panel in json.loads(dashboard)["panels"] if panel["type"] != "row"]


def expressions(dashboard):
    return [target["expr"] for panel in panels(dashboard) for target in panel["targets"]]

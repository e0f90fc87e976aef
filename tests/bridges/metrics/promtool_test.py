# SPDX-License-Identifier: Apache-2.0
"""Prometheus' own tool on what the program prints, and on what docs/monitoring holds.

Usage: promtool_test.py Metrics|Rules|Dashboard FOLDER PROGRAM. Exit status: 0 all is right, 1 something is not, 77 there is no
promtool.
"""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import monitoring


def run(command, text=None):
    """Whether the command says that all is right; prints what it says otherwise."""
    done = subprocess.run(command, input=text, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    if done.returncode != 0:
        print(" ".join(command), "->", done.returncode)
        print(done.stdout.decode(errors="replace"))
    return done.returncode == 0


def metrics(promtool, _, program):
    """Every kind of status; promtool also says what breaks Prometheus' rules for names."""
    good = True
    for which in ("filled", "hostile", "starting", "absent", "several"):
        text = subprocess.run([program, which], check=True, capture_output=True).stdout
        good &= run([promtool, "check", "metrics"], text)
    return good


def rules(promtool, folder, _):
    return (run([promtool, "check", "rules", str(folder / "disparityd.rules.yml")])
            and run([promtool, "test", "rules", str(folder / "disparityd.rules.test.yml")]))


def dashboard(promtool, folder, _):
    """The expressions of its panels, as rules: so promtool parses them. Grafana fills in what begins with a dollar."""
    lines = ["groups:", "  - name: dashboard", "    rules:"]
    for number, expression in enumerate(monitoring.expressions((folder / "disparityd.dashboard.json").read_text(encoding="utf-8"))):
        filled = re.sub(r"\$\w+", "x", expression.replace("$__rate_interval", "1m"))
        lines += [f"      - record: panel_{number}", f"        expr: {filled}".replace("expr: ", "expr: '") + "'"]
    with tempfile.TemporaryDirectory() as temporary:
        file = pathlib.Path(temporary) / "dashboard.rules.yml"
        file.write_text("\n".join(lines) + "\n", encoding="utf-8")
        return run([promtool, "check", "rules", str(file)])


def main():
    promtool = shutil.which("promtool")
    if not promtool:
        print("skipped: no promtool; sudo apt-get install prometheus")
        return 77
    case = {"Metrics": metrics, "Rules": rules, "Dashboard": dashboard}[sys.argv[1]]
    return 0 if case(promtool, pathlib.Path(sys.argv[2]), sys.argv[3]) else 1


if __name__ == "__main__":
    sys.exit(main())

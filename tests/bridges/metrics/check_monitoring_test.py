# SPDX-License-Identifier: Apache-2.0
"""Tests of check_monitoring.py: each mistake it is for is found, and a folder without mistakes has none."""
import json
import pathlib
import tempfile
import unittest

import check_monitoring

TEXT = """# HELP disparityd_up Here.
# TYPE disparityd_up gauge
disparityd_up 1
# HELP disparityd_state State.
# TYPE disparityd_state gauge
disparityd_state{state="running"} 1
# HELP disparityd_step_seconds Times.
# TYPE disparityd_step_seconds histogram
disparityd_step_seconds_bucket{step="capture",le="+Inf"} 1
disparityd_step_seconds_sum{step="capture"} 1
disparityd_step_seconds_count{step="capture"} 1
"""
PAGE = """| metric | type | meaning |
| --- | --- | --- |
| `disparityd_up` | gauge | here |
| `disparityd_state{state}` | gauge | state |
| `disparityd_step_seconds{step}` | histogram | times |
"""
RULES = """      - alert: Down
        expr: disparityd_up == 0
        labels:
          severity: critical
        annotations:
          summary: "It is away: start it."
"""
RULE_TESTS = """      - eval_time: 1m
        alertname: Down
        exp_alerts: []
      - eval_time: 2m
        alertname: Down
        exp_alerts:
          - exp_labels: {severity: critical}
"""


def dashboard(**changes):
    panel = {"id": 1, "type": "stat", "title": "Up", "description": "Here.", "gridPos": {"x": 0, "y": 0, "w": 4, "h": 4},
             "fieldConfig": {"defaults": {"unit": "none"}},
             "targets": [{"expr": 'disparityd_up{instance=~"$instance"}'}]}
    panel.update(changes)
    return json.dumps({"panels": [panel, {"id": 2, "type": "row"}]})


class CheckMonitoring(unittest.TestCase):
    def mistakes(self, page=PAGE, rules=RULES, tests=RULE_TESTS, board=None):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            (root / check_monitoring.FOLDER).mkdir(parents=True)
            for name, text in ((check_monitoring.PAGE, page), (check_monitoring.RULES, rules), (check_monitoring.RULE_TESTS, tests),
                               (check_monitoring.DASHBOARD, board or dashboard())):
                (root / name).write_text(text, encoding="utf-8")
            return "\n".join(check_monitoring.mistakes(root, TEXT))

    def test_nothing_is_wrong(self):
        self.assertEqual(self.mistakes(), "")

    def test_unknown_metrics(self):
        self.assertIn("no metric disparityd_gone", self.mistakes(page=PAGE + "disparityd_gone\n"))
        self.assertIn("no metric disparityd_gone", self.mistakes(rules=RULES.replace("disparityd_up", "disparityd_gone")))
        self.assertIn("no metric disparityd_gone", self.mistakes(tests=RULE_TESTS + "disparityd_gone\n"))
        gone = dashboard(targets=[{"expr": 'disparityd_gone{instance=~"$instance"}'}])
        self.assertIn("no metric disparityd_gone", self.mistakes(board=gone))

    def test_a_histogram_has_no_sample_of_its_own_name(self):
        self.assertIn("no metric disparityd_step_seconds", self.mistakes(rules=RULES + "# disparityd_step_seconds\n"))
        self.assertEqual(self.mistakes(rules=RULES + "# disparityd_step_seconds_bucket\n"), "")

    def test_rows(self):
        self.assertIn("no row for disparityd_up", self.mistakes(page=PAGE.replace("| `disparityd_up` | gauge | here |\n", "")))
        self.assertIn("disparityd_up is a gauge, not a counter", self.mistakes(page=PAGE.replace("up` | gauge", "up` | counter")))
        self.assertIn("the labels of disparityd_state are", self.mistakes(page=PAGE.replace("{state}", "")))
        self.assertIn("the labels of disparityd_step_seconds are", self.mistakes(page=PAGE.replace("{step}", "{step,le}")))

    def test_rules(self):
        self.assertIn("no alerts", self.mistakes(rules=""))
        self.assertIn("Down has no severity", self.mistakes(rules=RULES.replace("critical", "loud")))
        self.assertIn("the summary of Down", self.mistakes(rules=RULES.replace(": start it.", ".")))
        self.assertIn("no test in which Down fires", self.mistakes(tests=RULE_TESTS.replace("exp_alerts:\n", "exp_alerts: []\n")))
        self.assertIn("no test in which Down does not", self.mistakes(tests=RULE_TESTS.replace("exp_alerts: []", "exp_alerts:")))

    def test_panels(self):
        self.assertIn("no title", self.mistakes(board=dashboard(title="")))
        self.assertIn("no unit", self.mistakes(board=dashboard(fieldConfig={"defaults": {}})))
        self.assertIn("the edge", self.mistakes(board=dashboard(gridPos={"x": 22, "y": 0, "w": 4, "h": 4})))
        self.assertIn("chosen machine", self.mistakes(board=dashboard(targets=[{"expr": "disparityd_up"}])))
        self.assertIn("shows no metric", self.mistakes(board=dashboard(targets=[{"expr": 'up{instance=~"$instance"}'}])))


if __name__ == "__main__":
    unittest.main()

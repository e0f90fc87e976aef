# SPDX-License-Identifier: Apache-2.0
"""Does with the Python client's arithmetic what the C++ client's has done, and compares each result.

frame_flow_check.py FOLDER STEPS: clients/python/disparity with frame_flow.py and liveness.py, and a file of
frame_flow_test with a step on each line: its name, what goes in, "=", what C++ answered.
"""
import importlib.util
import sys


def load(folder, name):
    spec = importlib.util.spec_from_file_location(name, f"{folder}/{name}.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


def main():
    module = load(sys.argv[1], "frame_flow")
    liveness = load(sys.argv[1], "liveness")
    flow = clock = daemon = None
    count = 0
    with open(sys.argv[2], encoding="ascii") as steps:
        for line in steps:
            before, _, expected = line.partition("=")
            name, *given = before.split()
            numbers = [int(number) for number in given]
            if name == "start":
                flow, clock = module.FrameFlow(numbers[0] / 1000), module.DaemonClock()
                daemon = liveness.Liveness()
                found = [flow.interval()]
            elif name == "reads":
                found = flow.reads(*numbers) or []
            elif name == "given":
                found = flow.given(*numbers) or []
            elif name == "ask":
                found = [flow.ask(bool(numbers[0]))]
            elif name == "arrived":
                flow.arrived(module.Arrival(*numbers))
                found = [flow.interval(), flow.patience()]
            elif name == "fresh":
                found = [int(flow.fresh(module.Arrival(*numbers))), flow.patience()]
            elif name == "asks":
                found = [int(daemon.asks(*numbers))]
            elif name == "is_gone":
                found = [int(daemon.is_gone(*numbers))]
            elif name == "add":
                found = clock.add(*numbers) or []
            else:
                assert name == "latest", name
                found = [clock.latest(*numbers), clock.round_trip()]
            if found != [int(number) for number in expected.split()]:
                sys.exit(f"step {count}: {line.strip()}: Python answers {found}")
            count += 1
    assert count > 1000, count


main()

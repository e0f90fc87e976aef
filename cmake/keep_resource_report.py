# SPDX-License-Identifier: Apache-2.0
"""Compiler launcher for CUDA: runs the compiler and keeps what ptxas -v says beside the object, as OBJECT.resources.

Usage: keep_resource_report.py COMPILER ARGUMENTS... What else the compiler says is passed on.
"""
import pathlib
import subprocess
import sys


def main():
    command = sys.argv[1:]
    ran = subprocess.run(command, stderr=subprocess.PIPE, text=True, check=False)
    lines = ran.stderr.splitlines(keepends=True)
    sys.stderr.writelines(line for line in lines if not line.startswith("ptxas info") and "bytes stack frame" not in line)
    if ran.returncode == 0 and "-o" in command:
        report = pathlib.Path(command[command.index("-o") + 1] + ".resources")
        report.write_text("".join(lines), encoding="utf-8")
    return ran.returncode


if __name__ == "__main__":
    sys.exit(main())

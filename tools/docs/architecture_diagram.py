#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws docs/pictures/architecture.svg: the folders and which may include which.

Usage: tools/docs/architecture_diagram.py [--dot]. With --dot the text for Graphviz goes to standard output instead. The arrows
come from the table ARROWS that tests/house/check_house.py enforces, so picture and rule cannot differ. Needs `dot` (package
graphviz).
"""
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
PICTURE = ROOT / "docs/pictures/architecture.svg"
sys.path.insert(0, str(ROOT / "tests/house"))
import check_house  # noqa: E402

# What stands below a folder's name, and the colour of its kind.
PROGRAM, SERVICE, CORE, GROUND = "#dbe9f6", "#d9efd9", "#fbeecb", "#ececec"
FOLDERS = {
    "lab": ("programs that measure,<br/>built on request", PROGRAM),
    "bridges": ("clients that speak<br/>another protocol", PROGRAM),
    "tools": ("disparityctl, disparity-eval,<br/>disparity-bench, scripts", PROGRAM),
    "bindings": ("the matcher<br/>for Python", PROGRAM),
    "clients": ("C++, C and Python<br/>libraries", PROGRAM),
    "daemon": ("configuration, sockets,<br/>life of the service", SERVICE),
    "products": ("a finished frame<br/>as the protocol has it", CORE),
    "pipeline": ("stages, queues,<br/>workers, timing", CORE),
    "capture": ("sources of frames,<br/>recordings", CORE),
    "obstacles": ("obstacle scan", CORE),
    "trust": ("trust in frames", CORE),
    "calibration": ("camera models, maps,<br/>self-calibration", CORE),
    "kernels": ("algorithms: reference,<br/>cpu, cuda", GROUND),
    "proto": ("wire messages,<br/>shared-memory layout", GROUND),
    "formats": ("files of other programs:<br/>MCAP, CDR", GROUND),
    "base": ("text, files, threads", GROUND),
}


def drawn_arrows(arrows):
    """The arrows that no longer way along others implies, as a sorted list of (from, to)."""
    return sorted((folder, target) for folder, targets in arrows.items() for target in targets
                  if not any(target in arrows[between] for between in targets if between != target))


def reachable(drawn, folder):
    """The folders that lie along the drawn arrows from `folder` on."""
    found, waiting = set(), [folder]
    while waiting:
        here = waiting.pop()
        following = {target for source, target in drawn if source == here} - found
        found |= following
        waiting += following
    return found


def dot_text(arrows):
    """The picture in Graphviz's language. Raises ValueError where the table and its picture would say different things."""
    missing = sorted(set(arrows) - set(FOLDERS))
    if missing:
        raise ValueError(f"FOLDERS of {pathlib.Path(__file__).name} lacks a line for: {', '.join(missing)}")
    drawn = drawn_arrows(arrows)
    for folder, targets in arrows.items():
        if reachable(drawn, folder) != set(targets):
            raise ValueError(f"{folder} may include {sorted(targets)}, but along the arrows lie "
                             f"{sorted(reachable(drawn, folder))}: the picture would allow more than the table")
    lines = ["digraph architecture {",
             '  graph [rankdir=TB, nodesep=0.35, ranksep=0.35, bgcolor="white", fontname="Helvetica"]',
             '  node [shape=box, style="rounded,filled", color="#707070", fontname="Helvetica", fontsize=11, margin="0.16,0.08"]',
             '  edge [color="#505050", arrowsize=0.7]']
    for folder in [name for name in FOLDERS if name in arrows]:
        text, colour = FOLDERS[folder]
        lines.append(f'  {folder} [label=<<b>{folder}/</b><br/>{text}>, fillcolor="{colour}"]')
    ground = sorted(folder for folder, targets in arrows.items() if not targets)
    lines.append("  { rank=same; " + "; ".join(ground) + " }")
    lines += [f"  {source} -> {target}" for source, target in drawn]
    return "\n".join(lines + ["}"]) + "\n"


def svg_text(dot):
    """The picture as SVG, with the licence line that every file has. Raises FileNotFoundError without Graphviz."""
    made = subprocess.run(["dot", "-Tsvg"], input=dot, capture_output=True, text=True, check=True).stdout
    head, rest = made.split("\n", 1)
    return f"{head}\n<!-- SPDX-License-Identifier: Apache-2.0; made by tools/docs/architecture_diagram.py -->\n{rest}"


def main():
    dot = dot_text(check_house.ARROWS)
    if "--dot" in sys.argv[1:]:
        print(dot, end="")
        return
    PICTURE.write_text(svg_text(dot), encoding="utf-8")
    print(f"written: {PICTURE.relative_to(ROOT)}")


if __name__ == "__main__":
    main()

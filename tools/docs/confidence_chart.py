#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws docs/benchmarks/confidence-error.svg: for each confidence the error of the disparities that have it.

Usage: tools/docs/confidence_chart.py LABEL=FILE... FILE is what `disparity-eval --confidence --json` prints, without --halves; LABEL
names its line. Left: one sigma of the disparities that are off by less than 1 px. Right: how many are off by more than 1 px.
"""
import json
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
PICTURE = ROOT / "docs/benchmarks/confidence-error.svg"
COLOURS = ("#1f5fa8", "#c05a10", "#2c7d3c", "#7d3c98", "#555555")
BIN_SIZE = 16
LEAST_SHARE = 0.001  # bins with fewer pixels tell little
FIRST, LAST = 160, 256  # calibrated confidences begin at 161

PLOT_WIDTH, PLOT_HEIGHT = 300, 210
LEFT, TOP, GAP = 55, 60, 85


def points(result):
    """Returns (confidence, sigma in px, percent that are wrong) for each bin with pixels. result: an object of the JSON."""
    weight, right = result["weight"], result["right"]
    everything = sum(weight)
    found = []
    for index, sigma in enumerate(result["sigma_px_of_bins"]):
        values = range(index * BIN_SIZE, (index + 1) * BIN_SIZE)
        pixels = sum(weight[value] for value in values)
        if pixels > LEAST_SHARE * everything and sigma is not None:
            mean = sum(value * weight[value] for value in values) / pixels
            found.append((mean, sigma, 100 * (1 - sum(right[value] for value in values) / pixels)))
    return found


def text(x, y, words, anchor="middle", more=""):
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}"{more}>{words}</text>'


def axes(left, title, top_value, step, form):
    """Returns the frame, the grid and the numbers of a plot whose upper edge is top_value."""
    parts = [text(left + PLOT_WIDTH / 2, TOP - 12, title),
             text(left + PLOT_WIDTH / 2, TOP + PLOT_HEIGHT + 34, "confidence")]
    for i in range(round(top_value / step) + 1):
        y = TOP + PLOT_HEIGHT * (1 - i * step / top_value)
        parts.append(f'<line x1="{left}" y1="{y:.1f}" x2="{left + PLOT_WIDTH}" y2="{y:.1f}" stroke="#dddddd"/>')
        parts.append(text(left - 6, y + 4, form.format(i * step), "end"))
    for confidence in range(FIRST, LAST + 1, BIN_SIZE):
        parts.append(text(left + place(confidence), TOP + PLOT_HEIGHT + 16, min(confidence, 255)))
    parts.append(f'<rect x="{left}" y="{TOP}" width="{PLOT_WIDTH}" height="{PLOT_HEIGHT}" fill="none" stroke="#707070"/>')
    return parts


def place(confidence):
    """Returns how far from the left edge of a plot a confidence lies."""
    return PLOT_WIDTH * (confidence - FIRST) / (LAST - FIRST)


def line(left, values, top_value, colour):
    """Returns a line through (confidence, value) with a dot on each."""
    places = [(left + place(x), TOP + PLOT_HEIGHT * (1 - min(y, top_value) / top_value)) for x, y in values]
    joined = " ".join(f"{x:.1f},{y:.1f}" for x, y in places)
    return [f'<polyline points="{joined}" fill="none" stroke="{colour}" stroke-width="2"/>',
            *(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{colour}"/>' for x, y in places)]


def svg_text(lines):
    """Returns the picture. lines: (label, points) of each."""
    second = LEFT + PLOT_WIDTH + GAP
    width, height = second + PLOT_WIDTH + 20, TOP + PLOT_HEIGHT + 48
    parts = ['<?xml version="1.0" encoding="UTF-8"?>',
             "<!-- SPDX-License-Identifier: Apache-2.0; made by tools/docs/confidence_chart.py -->",
             f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="0 0 {width} {height}" '
             'font-family="Helvetica, Arial, sans-serif" font-size="12">',
             f'<rect width="{width}" height="{height}" fill="white"/>',
             *axes(LEFT, "one sigma of the right disparities, px", 0.6, 0.1, "{:.1f}"),
             *axes(second, "off by more than 1 px, %", 50, 10, "{:.0f}")]
    for index, (label, found) in enumerate(lines):
        colour = COLOURS[index % len(COLOURS)]
        x = LEFT + index * (second + PLOT_WIDTH - LEFT) / len(lines)
        parts.append(f'<line x1="{x:.1f}" y1="20" x2="{x + 22:.1f}" y2="20" stroke="{colour}" stroke-width="2"/>')
        parts.append(text(x + 28, 24, label, "start"))
        parts += line(LEFT, [(at, sigma) for at, sigma, _ in found], 0.6, colour)
        parts += line(second, [(at, wrong) for at, _, wrong in found], 50, colour)
    return "\n".join(parts + ["</svg>"]) + "\n"


def main():
    given = [argument.partition("=") for argument in sys.argv[1:]]
    if not given or not all(label and path for label, _, path in given):
        sys.exit(__doc__)
    lines = []
    for label, _, path in given:
        results = json.loads(pathlib.Path(path).read_text(encoding="utf-8"))
        if len(results) != 1:
            sys.exit(f"{path}: found {len(results)} results, allowed: one; leave --halves out and give one method")
        lines.append((label, points(results[0])))
    PICTURE.write_text(svg_text(lines), encoding="utf-8")
    print(f"written: {PICTURE.relative_to(ROOT)}")


if __name__ == "__main__":
    main()

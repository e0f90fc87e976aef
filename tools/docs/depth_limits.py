# SPDX-License-Identifier: Apache-2.0
"""The table of docs/distances.md: near limits and resolution of each ZED model and mode, by nominal numbers.

Usage: depth_limits.py. Prints the table as Markdown. It computes as calibration/depth_range.cpp does.
"""
import math

# Focal lengths in px at HD2K and baselines in mm. Of ZED and ZED Mini as the vendor's support page states them ("What is
# the camera focal length and field of view?": 1400 px, 120 and 63 mm); of ZED 2 and 2i the lens of the data sheet by
# a pixel of 2 um.
MODELS = [("ZED", 1400, 120), ("ZED Mini", 1400, 63), ("ZED 2, ZED 2i (2.1 mm)", 1050, 120),
          ("ZED 2i (4 mm)", 2000, 120)]
# Focal length against that of HD2K: calibration/zed_modes.h. HD1080 is cut out of HD2K.
MODES = [("VGA", 0.25), ("HD720", 0.5), ("HD1080, HD2K", 1)]
COUNTS = [64, 128, 256]
WANTED_M = [1, 0.5]
TOLD_AT_M = [5, 10]


def nearest(fb, count):
    """Metres, rounded up to a centimetre: never told as nearer than it is. `fb` in px m."""
    return math.ceil(fb / (count - 1) * 100 - 1e-6) / 100


def disparities_for(fb, wanted):
    """The least multiple of 16 that reaches `wanted` metres; None above 256."""
    count = math.ceil((fb / wanted + 1) / 16 - 1e-9) * 16
    return None if count > 256 else max(16, count)


def error(fb, distance, px):
    """How much farther a point reads whose disparity is `px` too small; None: infinitely far."""
    disparity = fb / distance - px
    return fb / disparity - distance if disparity > 0 else None


def metres(value):
    return "-" if value is None else f"{value:.2g}" if value < 0.1 else f"{value:.2f}" if value < 10 else f"{value:.1f}"


def table():
    head = (["model", "mode", "f, px"] + [f"nearest, {count}" for count in COUNTS] + [f"for {m:g} m" for m in WANTED_M]
            + [f"{step} at {m} m" for m in TOLD_AT_M for step in ("1/16 px", "1 px")])
    rows = [head, ["---", "---"] + ["---:"] * (len(head) - 2)]
    for model, f, baseline in MODELS:
        for mode, scale in MODES:
            fb = f * scale * baseline / 1000
            rows.append([model, mode, f"{f * scale:g}"] + [f"{nearest(fb, count):.2f}" for count in COUNTS]
                        + [str(disparities_for(fb, m) or "more than 256") for m in WANTED_M]
                        + [metres(error(fb, m, px)) for m in TOLD_AT_M for px in (1 / 16, 1)])
    return "\n".join("| " + " | ".join(row) + " |" for row in rows)


if __name__ == "__main__":
    print(table())

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws docs/pictures/worst-scenes.png: of eighteen made-up scenes the six on which `dense` is worst, beside `paper`.

Usage: tools/docs/worst_scenes.py [FILE]. Needs ImageMagick. The pictures of evaluation data are not ours to show: `disparity-eval -o DIR DATA`
writes the same for them.
"""
import json
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
PICTURE = ROOT / "docs/pictures/worst-scenes.png"
EVAL = ROOT / "build/release/bin/disparity-eval"
SCENES = [f"scene:vga?seed={seed}&frames=1" for seed in range(1, 19)]
WIDTH, HEIGHT = 672, 376
SHOWN = "280x157"
# As the presets are compared in docs/benchmarks/accuracy.md: every pixel is judged.
WAYS = {"paper": ["--preset", "paper", "--interpolate"], "dense": ["--preset", "dense"]}
WORST = 6
# Columns of an error picture.
LEFT, ERRORS = 0, 2


def run(*command):
    try:
        done = subprocess.run(list(map(str, command)), capture_output=True, text=True, errors="replace", check=False)
    except OSError as error:
        sys.exit(f"tools/docs/worst_scenes.py: error: {command[0]}: {error.strerror}; disparity-eval is built with "
                 "`ninja -C build/release disparity-eval`, the others are ImageMagick's")
    if done.returncode != 0:
        sys.exit(f"tools/docs/worst_scenes.py: error: {command[0]}: {done.stderr.strip()}")
    return done.stdout


def evaluate(folder):
    """{way: {scene: percent of bad pixels}}; the error pictures of a way are in the folder of its name."""
    results = {}
    for way, options in WAYS.items():
        rows = json.loads(run(EVAL, *options, "--json", "-o", folder / way, *SCENES))
        results[way] = {row["scene"]: row["bad1_nonocc"] for row in rows}
    return results


def tile(folder, way, scene, column, label):
    """Arguments for montage: one part of an error picture, and what stands below it."""
    # ImageMagick reads more into the names of scenes.
    picture = (folder / way / f"{scene}_sgm_cpu.png").read_bytes()
    (folder / "whole.png").write_bytes(picture)
    part = folder / f"{way}-{column}-{scene.partition('seed=')[2].partition('&')[0]}.png"
    run("convert", folder / "whole.png", "-crop", f"{WIDTH}x{HEIGHT}+{column * WIDTH}+0", "+repage", "-resize", SHOWN, part)
    return ["-label", label, part]


def main():
    target = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else PICTURE
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        results = evaluate(folder)
        worst = sorted(results["dense"], key=results["dense"].get, reverse=True)[:WORST]
        tiles = []
        for scene in worst:
            tiles += tile(folder, "dense", scene, LEFT, scene.partition("&")[0])
            for way in WAYS:
                tiles += tile(folder, way, scene, ERRORS, f"{way}: {results[way][scene]:.2f} %")
        run("montage", *tiles, "-tile", f"3x{WORST}", "-geometry", "+3+3", "-colors", "64", "+dither", f"png8:{target}")
    for scene in worst:
        print(scene, *(f"{way} {results[way][scene]:.2f} %" for way in WAYS))


main()

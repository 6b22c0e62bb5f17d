#!/usr/bin/env python3
"""Measures how much corrections help, on all drawings at once.

    python3 tests/pin_rounds.py target/x86_64-unknown-linux-gnu/release/rototoon SET... [--rounds N]

A set is a folder with project.json (key frames only) and truth.json. The scene is tracked. Then each drawing (a part on a
frame) that has bad points gets one correction: the part's centre if it is off by more than 8 px and by more than a quarter of
the part's size, else a pin of its worst point. The scene is tracked again, and so on. For each round it prints the number of
pins and centres so far, and of bad points.

`cargo xtask bench-tracking` corrects one drawing after the other until enough points are good. What it counts depends on chance:
on one film it takes 23 corrections, and 25 to 28 if the pins are moved by 0.7 px. Here a hundred corrections are made at once, and
their effect is a mean.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import tempfile
from pathlib import Path

from new_key import distance, track

Bad = dict[tuple[int, int], list[tuple[float, int]]]
"""By part and frame: how far each bad point is from its true place, and its index. The farthest one comes first."""


def bad_points(project: dict, tracked: dict, truth: dict) -> Bad:
    """The scored points of the frames between keys that are off their contour or far from their own place."""
    tolerance, found = project["footage"]["height"] / 270, {}
    for k, (part, true) in enumerate(zip(tracked["parts"], truth["parts"], strict=True)):
        keys = sorted(int(frame) for frame in project["parts"][k]["keys"])
        for frame in range(keys[0] + 1, keys[-1]):
            marks = true["scored"].get(str(frame), "") if frame not in keys else ""
            bad = []
            for j, mark in enumerate(marks):
                if mark != "1":
                    continue
                place = part["tracks"][str(frame)][j]
                off = math.dist(place, true["points"][str(frame)][j])
                if off > 5 * tolerance or distance(place, true["contour"][str(frame)], part["closed"]) > tolerance:
                    bad.append((off, j))
            if bad:
                found[k, frame] = sorted(bad, key=lambda point: (-point[0], point[1]))
    return found


def center(points: list[list[float]]) -> list[float]:
    """The mean of some points."""
    return [sum(point[axis] for point in points) / len(points) for axis in range(2)]


def correct(project: dict, tracked: dict, truth: dict, bad: Bad) -> tuple[int, int]:
    """Corrects each drawing once, in the project. Returns the numbers of new pins and centres."""
    pins = centers = 0
    for (k, frame), points in bad.items():
        name, part = str(frame), project["parts"][k]
        found, true = tracked["parts"][k]["tracks"][name], truth["parts"][k]["points"][name]
        size = max(max(p[axis] for p in true) - min(p[axis] for p in true) for axis in range(2))
        known = part.setdefault("centers", {})
        if name not in known and math.dist(center(found), center(true)) > max(8, size / 4):
            known[name] = center(true)
            centers += 1
            continue
        here = part.setdefault("pins", {}).setdefault(name, {})
        free = [j for _, j in points if str(j) not in here]
        if free:
            here[str(free[0])] = true[free[0]]
            pins += 1
    return pins, centers


def measure(program: str, folder: Path, rounds: int) -> list[tuple[int, int, int]]:
    """For each round, beginning without corrections: pins, centres, bad points."""
    project = json.loads((folder / "project.json").read_text())
    truth = json.loads((folder / "truth.json").read_text())
    project["footage"]["pattern"] = str((folder / project["footage"]["pattern"]).resolve())
    lines, pins, centers = [], 0, 0
    with tempfile.TemporaryDirectory() as temporary:
        for number in range(rounds + 1):
            tracked = track(program, project, Path(temporary))
            bad = bad_points(project, tracked, truth)
            lines.append((pins, centers, sum(len(points) for points in bad.values())))
            if number < rounds:
                more = correct(project, tracked, truth, bad)
                pins, centers = pins + more[0], centers + more[1]
    return lines


def main() -> int:
    """Measures all sets."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("sets", nargs="+", type=Path)
    parser.add_argument("--rounds", type=int, default=3, metavar="N")
    options = parser.parse_args()
    for folder in options.sets:
        for number, (pins, centers, bad) in enumerate(measure(options.program, folder, options.rounds)):
            print(f"{folder.name}: round {number}: {pins} pins, {centers} centres, {bad} bad points", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Checks that a correct new key never harms drawings that were right before.

    python3 tests/new_key.py target/x86_64-unknown-linux-gnu/release/rototoon SET... [--some N]

A set is a folder with project.json (key frames only) and truth.json. The scene is tracked once as it is. Then each part
gets one more key, the truth, on each frame between its keys, one at a time, and the scene is tracked again. What counts are
the drawings (a part on a frame) of which at least 95 % of the scored points were good at first, but for the one with the new
key: the mean share of their points that are good. It may fall by at most 0.5 of 100. `--some` takes N of the new keys by
chance, always the same ones, because all of them take an hour on a long film.

It prints the worst new keys of each set, with the share of the fall on drawings of the part itself and of other parts, and fails
where one does harm.
"""

from __future__ import annotations

import argparse
import copy
import json
import math
import random
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

RIGHT = 0.95
"""Share of good points from which on a drawing is right."""
ALLOWED = 0.5
"""Points of a hundred by which the mean may fall."""

Drawing = tuple[int, int]


def distance(p: list[float], line: list[list[float]], closed: bool) -> float:
    """Distance from a point to a polyline."""
    best = math.inf
    for k in range(len(line) if closed else len(line) - 1):
        (ax, ay), (bx, by) = line[k], line[(k + 1) % len(line)]
        dx, dy = bx - ax, by - ay
        t = ((p[0] - ax) * dx + (p[1] - ay) * dy) / max(dx * dx + dy * dy, 1e-12)
        t = min(max(t, 0.0), 1.0)
        best = min(best, math.hypot(ax + t * dx - p[0], ay + t * dy - p[1]))
    return best


def good(project: dict, tracked: dict, truth: dict) -> dict[Drawing, float]:
    """The share of good points of each drawing between the keys of `project` that has scored points."""
    tolerance, shares = project["footage"]["height"] / 270, {}
    for k, (keyed, part, true) in enumerate(zip(project["parts"], tracked["parts"], truth["parts"], strict=True)):
        keys = sorted(int(frame) for frame in keyed["keys"])
        for frame in range(keys[0] + 1, keys[-1]):
            name = str(frame)
            scored = [j for j, mark in enumerate(true["scored"].get(name, "")) if mark == "1"]
            if frame in keys or not scored:
                continue
            found, expected, contour = part["tracks"][name], true["points"][name], true["contour"][name]
            right = sum(
                math.dist(found[j], expected[j]) <= 5 * tolerance
                and distance(found[j], contour, part["closed"]) <= tolerance
                for j in scored
            )
            shares[k, frame] = right / len(scored)
    return shares


def track(program: str, project: dict, folder: Path) -> dict:
    """The project with its tracks."""
    source, target = folder / "project.json", folder / "tracked.json"
    source.write_text(json.dumps(project))
    subprocess.run([program, "track", source, "-o", target], check=True, stdout=subprocess.DEVNULL)
    return json.loads(target.read_text())


class Fall(NamedTuple):
    """By how many points of a hundred a new key lowers the mean of what was right: in all, on its own part, on other parts."""

    points: float
    own: float
    others: float
    part: str
    frame: int


def harm(program: str, folder: Path, some: int | None) -> list[Fall]:
    """What each new key does, the worst first."""
    project = json.loads((folder / "project.json").read_text())
    truth = json.loads((folder / "truth.json").read_text())
    project["footage"]["pattern"] = str((folder / project["footage"]["pattern"]).resolve())
    falls: list[Fall] = []
    with tempfile.TemporaryDirectory() as temporary:
        before = good(project, track(program, project, Path(temporary)), truth)
        right = {drawing: share for drawing, share in before.items() if share >= RIGHT}
        keys = sorted(before)
        if some is not None and some < len(keys):
            keys = random.Random(7).sample(keys, some)
        for k, frame in keys:
            changed = copy.deepcopy(project)
            part = changed["parts"][k]
            part["keys"][str(frame)] = truth["parts"][k]["points"][str(frame)]
            after = good(project, track(program, changed, Path(temporary)), truth)
            lost = {drawing: right[drawing] - after[drawing] for drawing in right if drawing != (k, frame)}
            scale = 100 / max(len(lost), 1)
            own = scale * sum(fall for drawing, fall in lost.items() if drawing[0] == k)
            others = scale * sum(fall for drawing, fall in lost.items() if drawing[0] != k)
            falls.append(Fall(own + others, own, others, part["name"], frame))
    return sorted(falls, reverse=True)


def main() -> None:
    """Checks all sets."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("sets", nargs="+", type=Path)
    parser.add_argument("--some", type=int, metavar="N")
    options = parser.parse_args()
    harmful = 0
    for folder in options.sets:
        falls = harm(options.program, folder, options.some)
        bad = [fall for fall in falls if fall.points > ALLOWED]
        harmful += len(bad)
        mean = sum(fall.points for fall in falls) / max(len(falls), 1)
        print(f"{folder.name}: {len(falls)} new keys, {len(bad)} do harm, mean fall {mean:.2f}", flush=True)
        for fall in falls[:3]:
            shares = f"own {fall.own:.2f}, others {fall.others:.2f}"
            print(f"    {fall.points:6.2f}  {fall.part}, frame {fall.frame} ({shares})", flush=True)
    sys.exit(1 if harmful else 0)


if __name__ == "__main__":
    main()

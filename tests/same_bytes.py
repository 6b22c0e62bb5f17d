#!/usr/bin/env python3
"""Holds the outputs of two builds of the command line against each other, byte by byte.

Use it before and after a change that must not alter any result, such as a move of code:

    python3 tests/same_bytes.py OLD/rototoon NEW/rototoon SET... [--clips CLIPS]

A SET is a folder with a `project.json` and its footage. Each build tracks it with every preset, snaps, renders, exports,
fits the keyed contours, and makes in-betweens of the first two keys. CLIPS is a file of skeleton clips; each build
translates some of them with every preset. Every output file is compared. The exit status is 1 where one differs or only
one build succeeds, and 0 otherwise. Pictures are written as PNG; files of ids are OpenEXR.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

PRESETS = ["rototoon", "zhou2011", "agarwala2004", "liang2012"]
STYLE_PRESETS = ["rototoon", "bilinear", "bilinear-symmetric", "liang2012"]


def keyed_curves(project: dict) -> dict:
    """The keyed contours of a project as curves to fit."""
    curves = []
    for part in project["parts"]:
        for points in part["keys"].values():
            curves.append({"closed": part.get("closed", True), "points": points})
    return {"curves": curves}


def key_drawings(project: dict) -> dict:
    """A project whose drawings are the keyed contours of the first two keys that most parts share."""
    frames = sorted({int(frame) for part in project["parts"] for frame in part["keys"]})
    counts = {f: sum(str(f) in part["keys"] for part in project["parts"]) for f in frames}
    first, last = sorted(sorted(frames, key=lambda f: (-counts[f], f))[:2])
    drawings = []
    for frame in (first, last):
        parts = [part for part in project["parts"] if str(frame) in part["keys"]]
        strokes = [{"closed": p.get("closed", True), "points": p["keys"][str(frame)]} for p in parts]
        drawings.append({"frame": frame, "strokes": strokes})
    # The second drawing lists its strokes the other way round: matching must not depend on the order.
    drawings[1]["strokes"].reverse()
    return {"rototoon": 1, "footage": project["footage"], "parts": [], "drawings": drawings}


def commands_of_set(folder: Path, out: Path) -> Iterator[list[str]]:
    """The commands for one set, those first whose outputs later ones read."""
    source = str(folder / "project.json")
    project = json.loads(Path(source).read_text())
    for preset in PRESETS:
        yield ["track", source, "-o", str(out / f"{preset}.json"), "--preset", preset]
    tracked, snapped = str(out / "rototoon.json"), str(out / "snapped.json")
    yield ["snap", tracked, "-o", snapped]
    for follow in ("line", "edge"):
        yield ["snap", tracked, "-o", str(out / f"snapped_{follow}.json"), "--follow", follow]
    for what in ("overlay", "matte", "cutout"):
        yield ["render", snapped, "-o", str(out / f"{what}_%03d.png"), "--what", what]
    yield ["render", snapped, "-o", str(out / "ids_%03d.exr"), "--what", "ids"]
    for ending in ("svg", "nk", "py", "jsx", "fxs", "setting", "json"):
        yield ["export", snapped, "-o", str(out / f"export.{ending}")]
    curves, drawings = out / "curves.json", out / "drawings.json"
    curves.write_text(json.dumps(keyed_curves(project)))
    drawings.write_text(json.dumps(key_drawings(project)))
    for preset in ("rototoon", "yang1986"):
        for tolerance in ("0.3", "2"):
            to = str(out / f"fit_{preset}_{tolerance}.json")
            yield ["fit", str(curves), "-o", to, "--tolerance", tolerance, "--preset", preset]
    for leaving in ("grow", "fade"):
        yield ["tween", str(drawings), "-o", str(out / f"tween_{leaving}.json"), "--leaving", leaving]


def commands_of_clips(clips: Path, out: Path) -> Iterator[list[str]]:
    """Translations between a few characters and motions."""
    held = json.loads(clips.read_text())["clips"]
    styles = sorted({clip["character"] for clip in held})
    motions = sorted({clip["motion"] for clip in held})
    for preset in STYLE_PRESETS:
        for style, motion, content in zip(styles[1:4], motions[:3], [styles[0]] * 3):
            to = str(out / f"{preset}_{style}_{motion}.json".replace("/", "_"))
            yield ["style", "translate", str(clips), "--style", style, "--motion", motion, "--content", content,
                   "--preset", preset, "-o", to]  # fmt: skip


def run(program: str, commands: Iterator[list[str]], out: Path) -> dict[str, str]:
    """What each command and each file came to: a hash, or a command's exit status and message."""
    outcomes = {}
    for command in commands:
        done = subprocess.run([program, *command], capture_output=True, text=True)
        name = " ".join(Path(word).name for word in command)
        # A message may name the folder it works in.
        outcomes[name] = "done" if done.returncode == 0 else f"exit {done.returncode}"
    for path in sorted(out.iterdir()):
        outcomes[path.name] = hashlib.sha256(path.read_bytes()).hexdigest()
    return outcomes


def compare(title: str, make, programs: list[str], folder: Path) -> bool:
    """Runs both programs beside each other and prints what differs; whether all is the same."""
    places = []
    for name in ("a", "b"):
        place = folder / name / title
        place.mkdir(parents=True)
        places.append(place)
    with ThreadPoolExecutor(2) as pool:
        old, new = pool.map(lambda pair: run(pair[0], make(pair[1]), pair[1]), zip(programs, places))
    differing = sorted(name for name in old.keys() | new.keys() if old.get(name) != new.get(name))
    failed = sorted(name for name in old if old[name].startswith("exit"))
    print(f"{title}: {len(old)} commands and files, {len(differing)} differ, {len(failed)} commands fail in the old build")
    for name in differing:
        print(f"  differs: {name}: {old.get(name)} and {new.get(name)}")
    for name in failed:
        print(f"  fails: {name}: {old[name]}")
    sys.stdout.flush()
    return not differing


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("old")
    parser.add_argument("new")
    parser.add_argument("sets", nargs="*", type=Path)
    parser.add_argument("--clips", type=Path)
    given = parser.parse_args()
    if not given.sets and not given.clips:
        parser.error("expected at least one SET or --clips")
    programs = [str(Path(p).resolve()) for p in (given.old, given.new)]
    same = True
    with tempfile.TemporaryDirectory() as folder:
        for path in given.sets:
            source = path.resolve()
            same &= compare(path.name, lambda out, s=source: commands_of_set(s, out), programs, Path(folder))
        if given.clips:
            clips = given.clips.resolve()
            same &= compare("clips", lambda out: commands_of_clips(clips, out), programs, Path(folder))
    return 0 if same else 1


if __name__ == "__main__":
    sys.exit(main())

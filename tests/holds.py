#!/usr/bin/env python3
"""Measures whether held drawings are found under noise, and whether slow movement is told apart from noise.

    python3 tests/holds.py PROGRAM FRAMES_FOLDER... [--most N] [--kinds none,gif,...]

PROGRAM is the command line program. Each FRAMES_FOLDER holds the numbered pictures of one sequence. For each sequence and each
kind of noise three films are made from its drawings:

- every drawing held for two frames
- every drawing held for three frames
- every drawing, and the same moved by half a pixel of 540 lines, in a direction that changes from drawing to drawing

`check --drawings` must find the first two's holds, and none between a drawing and its moved copy. Drawings that are equal to the
one before, pixel by pixel, are left out.

Kinds of noise: none; gif (a palette of 256 colours for each frame, with dither, after noise of one grey level); crf28 and crf35
(H.264 by ffmpeg); grain (a standard deviation of 4 grey levels); stray (20 single pixels in black or white).

Needs NumPy, SciPy and Pillow, and ffmpeg for H.264. What cannot be made is named and left out. The exit status is 1 if fewer than
99.5 % of the holds are found, or more than 1 % of the slow movements count as holds.
"""

from __future__ import annotations

import argparse
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import numpy as np
from PIL import Image
from scipy import ndimage

KINDS = ("none", "gif", "crf28", "crf35", "grain", "stray")


def read(folder: pathlib.Path, most: int) -> list[np.ndarray]:
    drawings: list[np.ndarray] = []
    for path in sorted(folder.iterdir()):
        picture = np.asarray(Image.open(path).convert("RGB"))
        if not drawings or not np.array_equal(drawings[-1], picture):
            drawings.append(picture)
    return drawings[:most]


def moved(picture: np.ndarray, index: int) -> np.ndarray:
    angle, length = 2.399963 * index, 0.5 * picture.shape[0] / 540
    shift = (length * np.sin(angle), length * np.cos(angle), 0)
    found = ndimage.shift(picture.astype(np.float32), shift, order=3, mode="nearest")
    return np.clip(np.round(found), 0, 255).astype(np.uint8)


def h264(frames: list[np.ndarray], crf: int) -> list[np.ndarray]:
    height, width = frames[0].shape[:2]
    even = [np.pad(frame, ((0, height % 2), (0, width % 2), (0, 0)), mode="edge") for frame in frames]
    size = f"{even[0].shape[1]}x{even[0].shape[0]}"
    raw = ["-f", "rawvideo", "-pix_fmt", "rgb24"]
    quiet = ["ffmpeg", "-v", "error"]
    coder = ["-c:v", "libx264", "-threads", "1", "-pix_fmt", "yuv420p", "-crf", str(crf), "-f", "matroska", "-"]
    coded = subprocess.run(
        [*quiet, *raw, "-s", size, "-r", "24", "-i", "-", *coder],
        input=b"".join(frame.tobytes() for frame in even),
        stdout=subprocess.PIPE,
        check=True,
    ).stdout
    back = subprocess.run([*quiet, "-i", "-", *raw, "-"], input=coded, stdout=subprocess.PIPE, check=True).stdout
    return list(np.frombuffer(back, np.uint8).reshape(-1, *even[0].shape)[:, :height, :width])


def noisy(frames: list[np.ndarray], kind: str) -> list[np.ndarray]:
    random = np.random.default_rng(7)

    def grain(frame: np.ndarray, sigma: float) -> np.ndarray:
        return np.clip(np.round(frame + random.normal(0, sigma, frame.shape)), 0, 255).astype(np.uint8)

    def gif(frame: np.ndarray) -> np.ndarray:
        picture = Image.fromarray(grain(frame, 1))
        palette = picture.quantize(256, dither=Image.Dither.NONE)
        return np.asarray(picture.quantize(palette=palette, dither=Image.Dither.FLOYDSTEINBERG).convert("RGB"))

    def stray(frame: np.ndarray) -> np.ndarray:
        frame = frame.copy()
        rows, columns = (random.integers(0, size, 20) for size in frame.shape[:2])
        frame[rows, columns] = random.choice([0, 255], size=(20, 1))
        return frame

    if kind.startswith("crf"):
        return h264(frames, int(kind[3:]))
    make = {"none": lambda f: f, "gif": gif, "grain": lambda f: grain(f, 4), "stray": stray}[kind]
    return [make(frame) for frame in frames]


def groups(program: str, frames: list[np.ndarray]) -> list[tuple[int, int]]:
    """First and last frame of each drawing that the program finds."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for number, frame in enumerate(frames):
            Image.fromarray(frame).save(folder / f"{number:04d}.png", compress_level=1)
        height, width = frames[0].shape[:2]
        footage = {"pattern": "%04d.png", "first": 0, "last": len(frames) - 1, "fps": 24, "width": width, "height": height}
        project = folder / "project.json"
        project.write_text(json.dumps({"rototoon": 1, "footage": footage, "parts": []}))
        said = subprocess.run([program, "check", str(project), "--drawings"], capture_output=True, text=True, check=True)
    listed = re.search(r"drawings: ([0-9, -]+)$", said.stderr, re.MULTILINE)
    if listed is None:
        raise SystemExit(f"the program did not list the drawings: {said.stderr}")
    pairs = [entry.split("-") for entry in listed.group(1).split(", ")]
    return [(int(pair[0]), int(pair[-1])) for pair in pairs]


def held(found: list[tuple[int, int]], pairs: list[int]) -> int:
    """How many of the frames `pairs` show the same drawing as the frame after them."""
    return sum(any(first <= i and i + 1 <= last for first, last in found) for i in pairs)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("folders", nargs="+", type=pathlib.Path)
    parser.add_argument("--most", type=int, default=12, help="drawings of each sequence (default 12)")
    parser.add_argument("--kinds", default=",".join(KINDS))
    given = parser.parse_args()
    kinds = given.kinds.split(",")
    if shutil.which("ffmpeg") is None and any(kind.startswith("crf") for kind in kinds):
        print("not measured: H.264, because there is no ffmpeg")
        kinds = [kind for kind in kinds if not kind.startswith("crf")]
    totals = {kind: [0, 0, 0, 0] for kind in kinds}
    for folder in given.folders:
        drawings = read(folder, given.most)
        for kind in kinds:
            counts = [0, 0, 0, 0]
            for times in (2, 3):
                film = [drawing for drawing in drawings for _ in range(times)]
                pairs = [i for i in range(len(film) - 1) if i // times == (i + 1) // times]
                counts[0] += held(groups(given.program, noisy(film, kind)), pairs)
                counts[1] += len(pairs)
            film = [frame for i, drawing in enumerate(drawings) for frame in (drawing, moved(drawing, i))]
            pairs = list(range(0, len(film), 2))
            counts[2] += held(groups(given.program, noisy(film, kind)), pairs)
            counts[3] += len(pairs)
            totals[kind] = [a + b for a, b in zip(totals[kind], counts, strict=True)]
            print(f"{folder.parent.name:30s} {kind:6s} holds {counts[0]}/{counts[1]}   false {counts[2]}/{counts[3]}", flush=True)
    good = True
    for kind, (found, holds, false, slow) in totals.items():
        print(f"{kind:6s} holds found {100 * found / holds:6.2f} % of {holds}   false holds {100 * false / slow:5.2f} % of {slow}")
        good &= found >= 0.995 * holds and false <= 0.01 * slow
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())

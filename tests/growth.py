#!/usr/bin/env python3
"""Measures how the time and memory of every command grow with the size of its input.

    python3 tests/growth.py target/x86_64-unknown-linux-gnu/release/rototoon

Each input has four sizes, each twice the one before. The processor time is the least of three runs, without the time that
the command takes for the smallest possible input. The exponent is the slope between the first and the last size on
logarithmic scales: 1 is linear, 2 quadratic. It prints a table, and fails where an exponent is above 1.3 for work that
should be linear.
"""

from __future__ import annotations

import json
import math
import os
import struct
import subprocess
import sys
import tempfile
import zlib
from collections.abc import Callable
from pathlib import Path

LINEAR = 1.3
SHORT = 0.02
"""A time below this, in seconds, is not measured well enough for an exponent."""

HEIGHTS = [0.0, -0.6, -1.0, -1.2, -1.5, -0.9, -0.4, 0.1, -0.9, -0.4, 0.1, 0.05, 1.0, 1.9, 0.05, 1.0, 1.9]


def png(path: Path, width: int, height: int) -> None:
    """A picture with a dark disc on a light ground."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows, radius = [], 0.35 * min(width, height)
    for y in range(height):
        inside = radius**2 - (y + 0.5 - height / 2) ** 2
        half = int(math.sqrt(inside)) if inside > 0 else 0
        side = width // 2 - half
        rows.append(b"\0" + b"\xe6" * side + b"\x50" * (width - 2 * side) + b"\xe6" * side)
    head = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    body = chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(b"".join(rows), 1)) + chunk(b"IEND", b"")
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + body)


def disc(x: float, y: float, radius: float, count: int = 12) -> list[list[float]]:
    """Points of a circle."""
    turns = [2 * math.pi * k / count for k in range(count)]
    return [[x + radius * math.cos(t), y + radius * math.sin(t)] for t in turns]


def document(parts: list[dict], last: int = 0, width: int = 960, height: int = 540) -> dict:
    """A project document. Its frames are `f_000.png` and so on."""
    footage = {"pattern": "f_%03d.png", "first": 0, "last": last, "fps": 25, "width": width, "height": height}
    return {"rototoon": 1, "footage": footage, "parts": parts}


def parts(count: int, heap: bool) -> dict:
    """Discs over the picture, or all of them in one place."""
    place = [((k * 0.618034) % 1, (k * 0.754878) % 1) for k in range(count)]
    spots = [(400 + 100 * x, 200 + 100 * y, 100.0) if heap else (960 * x, 540 * y, 12.0) for x, y in place]
    named = [{"name": f"part {k}", "closed": True, "depth": k, "keys": {"0": disc(*s)}} for k, s in enumerate(spots)]
    return document(named)


def tracked(frames: int) -> dict:
    """Four parts with a contour on every frame."""
    named = []
    for k in range(4):
        contours = {str(f): disc(200 + 100 * k + 0.1 * f, 200, 40, 40) for f in range(frames)}
        named.append({"name": f"part {k}", "closed": True, "keys": {"0": contours["0"]}, "tracks": contours})
    return document(named, frames - 1)


def drawings(count: int) -> dict:
    """Two drawings of strokes in a grid; the second one is moved and in another order."""
    side = math.ceil(math.sqrt(count))
    strokes = [
        [[30 * (k % side) + 3 * i, 30 * (k // side) + (k * 7 % 11) * math.sin(i)] for i in range(8)]
        for k in range(count)
    ]
    moved = [[[x + 6, y + 4] for x, y in stroke] for stroke in reversed(strokes)]
    made = [
        {"frame": frame, "strokes": [{"closed": False, "points": points} for points in each]}
        for frame, each in ((0, strokes), (4, moved))
    ]
    return {**document([], 4), "drawings": made}


def curve(count: int) -> dict:
    """One long wavy line."""
    points = [[0.8 * k, 40 * math.sin(0.2 * k) + 3 * math.sin(0.7 * k * k)] for k in range(count)]
    return {"curves": [{"closed": False, "points": points}]}


def clips(frames: int, count: int = 2) -> dict:
    """Clips of `count` characters and `count` motions."""

    def posture(c: int, m: int, f: int) -> list[list[float]]:
        sway = 0.1 * (1 + m) * math.sin(0.4 * f + m)
        return [[round((sway - 0.1 * c) * h, 4), round(h + 0.02 * math.sin(0.1 * f), 4)] for h in HEIGHTS]

    made = [
        {"character": f"c{c}", "motion": f"m{m}", "points": [posture(c, m, f) for f in range(frames)]}
        for c in range(count)
        for m in range(count)
    ]
    return {"rototoon_clips": 1, "fps": 24, "clips": made}


def shapes(count: int) -> str:
    """An SVG document with shapes that have no names."""
    paths = "".join(f'<path d="M{k % 900} {k % 500}h9v9z"/>' for k in range(count))
    return f'<svg viewBox="0 0 960 540">{paths}</svg>'


LAUNCHER = """
import os, subprocess, sys
child = subprocess.Popen(sys.argv[1:], stdout=subprocess.DEVNULL)
_, status, used = os.wait4(child.pid, 0)
print(os.waitstatus_to_exitcode(status), used.ru_utime + used.ru_stime, used.ru_maxrss / 1024)
"""
"""A child begins with the peak memory of the process that started it. So a small process starts the program."""


class Bench:
    """Runs a program on files in a folder."""

    def __init__(self, program: str, folder: Path) -> None:
        self.program, self.folder = os.path.abspath(program), folder

    def put(self, name: str, content: object) -> None:
        text = content if isinstance(content, str) else json.dumps(content)
        (self.folder / name).write_text(text)

    def measure(self, words: list[str]) -> tuple[float, float]:
        """The least processor time in seconds, and the peak memory in MB."""
        times, peak = [], 0.0
        launch = [sys.executable, "-I", "-S", "-c", LAUNCHER, self.program, *words]
        for _ in range(3):
            run = subprocess.run(launch, cwd=self.folder, capture_output=True, text=True, check=False)
            if run.returncode != 0:
                raise SystemExit(f"cannot start {self.program}: {run.stderr}")
            status, seconds, memory = run.stdout.split()
            if status != "0":
                raise SystemExit(f"{' '.join(words)}: exit status {status}: {run.stderr}")
            times.append(float(seconds))
            peak = max(peak, float(memory))
        return min(times), peak


def cases(bench: Bench) -> list[tuple[str, list[int], Callable[[int], None], list[str], bool]]:
    """Name, sizes, what writes the input of a size, command, and whether the time should be linear."""

    def pixels(side: int) -> None:
        height = round(math.sqrt(side))
        png(bench.folder / "f_000.png", height, height)
        part = {"name": "disc", "closed": True, "keys": {"0": disc(height / 2, height / 2, 0.35 * height, 16)}}
        bench.put("in.json", document([part], 0, height, height))

    def put(make: Callable[[int], object], name: str = "in.json") -> Callable[[int], None]:
        return lambda size: bench.put(name, make(size))

    def svg(size: int) -> None:
        bench.put("in.json", document([]))
        bench.put("in.svg", shapes(size))

    doubled = lambda first: [first, 2 * first, 4 * first, 8 * first]  # noqa: E731
    out = ["-o", "out.json"]
    render = ["render", "in.json", "-o", "r_%d.exr", "--what"]
    translate = ["style", "translate", "in.json", "--style", "c0", "--motion", "m1", "--content", "c1", *out]
    fit = ["fit", "in.json", "--tolerance", "1", *out]
    return [
        ("import: unnamed shapes", doubled(4000), svg, ["import", "in.json", "in.svg", *out], True),
        ("ids: parts side by side", doubled(500), put(lambda n: parts(n, False)), [*render, "ids"], True),
        ("ids: parts behind each other", doubled(500), put(lambda n: parts(n, True)), [*render, "ids"], True),
        ("matte: parts side by side", doubled(500), put(lambda n: parts(n, False)), [*render, "matte"], True),
        ("matte: pixels", doubled(500_000), pixels, [*render, "matte"], True),
        ("snap: pixels", doubled(500_000), pixels, ["snap", "in.json", *out], True),
        ("export .svg: frames", doubled(500), put(tracked), ["export", "in.json", "-o", "out.svg"], True),
        ("export .nk: frames", doubled(500), put(tracked), ["export", "in.json", "-o", "out.nk"], True),
        ("export .fxs: frames", doubled(500), put(tracked), ["export", "in.json", "-o", "out.fxs"], True),
        ("fit: points", doubled(2000), put(curve), fit, True),
        ("fit yang1986: points", doubled(4000), put(curve), [*fit, "--preset", "yang1986"], True),
        ("translate: frames", doubled(1000), put(clips), translate, True),
        ("translate: clips", [4, 16, 36, 64], put(lambda n: clips(60, max(2, math.isqrt(n)))), translate, False),
        ("tween: strokes", doubled(50), put(drawings), ["tween", "in.json", *out], False),
    ]


def main() -> int:
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    wrong = []
    with tempfile.TemporaryDirectory() as name:
        bench = Bench(sys.argv[1], Path(name))
        png(bench.folder / "f_000.png", 960, 540)
        print("| command and size | sizes | seconds | MB | exponent of time |\n| --- | --- | --- | --- | ---: |")
        for title, sizes, write, words, linear in cases(bench):
            times, peaks = [], []
            for size in [max(sizes[0] // 50, 1), *sizes]:
                write(size)
                seconds, peak = bench.measure(words)
                times.append(seconds)
                peaks.append(peak)
            # The first run has next to no input: its time is that of the start.
            own = [max(seconds - times[0], 1e-3) for seconds in times[1:]]
            exponent = math.log(own[-1] / own[0]) / math.log(sizes[-1] / sizes[0])
            shown = f"{exponent:.2f}" if own[-1] > SHORT else "too short"
            if linear and own[-1] > SHORT and exponent > LINEAR:
                wrong.append(f"{title}: {exponent:.2f}")
            row = [", ".join(f"{v:{form}}" for v in values) for values, form in
                   ((sizes, "d"), (times[1:], ".2f"), (peaks[1:], ".0f"))]
            print(f"| {title} | {' | '.join(row)} | {shown} |", flush=True)
    print("\n".join(f"not linear: {line}" for line in wrong), file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())

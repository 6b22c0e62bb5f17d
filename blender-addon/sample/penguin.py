"""A penguin that waddles and waves: its poses, outlines and colours. Plain NumPy, no Blender.

The cartoon is drawn on twos: each of the twelve drawings is held for two frames. Coordinates: pixels, x right, y down.
"""

from __future__ import annotations

import math

import numpy as np

from . import painting

WIDTH, HEIGHT = 640, 360
DRAWINGS, HOLD = 12, 2
INK = (38, 30, 44)
LINE = 3.2
"""Width of the ink in pixels."""
PARTS = ("far wing", "far foot", "near foot", "body", "head", "near wing")
"""From the farthest to the nearest."""
COLOURS = {
    "far wing": (58, 66, 92),
    "far foot": (214, 132, 44),
    "near foot": (240, 158, 60),
    "body": (70, 84, 118),
    "head": (82, 98, 136),
    "near wing": (108, 126, 168),
}
WAVE = (15, 20, 15, 25, 40, 158, 30, 20, 15, 20, 25, 15)
"""Angle of the near wing on each drawing in degrees: 0 hangs down, 90 points backwards.

It waves on one drawing only. From the two keys nobody can know of it: this is the mistake that Track makes and an artist corrects."""
POINTS = 14
PAPER = (250, 248, 242)


def outlines(drawing: int) -> dict[str, np.ndarray]:
    """Control points (14, 2) of each part's outline on a drawing."""
    step = math.sin(drawing * math.pi / 2)
    hips = np.array([170.0 + 24 * drawing, 236.0 - 6 * abs(math.cos(drawing * math.pi / 2))])
    lean = math.radians(6 * step)
    neck = hips + _turned(np.array([[0.0, -92.0]]), lean)[0]
    shoulder = hips + _turned(np.array([[-14.0, -62.0]]), lean)[0]
    far = hips + _turned(np.array([[34.0, -58.0]]), lean)[0]
    return {
        "far wing": far + _turned(_leaf(64.0, 13.0), math.radians(-28 - 8 * step)),
        "far foot": hips + (26 + 12 * step, 66 - 10 * max(step, 0)) + _oval(26, 11),
        "near foot": hips + (-12 - 12 * step, 72 - 10 * max(-step, 0)) + _oval(28, 12),
        "body": hips + _turned(_egg(), lean),
        "head": neck + _turned(_oval(41, 37), 1.5 * lean),
        "near wing": shoulder + _turned(_leaf(78.0, 16.0), math.radians(WAVE[drawing])),
    }


def picture(drawing: int, lines: bool = False) -> np.ndarray:
    """A drawing (H, W, 3), values 0 to 255: painted, or with `lines` only its ink, on paper."""
    found = np.full((HEIGHT, WIDTH, 3), PAPER, np.float32) if lines else ground()
    shapes = outlines(drawing)
    for name in PARTS:
        _inked(found, painting.curve(shapes[name]), PAPER if lines else COLOURS[name])
        if name == "body":
            belly = painting.curve(shapes[name].mean(0) + (12, 12) + _oval(34, 50))
            if lines:
                _inked(found, belly, PAPER)
            else:
                painting.fill(found, belly, (244, 240, 228))
        if name == "head":
            _face(found, shapes[name].mean(0), PAPER if lines else (240, 158, 60))
    return found


def _inked(found: np.ndarray, line: np.ndarray, colour: tuple[int, int, int]) -> None:
    """Paints a shape with a line of ink around it."""
    painting.fill(found, painting.grown(line, LINE / 2), INK)
    painting.fill(found, painting.grown(line, -LINE / 2), colour)


def ground() -> np.ndarray:
    """Sky, hills of snow and a sun."""
    y = np.linspace(0, 1, HEIGHT, dtype=np.float32)[:, None, None]
    found = np.array([150, 196, 226], np.float32) * (1 - y) + np.array([232, 226, 206], np.float32) * y
    found = np.repeat(found, WIDTH, 1)
    painting.fill(found, painting.curve(np.array([540.0, 70.0]) + _oval(34, 34)), (252, 226, 150))
    x = np.linspace(0, WIDTH, 33)
    for base, wave, colour in ((215, 60.0, (206, 220, 232)), (268, 90.0, (240, 244, 246))):
        hill = np.stack([x, base + 14 * np.sin(x / wave)], 1)
        painting.fill(found, np.concatenate([hill, [[WIDTH, HEIGHT], [0, HEIGHT]]]), colour)
    return found


def _face(found: np.ndarray, middle: np.ndarray, colour: tuple[int, int, int]) -> None:
    _inked(found, middle + np.array([[32.0, -6.0], [66.0, 5.0], [32.0, 14.0], [26.0, 4.0]]), colour)
    for radius, colour, aside in ((9.0, INK, 0.0), (7.2, (252, 252, 248), 0.0), (3.6, INK, 2.0)):
        painting.fill(found, painting.curve(middle + (14.0 + aside, -8.0) + _oval(radius, radius)), colour)


def _turned(points: np.ndarray, angle: float) -> np.ndarray:
    cosine, sine = math.cos(angle), math.sin(angle)
    return points @ np.array([[cosine, sine], [-sine, cosine]])


def _turns() -> np.ndarray:
    return np.arange(POINTS) * (2 * math.pi / POINTS)


def _oval(across: float, up: float) -> np.ndarray:
    return np.stack([across * np.cos(_turns()), up * np.sin(_turns())], 1)


def _egg() -> np.ndarray:
    y = np.sin(_turns())
    return np.stack([(52 + 8 * y) * np.cos(_turns()), 80 * y - 10], 1)


def _leaf(long: float, wide: float) -> np.ndarray:
    """A wing that hangs down from the origin."""
    turns = _turns() - math.pi / 2
    return np.stack([wide * np.cos(turns) * (1 - 0.3 * np.sin(turns)), long / 2 * (1 + np.sin(turns)) - 8], 1)

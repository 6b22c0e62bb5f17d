"""The sample as files: pictures, and a document with the keys. Plain Python, no Blender."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from . import painting, penguin

PATTERN = "penguin_%03d.png"
LINE_PATTERN = "penguin_lines_%03d.png"
FIRST, LAST = 1, penguin.DRAWINGS * penguin.HOLD
KEYS = (FIRST, LAST)


def write(folder: Path, progress: Callable[[float, str], bool], lines: bool = False) -> bool:
    """Writes the pictures that are not there yet, painted or as lines. Returns whether all are there: `progress` may stop the work."""
    pattern = LINE_PATTERN if lines else PATTERN
    for drawing in range(penguin.DRAWINGS):
        numbers = [FIRST + drawing * penguin.HOLD + held for held in range(penguin.HOLD)]
        paths = [folder / (pattern % number) for number in numbers]
        if not progress(drawing / penguin.DRAWINGS, "drawing the cartoon"):
            return False
        if not all(path.is_file() for path in paths):
            picture = penguin.picture(drawing, lines)
            for path in paths:
                painting.write_png(path, picture)
    return True


def document(folder: Path, lines: bool = False) -> dict[str, Any]:
    """The project document: footage, and the parts with their keys on the first and the last frame. With `lines` it has no parts."""
    keys = {frame: penguin.outlines((frame - FIRST) // penguin.HOLD) for frame in KEYS}
    parts = [
        {"name": name, "closed": True, "depth": float(depth), "keys": {str(f): keys[f][name].tolist() for f in KEYS}}
        for depth, name in enumerate(() if lines else penguin.PARTS)
    ]
    footage = {
        "pattern": str(folder / (LINE_PATTERN if lines else PATTERN)),
        "first": FIRST,
        "last": LAST,
        "fps": 24.0,
        "width": penguin.WIDTH,
        "height": penguin.HEIGHT,
    }
    return {"rototoon": 1, "footage": footage, "parts": parts}

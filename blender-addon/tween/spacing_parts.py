"""Parts of a spacing, for the spans into which a breakdown divides a span.

What: a breakdown stands where the spacing has brought the movement on its frame. Before it the movement takes the part of the spacing up to there,
behind it the rest. So the other in-betweens keep their share of the way: a chart that brakes towards its end goes on braking, and does not
stop and start again at the breakdown.

How: the library alone knows its spacings. It draws one stroke on all asked places of the spacing, and gives their shares of the way. A part is
these shares from its begin to its end, stretched to 0 and 1, as a curve with a place on each frame at least.

Why so: the formulas of the spacings stay in one place. A stroke of two points costs the library some thousandths of a second.

Limits: a part in which the movement does not get on has no shares to stretch; it is even. So is one that goes to and fro more than ten times
as far as it gets on.
"""

from __future__ import annotations

import functools
import json
import math
from typing import Any

import numpy as np
from rototoon import Strokes, tween

PLACES = 32
"""Least number of steps of a part."""
STILL = 1e-3
"""Share of the way below which a part counts as standing."""
FARTHEST = 10.0
"""Largest share of a curve."""
_FRAMES = 1_000_000
_STROKE = np.array([[0.0, 0.0], [100.0, 0.0]])


def part(whole: Any, start: float, end: float, frames: int) -> Any:
    """The part of a spacing from one time to another, as the library takes it, for a span of so many frames."""
    return json.loads(_part(json.dumps(whole), start, end, frames * math.ceil(PLACES / frames)))


@functools.lru_cache(maxsize=512)
def _part(whole: str, start: float, end: float, steps: int) -> str:
    times = start + (end - start) * np.arange(steps + 1) / steps
    shares = _shares(json.loads(whole), times)
    way = shares[-1] - shares[0]
    if abs(way) < STILL:
        return '"linear"'
    shares = (shares[1:-1] - shares[0]) / way
    if np.abs(shares).max(initial=0) > FARTHEST:
        return '"linear"'
    places = np.stack([np.arange(1, steps) / steps, shares], 1)
    return json.dumps({"curve": places.round(9).tolist()})


def _shares(whole: Any, times: np.ndarray) -> np.ndarray:
    """The shares of the way at some times, rising from 0 to 1."""
    frames = np.round(times * _FRAMES).astype(int)
    inside = (frames > 0) & (frames < _FRAMES)
    shares = np.where(frames <= 0, 0.0, 1.0)
    strokes = Strokes(np.array([0, 2, 4], np.int32), np.concatenate([_STROKE, _STROKE + [0.0, 50.0]]), np.zeros(2, np.uint8))
    drawings = tween.Drawings(strokes, np.arange(3, dtype=np.int32), np.array([0, _FRAMES], np.int32))
    asked, back = np.unique(frames[inside], return_inverse=True)
    drawn, _ = tween.draw_in_betweens(drawings, [(0, asked.tolist())], spacing=[whole], threads=1)
    shares[inside] = np.asarray(drawn.shares)[back]
    return shares

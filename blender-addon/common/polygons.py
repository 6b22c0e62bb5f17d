"""Closed lines: their area, and what is inside of them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

CHUNK = 256
"""Places that are looked at together, so that the arrays stay small."""


def edges(*loops: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The starts and the ends of the sides of closed lines."""
    return np.concatenate(loops), np.concatenate([np.roll(loop, -1, axis=0) for loop in loops])


def area(loop: np.ndarray) -> float:
    """The area of a closed line (N, 2), with the sign of its direction."""
    x, y = loop[:, 0], loop[:, 1]
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2


def inside(loops: Sequence[np.ndarray], places: np.ndarray) -> np.ndarray:
    """Which places (N, 2) are inside of a shape, which has an odd number of loops around each."""
    found = np.zeros(len(places), bool)
    if not len(loops) or not len(places):
        return found
    p, q = edges(*loops)
    for start in range(0, len(places), CHUNK):
        x, y = places[start : start + CHUNK].T[..., None]
        over = (p[:, 1] > y) != (q[:, 1] > y)
        with np.errstate(divide="ignore", invalid="ignore"):
            at = p[:, 0] + (y - p[:, 1]) / (q[:, 1] - p[:, 1]) * (q[:, 0] - p[:, 0])
        found[start : start + CHUNK] = (over & (x < at)).sum(1) % 2 == 1
    return found

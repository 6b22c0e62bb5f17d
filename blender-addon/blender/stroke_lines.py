"""The lines that Blender draws for strokes of every curve type. They serve to show strokes and to find the clicked one."""

from __future__ import annotations

import numpy as np

from . import strokes as st

STEPS = 6
"""Number of steps per piece of a curve."""


def lines(content: st.Content, steps: int = STEPS) -> list[np.ndarray]:
    """For each stroke the points of its line (N, 3) in layer space. The line of a closed stroke ends where it begins. `steps` is the number of steps
    per piece of a NURBS."""
    points = np.asarray(content.point["position"], np.float64) if len(content.sizes) else np.zeros((0, 3))
    closed = content.strokes("cyclic")
    order, knots = content.strokes("nurbs_order"), content.strokes("knots_mode")
    handles = [content.point.get(f"handle_{side}") for side in ("left", "right")]
    found = []
    for i, (kind, first, last) in enumerate(zip(content.types.tolist(), content.starts, content.starts[1:])):
        own = points[first:last]
        if len(own) > 2 and kind == st.NURBS:
            own = _nurbs(own, int(order[i]), int(knots[i]), bool(closed[i]), steps)
        elif len(own) > 1 and kind == st.CATMULL_ROM:
            own = _catmull_rom(own, bool(closed[i]))
        elif len(own) > 1 and kind == st.BEZIER and handles[0] is not None and handles[1] is not None:
            own = _bezier(own, handles[0][first:last], handles[1][first:last], bool(closed[i]))
        elif len(own) > 1 and closed[i]:
            own = np.vstack([own, own[:1]])
        found.append(own)
    return found


def _nurbs(guides: np.ndarray, order: int, knots: int, closed: bool, steps: int) -> np.ndarray:
    """Points on a NURBS by de Boor's algorithm, all at once. Weights are ignored."""
    degree = min(order, len(guides)) - 1
    if closed:
        guides = np.vstack([guides, guides[:degree]])
    count = len(guides)
    at = _knots(count, degree, 0 if closed else knots)
    spans = np.unique(at[degree : count + 1])
    shares = np.arange(steps) / steps
    u = np.append((spans[:-1, None] + np.diff(spans)[:, None] * shares).ravel(), spans[-1])
    span = np.clip(np.searchsorted(at, u, "right") - 1, degree, count - 1)
    found = guides[span[:, None] - degree + np.arange(degree + 1)]
    for level in range(1, degree + 1):
        for j in range(degree, level - 1, -1):
            low, high = at[span - degree + j], at[span + j - level + 1]
            share = ((u - low) / np.where(high > low, high - low, 1.0))[:, None]
            found[:, j] = (1 - share) * found[:, j - 1] + share * found[:, j]
    return found[:, degree]


def _knots(count: int, degree: int, mode: int) -> np.ndarray:
    if mode == st.ENDPOINT:
        inner = np.arange(count - degree + 1)
        return np.concatenate([np.zeros(degree), inner, np.full(degree, inner[-1])]).astype(float)
    if mode == st.ENDPOINT_BEZIER:
        joints = np.repeat(np.arange(count // max(degree, 1) + 2), max(degree, 1))
        return np.concatenate([[0], joints])[: count + degree + 1].astype(float)
    return np.arange(count + degree + 1, dtype=float)


def _catmull_rom(points: np.ndarray, closed: bool) -> np.ndarray:
    if closed:
        before, after = np.roll(points, 1, axis=0), np.roll(points, -1, axis=0)
    else:
        before, after = np.vstack([points[:1], points[:-1]]), np.vstack([points[1:], points[-1:]])
    slope = (after - before) / 6
    return _bezier(points, points - slope, points + slope, closed)


def _bezier(points: np.ndarray, left: np.ndarray, right: np.ndarray, closed: bool) -> np.ndarray:
    if closed:
        points, left, right = (np.vstack([each, each[:1]]) for each in (points, left, right))
    t = (np.arange(STEPS) / STEPS)[None, :, None]
    a, b, c, d = (each[:, None] for each in (points[:-1], right[:-1], left[1:], points[1:]))
    inner = a * (1 - t) ** 3 + 3 * b * t * (1 - t) ** 2 + 3 * c * t**2 * (1 - t) + d * t**3
    return np.vstack([inner.reshape(-1, 3), points[-1:]])

"""Visible colours of strokes: the material's colour mixed with the colours of points and fills."""

from __future__ import annotations

import numpy as np

from . import materials
from . import strokes as st


def palette(ob) -> np.ndarray:
    """Line and fill colours (M, 2, 4) of the object's materials, linear."""
    found = []
    for material in materials.of(ob):
        style = material.grease_pencil if material is not None else None
        found.append([style.color[:], style.fill_color[:]] if style is not None else [[0, 0, 0, 1]] * 2)
    return np.array(found or [[[0, 0, 0, 1]] * 2], np.float64)


def of_strokes(ob, content: st.Content, known: np.ndarray) -> np.ndarray:
    """The colour by which each stroke is recognised, sRGB (S, 3): the fill's colour of a filled stroke, the line's colour
    otherwise."""
    return _mixed(content, known, st.filled(ob, content) != 0)


def of_lines(content: st.Content, known: np.ndarray) -> np.ndarray:
    """The colour of each stroke's line, sRGB (S, 3), whether it is filled or not."""
    return _mixed(content, known, np.zeros(len(content.sizes), bool))


def _mixed(content: st.Content, known: np.ndarray, filled: np.ndarray) -> np.ndarray:
    count = len(content.sizes)
    if not count:
        return np.zeros((0, 3))
    index = np.clip(content.strokes("material_index"), 0, len(known) - 1)
    base = known[index, filled.astype(int), :3]
    mixed = np.zeros((count, 4))
    points = content.point.get("vertex_color")
    some = content.sizes > 0
    if points is not None and some.any():
        sums = np.add.reduceat(points.astype(np.float64), content.starts[:-1][some])
        mixed[some] = sums / content.sizes[some, None]
    fills = content.curve.get("fill_color")
    if fills is not None:
        mixed[filled] = fills[filled]
    share = np.nan_to_num(mixed[:, 3:].clip(0, 1))
    linear = np.nan_to_num(base * (1 - share) + mixed[:, :3] * share).clip(0, 1)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)

"""What an edit on all frames gives strokes of other frames beside their shape: widths, colours, material and attributes of the artist's own.

A look goes by the share of a stroke's length. What Remove Hidden Lines has left of a stroke are pieces of one stroke, and what it changed is no look.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..blender import grease_pencil as gp
from ..blender import strokes as st
from . import drawings as dr

_FORM = {
    "position", "cyclic", "handle_left", "handle_right", "handle_type_left", "handle_type_right", "nurbs_order", "nurbs_weight", "knots_mode",
    "resolution",
}  # fmt: skip
"""Attributes that are the form of a stroke and no look."""


def left_by_rototoon(content: st.Content) -> np.ndarray:
    """For each stroke: whether Remove Hidden Lines has left it of a stroke, as a piece or as the outline of a fill."""
    return content.strokes(gp.INTERVAL).any(1)


@dataclass
class Source:
    """Where a look comes from."""

    stroke: int
    """The stroke that gives what holds for a whole stroke."""
    points: np.ndarray
    """Indices of the points that give the rest, by their share."""
    shares: np.ndarray
    without: set[str]
    """As `changed`."""


def sources(content: st.Content, which: Sequence[int]) -> list[Source]:
    """The sources of the looks of strokes. The pieces that Remove Hidden Lines has left of one stroke are one source."""
    left, undrawn, tracks = left_by_rototoon(content), st.undrawn(content), content.strokes(gp.TRACK)
    found, done = [], set()
    for i in which:
        if i in done:
            continue
        mine = np.flatnonzero(left & (tracks == tracks[i]) & ~undrawn) if left[i] and not undrawn[i] else np.array([i])
        done |= set(mine.tolist())
        points, shares = st.ranges(content.starts[mine], content.sizes[mine]), np.concatenate([_shares(content, k) for k in mine])
        order = np.argsort(shares, kind="stable")
        found.append(Source(i, points[order], shares[order], changed(content, i)))
    return found


def changed(content: st.Content, i: int) -> set[str]:
    """What is no look of a stroke, since Remove Hidden Lines has changed it."""
    left = left_by_rototoon(content)
    if not left[i]:
        return set()
    undrawn, tracks = st.undrawn(content), content.strokes(gp.TRACK)
    if undrawn[i]:
        return {"opacity"}
    # The fill is with the outline alone.
    return {"fill_id" if gp.FILL_BY_ID else "material_index"} if (left & undrawn & (tracks == tracks[i])).any() else set()


def _shares(content: st.Content, i: int) -> np.ndarray:
    """The shares of a stroke's points; of a piece that Remove Hidden Lines has left, on the whole stroke."""
    span = slice(*content.starts[i : i + 2])
    if gp.ALONG in content.point and left_by_rototoon(content)[i]:
        return content.point[gp.ALONG][span].astype(np.float64)
    return dr.shares(content.point["position"][span])


def look_like(made: st.Content, content: st.Content, source: Source, keeps: set[str]) -> None:
    """Gives a stroke the look of strokes of another drawing, by the share of the length. What it `keeps` stays."""
    where, known = _shares(made, 0), source.shares
    for name in _looks_of(content):
        if name in source.without | keeps:
            continue
        if name in content.curve:
            _have(made, content, name)
            made.curve[name] = content.curve[name][source.stroke : source.stroke + 1].copy()
        elif name in content.point:
            own = content.point[name][source.points]
            _have(made, content, name)
            if own.dtype.kind != "f":
                made.point[name] = own[np.abs(where[:, None] - known[None]).argmin(1)]
                continue
            columns = own.reshape(len(own), -1).astype(np.float64)
            values = np.stack([np.interp(where, known, columns[:, k]) for k in range(columns.shape[1])], 1)
            made.point[name] = values.reshape((len(where), *own.shape[1:])).astype(own.dtype)


def _looks_of(content: st.Content) -> list[str]:
    """The attributes that are looks of strokes, the artist's own too."""
    return sorted(name for name in {*content.point, *content.curve} - _FORM if not name.startswith("rototoon_"))


def _have(made: st.Content, source: st.Content, name: str) -> None:
    """Gives a stroke the data type of an attribute that it does not have yet."""
    if name not in made.kinds:
        made.kinds[name] = source.kinds[name] if name in source.kinds else gp.TYPES[name][0]

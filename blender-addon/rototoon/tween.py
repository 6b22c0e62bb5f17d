"""Drawings between drawings, without Blender: which stroke is which, and the strokes on the frames between.

This module imports nothing of Blender and takes any buffers of numbers::

    from rototoon import Strokes, tween

    drawings = tween.Drawings(Strokes(offsets, points, closed), [0, 12, 24], frames=[1, 9])
    drawn, matches = tween.draw_in_betweens(drawings, [(0, range(2, 9))], spacing=["ease_in_out"])

Coordinates are pixels. Strokes are named by their number among those of all drawings.
"""

from __future__ import annotations

import ctypes
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from .native import handles
from .native.arrays import as_json, buffer
from .native.errors import RototoonError
from .strokes import Strokes, stroke_buffers
from .types import Progress

PAIR, SPLIT, JOINED, VANISHED, APPEARED = range(5)
"""Kinds of rows of `Matches`: one stroke is one; the later stroke is a piece of the earlier one; the earlier is a piece of the
later one; the earlier one has no counterpart; the later one has none."""
REVERSED, BY_HAND = 1, 2
"""Flags of rows of `Matches`."""
CLOSED, PART_BEFORE, PART_AFTER = 1, 2, 4
"""Flags of strokes of `InBetweens`."""


@dataclass(frozen=True)
class Drawings:
    """Strokes of drawings on rising frames, one drawing after the other."""

    strokes: Strokes
    drawings: Any
    """int32, one more than there are drawings: drawing `d` has the strokes `drawings[d]` to `drawings[d + 1]`, from behind
    to the front."""
    frames: Any = None
    """int32, the frame of each drawing; matching needs none."""
    colours: Any = None
    """float64 (strokes, 3): sRGB from 0 to 1, NaN where a stroke has none; or `None`."""
    labels: Any = None
    """int32 (strokes, 2): material and layer, -1 where a stroke has none; strokes of two layers never match; or `None`."""
    by_hand: Any = ()
    """int32 (P, 2): pairs that are kept. -1 in the place of either stroke says that the other one has no counterpart."""


@dataclass(frozen=True)
class Matches:
    """Which stroke of a drawing is which of the next one."""

    offsets: memoryview
    """int32: drawing `d` and the next one have the rows `offsets[d]` to `offsets[d + 1]`, none where they were not needed."""
    rows: memoryview
    """int32 (R, 4): kind, stroke of the earlier drawing, stroke of the later one (-1 for none), flags."""
    values: memoryview
    """float64 (R, 2): of closed strokes the share of the later one's length at which the first point of the earlier one lies;
    how sure the pair is, 0 to 1."""


@dataclass(frozen=True)
class InBetweens:
    """Strokes on the frames of some spans."""

    frame_offsets: memoryview
    """int32: span `s` has the frames `frame_offsets[s]` to `frame_offsets[s + 1]`, as they were asked."""
    shares: memoryview
    """float64, by frame: the share of the way, 0 to 1, by which to blend what else strokes carry."""
    stroke_offsets: memoryview
    """int32: span `s` draws the strokes `stroke_offsets[s]` to `stroke_offsets[s + 1]` on all its frames, from behind."""
    strokes: memoryview
    """int32 (S, 3): the stroke of the earlier and of the later drawing (-1 for none), flags."""
    point_offsets: memoryview
    """int32: stroke `i` has `point_offsets[i + 1] - point_offsets[i]` points."""
    indices: memoryview
    """int32 (P, 4): by point of `point_offsets` the given points of the earlier and of the later drawing around its place.
    Where one drawing lacks the stroke, those of the other one stand for both."""
    weights: memoryview
    """float64 (P, 2): the weight of the second of either two."""
    points: memoryview
    """float64 (N, 2): by span, frame and point."""
    opacities: memoryview
    """float64: by span, frame and stroke; below 1 while a stroke fades."""


def match_strokes(drawings: Drawings, progress: Progress | None = None, **options: Any) -> Matches:
    """Finds which stroke of each drawing is which of the next one, whatever their order, direction and number of points.

    Options: `max_cost`, `max_turn` (radians) and `max_scale`, farthest from which counterparts are looked for; `threads`.
    """
    given = _arguments(drawings)
    with handles.progress_callback(progress) as callback:
        arguments = (*given[:8], *given[9:], *as_json(options), callback, None)
        return Matches(*handles.take(handles.MatchArrays, "rototoon_match_strokes", *arguments))


def draw_in_betweens(
    drawings: Drawings, spans: Iterable[tuple[int, Iterable[int]]], progress: Progress | None = None, **options: Any
) -> tuple[InBetweens, Matches]:
    """Draws the frames of `spans`: (number of a drawing, frames between it and the next one).

    Options: `spacing`, by drawing how the movement to the next one runs (``"smooth"``, ``"linear"``, ``"ease_in"``,
    ``"ease_out"``, ``"ease_in_out"``, ``"cosine"``, ``"bounce"``, ``"constant"``, ``{"curve": [[time, share], ...]}`` or a
    list of shares, one a frame); `corners`, drawings at which velocities do not join; `arcs` (0 to 1), `rigid`, `contacts`,
    `rest`; `leaving` (``"grow"``, ``"fade"``, ``{"leave": [width, height]}``); `pegs` as documents hold them, with `hung`,
    by stroke the name of its peg or `None`; `captured`, a list of ``{"closed": bool, "first": frame, "contours": [...]}``,
    contours whose movement is known, the points on each frame from the first on: strokes that lie on them follow them; and
    those of `match_strokes`. Without pegs these are found.

    A span depends on the drawings at its ends, on what was captured between them and, where its spacing is smooth, on the
    drawings beside them.
    """
    asked = [{"key": int(key), "frames": [int(frame) for frame in frames]} for key, frames in spans]
    if drawings.frames is None:
        raise RototoonError("frames: found none, expected one for each drawing")
    given = _arguments(drawings)
    with handles.progress_callback(progress) as callback:
        arguments = (*given, *as_json({"spans": asked, **options}), callback, None)
        kinds = handles.MatchArrays, handles.InBetweenArrays
        matches, drawn = handles.take_both(*kinds, "rototoon_draw_in_betweens", *arguments)
    return InBetweens(*drawn), Matches(*matches)


def _arguments(drawings: Drawings) -> tuple[Any, ...]:
    strokes = stroke_buffers(drawings.strokes)
    bounds, count = buffer(drawings.drawings, "i")
    if count < 1:
        raise RototoonError("drawings: found no numbers, expected one more than there are drawings")
    optional = []
    for name, values, kind, expected in (
        ("colours", drawings.colours, "d", 3 * strokes[1]),
        ("labels", drawings.labels, "i", 2 * strokes[1]),
        ("frames", drawings.frames, "i", count - 1),
    ):
        pointer, found = (ctypes.c_void_p(), expected) if values is None else buffer(values, kind)
        if found != expected:
            raise RototoonError(f"{name}: {found} values, expected {expected}")
        optional.append(pointer)
    colours, labels, frames = optional
    by_hand, numbers = buffer(drawings.by_hand, "i")
    if numbers % 2:
        raise RototoonError(f"by_hand: {numbers} numbers, expected two a pair")
    return (*strokes, colours, labels, bounds, count - 1, frames, by_hand, numbers // 2)

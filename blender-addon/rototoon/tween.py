"""In-betweens of drawings: matching the strokes of neighbouring drawings, and drawing the frames between them.

Arrays may be any buffers of numbers, such as NumPy arrays::

    from rototoon import Strokes, tween

    drawings = tween.Drawings(Strokes(offsets, points, closed), [0, 12, 24], frames=[1, 9])
    drawn, matches = tween.draw_in_betweens(drawings, [(0, range(2, 9))], spacing=["ease_in_out"])

Coordinates are pixels. A stroke is named by its index among the strokes of all drawings.
"""

from __future__ import annotations

import ctypes
import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from .native import handles
from .native.arrays import as_json, buffer
from .native.errors import RototoonError
from .strokes import Strokes, stroke_buffers
from .types import Progress

PAIR, SPLIT, JOINED, VANISHED, APPEARED, CHAINED = range(6)
"""Kinds of rows of `Matches`: a pair; the later stroke is a piece of the earlier one; the earlier stroke is a piece of the later
one; the earlier stroke has no counterpart; the later stroke has no counterpart; the two strokes are pieces of one line, cut in
other places, and share a stretch of it."""
REVERSED, BY_HAND = 1, 2
"""Flags of rows of `Matches`."""
CLOSED, PART_BEFORE, PART_AFTER = 1, 2, 4
"""Flags of strokes of `InBetweens`."""


@dataclass(frozen=True)
class Drawings:
    """Strokes of drawings in time order, one drawing after the other."""

    strokes: Strokes
    drawings: Any
    """int32, one more than the number of drawings: drawing `d` has the strokes `drawings[d]` to `drawings[d + 1]`, from back to
    front."""
    frames: Any = None
    """int32, the frame of each drawing. Matching does not need it."""
    colours: Any = None
    """float64 (strokes, 3): sRGB from 0 to 1, NaN for a stroke without a colour; or `None`."""
    labels: Any = None
    """int32 (strokes, 2): material and layer, -1 for none; or `None`. Strokes of different layers never match."""
    by_hand: Any = ()
    """int32 (P, 2): pairs that the artist made, which are kept. -1 for one stroke says that the other has no counterpart."""


@dataclass(frozen=True)
class Matches:
    """Matches between the strokes of neighbouring drawings."""

    offsets: memoryview
    """int32: drawing `d` and the next one have the rows `offsets[d]` to `offsets[d + 1]`; no rows where none were needed."""
    rows: memoryview
    """int32 (R, 4): kind, stroke of the earlier drawing, stroke of the later one (-1 for none), flags."""
    values: memoryview
    """float64 (R, 2). First, for closed strokes: where the earlier stroke's first point is on the later stroke, as a share of its
    length. Second: the confidence of the pair, 0 to 1."""


@dataclass(frozen=True)
class InBetweens:
    """Strokes on the frames of some spans."""

    frame_offsets: memoryview
    """int32: span `s` has the frames `frame_offsets[s]` to `frame_offsets[s + 1]`, in the order of the request."""
    shares: memoryview
    """float64, by frame: the share of the way, 0 to 1, with which to blend the other attributes of strokes."""
    stroke_offsets: memoryview
    """int32: span `s` draws the strokes `stroke_offsets[s]` to `stroke_offsets[s + 1]` on all its frames, from back to front."""
    strokes: memoryview
    """int32 (S, 3): the stroke of the earlier and of the later drawing (-1 for none), flags."""
    point_offsets: memoryview
    """int32: stroke `i` has `point_offsets[i + 1] - point_offsets[i]` points."""
    indices: memoryview
    """int32 (P, 4): for each point of `point_offsets` two neighbouring points of the earlier drawing and two of the later drawing.
    If one drawing lacks the stroke, the points of the other drawing are used for both."""
    weights: memoryview
    """float64 (P, 2): for each of the two drawings, the weight of the second point."""
    points: memoryview
    """float64 (N, 2): by span, frame and point."""
    opacities: memoryview
    """float64: by span, frame and stroke. Below 1 while a stroke fades."""
    held: memoryview
    """uint8, by span: 1 where no movement between the two drawings can be believed, so that all frames show the earlier one."""


def match_strokes(drawings: Drawings, progress: Progress | None = None, **options: Any) -> Matches:
    """Matches the strokes of each drawing to those of the next one. Order, direction and number of points may differ.

    Options: `max_cost`, `max_turn` (radians) and `max_scale` limit how different counterparts may be; `threads`.
    """
    given = _arguments(drawings)
    with handles.progress_callback(progress) as callback:
        arguments = (*given[:8], *given[9:], *as_json(options), callback, None)
        return Matches(*handles.take(handles.MatchArrays, "rototoon_match_strokes", *arguments))


def draw_in_betweens(
    drawings: Drawings, spans: Iterable[tuple[int, Iterable[int]]], progress: Progress | None = None, **options: Any
) -> tuple[InBetweens, Matches]:
    """Draws the frames of `spans`. A span is (index of a drawing, frames between it and the next drawing).

    Options, beside those of `match_strokes`:

    - `spacing`: for each drawing the spacing up to the next one. ``"smooth"``, ``"linear"``, ``"ease_in"``, ``"ease_out"``,
      ``"ease_in_out"``, ``"cosine"``, ``"bounce"``, ``"constant"``, ``{"curve": [[time, share], ...]}``, or a list of shares, one
      per frame.
    - `corners`: drawings at which the velocity may jump.
    - `arcs` (0 to 1), `rigid`, `contacts`, `rest`.
    - `leaving`: ``"grow"``, ``"fade"`` or ``{"leave": [width, height]}``.
    - `pegs` in the form of documents, and `hung`: for each stroke the name of its peg or `None`. Without `pegs`, pegs are found.
    - `captured`: a list of ``{"closed": bool, "first": frame, "contours": [...]}``. These are contours whose movement is known,
      with their points on each frame from `first` on. Strokes that lie on such a contour follow it.

    A span depends on the drawings at its ends and on what was captured between them. With smooth spacing it also depends on the
    drawings before and after.
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


@dataclass(frozen=True)
class Breakdown:
    """A frame on which one more drawing helps most."""

    frame: int
    first: int
    """The key before it."""
    last: int
    """The key after it."""
    by: str
    """``"picture"``: by the pictures, a drawing there mends most of its span. ``"movement"``: no picture shows the movement, and it is the middle
    of the span that moves most."""
    distance: float
    """Pixels: how far the in-between is from its picture, or how far the span moves."""
    keys: float | None
    """Pixels: how far the keys are from their pictures. `None` without pictures."""
    foreign: float | None
    """Pixels: how far the keys are from pictures that show something else, which count for nothing then."""
    looked: list[tuple[int, float]]
    """Frame and distance of each drawing that has a picture."""
    text: str
    """The suggestion in a sentence."""


def suggest_breakdown(
    drawings: Drawings,
    keys: Iterable[int],
    footage: Mapping[str, Any] | None = None,
    folder: str = "",
    progress: Progress | None = None,
    *,
    threads: int = 0,
) -> Breakdown | None:
    """Suggests the frame for a breakdown. `None` where nothing lies between two keys.

    `drawings` are keys and in-betweens in time order, with their `frames`; colours, labels and pairs do not count. `keys` are the
    frames of the keys. `footage` is the footage in the form of documents, with the same frames and pixels; `folder` is the folder of a
    relative pattern. Where its pictures show the drawings, the suggestion is the frame that mends most of its span.
    """
    if drawings.frames is None:
        raise RototoonError("frames: found none, expected one for each drawing")
    given = _arguments(drawings)
    asked = {"keys": [int(key) for key in keys], "footage": footage, "folder": folder, "threads": threads}
    if footage is not None:
        asked["footage"] = dict(footage)
    with handles.progress_callback(progress) as callback:
        arguments = (*given[:4], *given[6:9], *as_json(asked), callback, None)
        found = json.loads(handles.take(handles.Text, "rototoon_suggest_breakdown", *arguments))
    if found is None:
        return None
    return Breakdown(**{**found, "looked": [(frame, distance) for frame, distance in found["looked"]]})


def _arguments(drawings: Drawings) -> tuple[Any, ...]:
    strokes = stroke_buffers(drawings.strokes)
    bounds, count = buffer(drawings.drawings, "i")
    if count < 1:
        raise RototoonError("drawings: found no numbers, expected one more than the number of drawings")
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
        raise RototoonError(f"by_hand: {numbers} numbers, expected two per pair")
    return (*strokes, colours, labels, bounds, count - 1, frames, by_hand, numbers // 2)

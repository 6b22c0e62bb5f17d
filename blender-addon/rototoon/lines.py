"""Traced lines: the strokes of line drawings, the same strokes on every frame. `Session.trace` makes them.

::

    from rototoon import Session

    with Session.open("shot_010/project.json") as session:
        traced = session.trace(style="auto")
        for stroke in traced.on(12):
            print(stroke.track, numpy.asarray(stroke.points).shape)

Coordinates are pixels. `Traced` has flat arrays for NumPy; `Traced.on` gives the strokes of one frame.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from .outcomes import outcomes


@dataclass(frozen=True)
class Stroke:
    """A stroke on one frame."""

    track: int
    """Its number, the same on all frames."""
    points: memoryview
    """float64 (N, 2), pixels."""
    closed: bool
    """Whether its last point joins its first."""
    widths: memoryview
    """float64 (N,): the width of the line at each point, in pixels; NaN if it is not known."""
    colour: tuple[float, float, float] | None
    """sRGB from 0 to 1; `None` if it is not known."""
    confidence: float
    """The probability, 0 to 1, that it is the stroke of its number. It is 1 if that is beyond doubt: it was drawn, or begins here."""
    fill: bool
    """Whether what is inside is filled with the colour, such as a solid black. Without widths there is no line around it."""
    fill_colour: tuple[float, float, float] | None = None
    """sRGB from 0 to 1 of the fill below a line; `None` if there is none."""


@dataclass(frozen=True)
class Doubt:
    """A stroke that is in doubt somewhere."""

    track: int
    """Its number."""
    doubtful: list[int]
    """Frames on which a look at it is worth while, rising."""
    lost: list[int]
    """Frames on which it is probably another stroke, rising."""


def doubts(confidence: Mapping[int, Mapping[int, float]]) -> list[Doubt]:
    """The strokes that are in doubt, by number. `confidence` has for each number the confidence by frame."""
    numbers = sorted(confidence)
    found = outcomes({"keys": [], "confidence": confidence[number]} for number in numbers).parts
    every = [Doubt(number, each.doubtful, each.lost) for number, each in zip(numbers, found, strict=True)]
    return [doubt for doubt in every if doubt.doubtful or doubt.lost]


@dataclass(frozen=True)
class Traced:
    """The strokes of F frames: S strokes with P points. All arrays are read-only."""

    frames: memoryview
    """int32 (F,): frame numbers, rising."""
    stroke_offsets: memoryview
    """int32 (F + 1,): frame `f` has the strokes `stroke_offsets[f]` to `stroke_offsets[f + 1]`, from back to front."""
    tracks: memoryview
    """int32 (S,): the number of each stroke, the same on all frames. On one frame each number occurs once."""
    closed: memoryview
    """int32 (S,): not 0 if the last point joins the first."""
    colours: memoryview
    """float64 (S, 3): sRGB from 0 to 1, NaN for a stroke without a colour."""
    point_offsets: memoryview
    """int32 (S + 1,): stroke `i` has the points `point_offsets[i]` to `point_offsets[i + 1]`."""
    points: memoryview
    """float64 (P, 2), pixels."""
    widths: memoryview
    """float64 (P,): the width of the line at each point in pixels, NaN for a stroke without widths."""
    confidence: memoryview
    """float64 (S,): for each stroke the probability that it is the stroke of its number; 1 if that is beyond doubt."""
    fills: memoryview
    """int32 (S,): not 0 if what is inside is filled with the stroke's colour."""
    fill_colours: memoryview
    """float64 (S, 3): sRGB from 0 to 1 of the fill below a line, NaN if there is none."""

    def on(self, frame: int) -> list[Stroke]:
        """The strokes of a frame, from back to front. There are none on a frame that was not traced."""
        numbers = self.frames.tolist()
        if frame not in numbers:
            return []
        place = numbers.index(frame)
        return [self._stroke(i) for i in range(self.stroke_offsets[place], self.stroke_offsets[place + 1])]

    def doubts(self) -> list[Doubt]:
        """The strokes that are in doubt on some frame, by number. Sure, doubtful and lost come from the formula of `outcomes`."""
        frames, bounds, tracks = self.frames.tolist(), self.stroke_offsets, self.tracks.tolist()
        means: dict[int, dict[int, float]] = {}
        for place, frame in enumerate(frames):
            for i in range(bounds[place], bounds[place + 1]):
                means.setdefault(tracks[i], {})[frame] = self.confidence[i]
        return doubts(means)

    def _stroke(self, i: int) -> Stroke:
        first, last = self.point_offsets[i], self.point_offsets[i + 1]
        # A memoryview of two dimensions cannot be cut; its bytes can.
        flat = self.points.cast("B")[16 * first : 16 * last]
        points = flat.cast("d", (last - first, 2)) if last > first else flat.cast("d")
        closed, fill = bool(self.closed[i]), bool(self.fills[i])
        colour, inside = _colour(self.colours, i), _colour(self.fill_colours, i)
        return Stroke(self.tracks[i], points, closed, self.widths[first:last], colour, self.confidence[i], fill, inside)


def _colour(colours: memoryview, i: int) -> tuple[float, float, float] | None:
    red, green, blue = (colours[i, channel] for channel in range(3))
    return None if red != red else (red, green, blue)

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

from dataclasses import dataclass


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

    def on(self, frame: int) -> list[Stroke]:
        """The strokes of a frame, from back to front. There are none on a frame that was not traced."""
        numbers = self.frames.tolist()
        if frame not in numbers:
            return []
        place = numbers.index(frame)
        return [self._stroke(i) for i in range(self.stroke_offsets[place], self.stroke_offsets[place + 1])]

    def _stroke(self, i: int) -> Stroke:
        first, last = self.point_offsets[i], self.point_offsets[i + 1]
        red, green, blue = (self.colours[i, channel] for channel in range(3))
        # A memoryview of two dimensions cannot be cut; its bytes can.
        flat = self.points.cast("B")[16 * first : 16 * last]
        points = flat.cast("d", (last - first, 2)) if last > first else flat.cast("d")
        colour = None if red != red else (red, green, blue)
        return Stroke(self.tracks[i], points, bool(self.closed[i]), self.widths[first:last], colour)

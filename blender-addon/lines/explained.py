"""New strokes of one group of layers that lie on strokes that another group follows.

What: each group looks for all lines of the film, and one of them draws those that no stroke explains. It does not know the strokes of the other groups.
`strokes` finds the new strokes on lines that have one there already.

How: on each frame the followed strokes of the other groups are drawn as broad lines, as `off_ink` does. A new stroke with more than half of its length
on them, over all frames, is explained.

Why so: by the share over all frames a stroke is left out on all of them or on none, so that none flickers.

Limits: a line that is drawn close beside a followed one counts as it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby

import numpy as np
from rototoon.lines import Traced

from . import numbers, off_ink
from . import plan as pl

Keyed = dict[int, list[numbers.Key]]
"""By scene frame the keys of its strokes."""
MOST = 0.5
"""Share of the length on followed strokes from which on a new stroke is explained."""


@dataclass
class Result:
    """What was found for a group."""

    group: pl.Group
    traced: Traced
    keyed: Keyed

    def followed(self) -> set[numbers.Key]:
        """The keys of the strokes that are followed."""
        return {key for frame in self.group.seeds for key in self.keyed[frame]}

    def lines(self, offset: int) -> Iterator[tuple[int, numbers.Key, np.ndarray, np.ndarray]]:
        """The strokes of all frames: frame, key, points on the line, one a pixel, and widths."""
        points, widths = np.asarray(self.traced.points, np.float64).reshape(-1, 2), np.asarray(self.traced.widths, np.float64)
        ends, closed = self.traced.point_offsets, np.asarray(self.traced.closed)
        for place, number in enumerate(self.traced.frames.tolist()):
            for i, key in enumerate(self.keyed[number + offset], self.traced.stroke_offsets[place]):
                span = slice(ends[i], ends[i + 1])
                yield number + offset, key, off_ink.dense(points[span], bool(closed[i])), widths[span]


def strokes(own: Result, others: Sequence[Result], offset: int) -> Iterator[float]:
    """Returns the keys of the new strokes of a group that lie on strokes of other groups, in steps of a frame. The scene shows picture n on frame
    n + offset."""
    shown, known = own.group.document["footage"], own.followed()
    there = yield from _followed(others, offset)
    on: dict[numbers.Key, float] = {}
    lengths: dict[numbers.Key, int] = {}
    # One frame after the other: the places of a whole film are as large as its pictures.
    for frame, mine in groupby(own.lines(offset) if there else (), key=lambda each: each[0]):
        ink = _ink(there.pop(frame, []), (shown["width"], shown["height"]))
        for _, key, line, _ in mine:
            if key not in known:
                lengths[key] = lengths.get(key, 0) + len(line)
                on[key] = on.get(key, 0.0) + (len(line) * (1 - ink.off(line)) if ink is not None else 0.0)
        yield 0.0
    return {key for key, length in lengths.items() if on[key] > MOST * length}


def _followed(others: Sequence[Result], offset: int) -> Iterator[float]:
    """Returns by scene frame the lines of the strokes that groups follow, with their widths, in steps of a frame."""
    there: dict[int, list[tuple[np.ndarray, np.ndarray]]] = {}
    for other in others:
        theirs = other.followed()
        for frame, each in groupby(other.lines(offset) if theirs else (), key=lambda each: each[0]):
            there.setdefault(frame, []).extend((line, widths) for _, key, line, widths in each if key in theirs)
            yield 0.0
    return there


def _ink(drawn: list[tuple[np.ndarray, np.ndarray]], size: tuple[int, int]) -> off_ink.Ink | None:
    """The places that lines, with their widths, explain; `None` without lines."""
    if not drawn:
        return None
    lines, widths = zip(*drawn, strict=True)
    return off_ink.Ink(lines, np.concatenate(widths), size)

"""Traced strokes that Rototoon itself changes on one drawing: curves are fitted, hidden lines are cut.

That is no edit of the artist. So the marks by which *Edit on All Frames* tells an edit follow: what was not edited before is not edited afterwards.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager

import numpy as np

from ..blender import grease_pencil as gp
from ..blender import marks
from ..blender import strokes as st
from . import moved, records, spreading


def follow(before: st.Content, after: st.Content, source: np.ndarray, slots: marks.Slots) -> None:
    """Notes places and looks of the strokes `after`, where they were as noted `before`. `source` has for each stroke the index of the one that
    it comes from. `marks.remember` shall keep the `slots`."""
    if gp.LINE not in before.point or not len(after.sizes):
        return
    known = spreading.found(before, (), None, slots)
    still = np.repeat(~known.moved[source], after.sizes)
    after.point[gp.TRACKED] = np.where(still[:, None], after.point["position"], after.point[gp.TRACKED])
    after.set_strokes(gp.LOOK, np.where(known.same[source], marks.stroke_looks(after, slots.now), after.strokes(gp.LOOK)))


@contextmanager
def removed(ob, gone: Mapping[str, Mapping[int, set[int]]]) -> Iterator[None]:
    """Notes that Rototoon itself removes strokes: by layer and frame their numbers. They do not count as deleted by the artist."""
    known = moved.read(ob, gone) if gone else {}
    yield
    for name in gone.keys() & known.keys():
        numbers = known[name].numbers
        for frame in gone[name].keys() & numbers.keys():
            numbers[frame] = [number for number in numbers[frame] if number not in gone[name][frame]]
    if gone:
        records.write(ob.data, known)

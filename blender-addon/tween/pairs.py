"""Pairs of strokes made by hand, kept on the strokes themselves.

Whatever happens to a stroke (it is moved, changes its place in the order, is copied, its neighbours are deleted), its
pair goes with it: both strokes carry the same number, one as `NEXT`, the other as `BEFORE`. A number without its
counterpart means nothing.
"""

from __future__ import annotations

import numpy as np

from ..blender import grease_pencil as gp
from ..blender import strokes as st

NONE = -1


def between(earlier: st.Content, later: st.Content) -> list[tuple[int, int]]:
    """Pairs of strokes of neighbouring keys by index, -1 in the place of what the other one lacks."""
    to, of = earlier.strokes(gp.NEXT), later.strokes(gp.BEFORE)
    found = {int(number): j for j, number in reversed(list(enumerate(of))) if number > 0}
    pairs = []
    for i, number in enumerate(to.tolist()):
        if number == NONE:
            pairs.append((i, NONE))
        elif number > 0 and number in found:
            pairs.append((i, found.pop(number)))
    pairs.extend((NONE, int(j)) for j in np.flatnonzero(of == NONE))
    return pairs


class Hand:
    """Decisions about two neighbouring keys, written into their drawings."""

    def __init__(self, earlier, later):
        """The drawings of the keys."""
        self._handles = (earlier, later)
        self._names = (gp.NEXT, gp.BEFORE)

    def values(self) -> tuple[np.ndarray, np.ndarray]:
        """The marks of both drawings' strokes."""
        counts = [len(gp.offsets(handle)) - 1 for handle in self._handles]
        found = [gp.value(h, name, n) for h, name, n in zip(self._handles, self._names, counts)]
        return found[0], found[1]

    def restore(self, values: tuple[np.ndarray, np.ndarray]) -> None:
        """Puts back what `values` gave."""
        for handle, name, each in zip(self._handles, self._names, values):
            if len(each):
                gp.put(handle, name, each)

    def pair(self, i: int, j: int) -> None:
        """Pairs stroke `i` of the earlier key with `j` of the later one; pairs that either was in are undone."""
        to, of = self._without(i, j)
        to[i] = of[j] = max(int(to.max()), int(of.max()), 0) + 1
        self.restore((to, of))

    def alone(self, side: int, index: int) -> None:
        """Says that a stroke (of the earlier key: side 0) has no counterpart."""
        values = self._without(*((index, None) if side == 0 else (None, index)))
        values[side][index] = NONE
        self.restore(values)

    def release(self, side: int, index: int) -> None:
        """Takes back what was decided of a stroke."""
        self.restore(self._without(*((index, None) if side == 0 else (None, index))))

    def _without(self, i: int | None, j: int | None) -> tuple[np.ndarray, np.ndarray]:
        to, of = self.values()
        for index, own, other in ((i, to, of), (j, of, to)):
            if index is not None:
                if own[index] > 0:
                    other[other == own[index]] = 0
                own[index] = 0
        return to, of

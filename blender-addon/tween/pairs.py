"""Pairs of strokes that are given: those that the artist made, those of breakdowns that were in-betweens, and those of carried strokes. The
library finds the others.

The two strokes of an artist's pair carry the same number, one as `NEXT`, the other as `BEFORE`. So it survives when a stroke is moved,
reordered or copied, or when its neighbours are deleted. A number without a counterpart means nothing. No other pair of the layer has the number, so that
it does not meet that of another key when a key between is deleted.

"No counterpart" is said of one key. So the key gets a number (`KEY`) that the stroke carries too. It means nothing where another key is the neighbour, as
one that is drawn between the two later.
"""

from __future__ import annotations

import numpy as np
from rototoon.lines import doubts

from ..blender import grease_pencil as gp
from ..blender import strokes as st

NONE = -1
EARLIER, LATER = 1, 2
"""On which key a stroke of an in-between has a counterpart: the values of `SIDES`."""


def between(earlier: st.Content, later: st.Content) -> list[tuple[int, int]]:
    """Pairs of strokes of neighbouring keys by index; -1 for no counterpart."""
    to, of = earlier.strokes(gp.NEXT), later.strokes(gp.BEFORE)
    found = {int(number): j for j, number in reversed(list(enumerate(of))) if number > 0}
    pairs = []
    alone, alone_later = without(to, later.strokes(gp.KEY)), without(of, earlier.strokes(gp.KEY))
    for i, number in enumerate(to.tolist()):
        if alone[i]:
            pairs.append((i, NONE))
        elif number > 0 and number in found:
            pairs.append((i, found.pop(number)))
    pairs.extend((NONE, int(j)) for j in np.flatnonzero(alone_later))
    return pairs


def without(values: np.ndarray, keys: np.ndarray) -> np.ndarray:
    """Which strokes have no counterpart on a neighbour, by their values of `NEXT` or `BEFORE` and the neighbour's values of `KEY`."""
    return (values == NONE) | (values < NONE) & np.isin(NONE - values, keys)


def given(earlier: st.Content, later: st.Content) -> list[tuple[int, int]]:
    """As `between`, with the strokes that are the same since they were drawn as in-betweens, traced or carried. A decision of the artist wins."""
    found = between(earlier, later)
    found += _same(earlier, later, [{pair[side] for pair in found} for side in (0, 1)])
    decided = [{pair[side] for pair in found} for side in (0, 1)]
    places = {number: j for j, number in reversed(list(enumerate(carried(later)))) if number and j not in decided[1]}
    for i, number in enumerate(carried(earlier)):
        if number in places and i not in decided[0]:
            # A copied stroke has its original's number; the second one is matched.
            found.append((i, places.pop(number)))
    return found


def _same(earlier: st.Content, later: st.Content, decided: list[set[int]]) -> list[tuple[int, int]]:
    """Strokes with the same number, where one of the two drawings was an in-between: see `breakdowns`."""
    sides = earlier.strokes(gp.SIDES) & LATER, later.strokes(gp.SIDES) & EARLIER
    if not (sides[0].any() or sides[1].any()):
        return []
    places: dict[int, list[int]] = {}
    for j, number in enumerate(later.strokes(gp.TRACK).tolist()):
        if number > 0 and j not in decided[1]:
            places.setdefault(number, []).append(j)
    found = []
    for i, number in enumerate(earlier.strokes(gp.TRACK).tolist()):
        j = next((j for j in places.get(number, ()) if sides[0][i] or sides[1][j]), None) if i not in decided[0] else None
        if j is not None:
            found.append((i, j))
            del places[number]
    return found


def carried(content: st.Content) -> list[int]:
    """The number that tracing or carrying gave each stroke; 0 for strokes that were drawn since, or are probably another one.

    In-between gives strokes numbers, too. It found these itself, and would repeat its mistakes, so they do not count.
    """
    tracks, starts = content.strokes(gp.TRACK).tolist(), content.starts
    lines, sure, fine = content.point.get(gp.LINE), content.point.get(gp.CONFIDENCE), content.finite()
    if lines is None:
        return [0] * len(tracks)
    spans = [slice(a, b) for a, b in zip(starts, starts[1:])]
    found = [track if fine[i] and (lines[spans[i]] == track).mean() > 0.5 else 0 for i, track in enumerate(tracks)]
    if sure is not None:
        known = {i: {0: float(np.nan_to_num(sure[spans[i]]).mean().clip(0, 1))} for i, track in enumerate(found) if track}
        for doubt in doubts(known):
            found[doubt.track] = 0 if doubt.lost else found[doubt.track]
    return found


def free_number(layer) -> int:
    """A number that no pair and no key of a layer has."""
    most = 0
    for handle, _ in gp.drawings(layer).values():
        for name in (gp.NEXT, gp.BEFORE, gp.KEY):
            if gp.has(handle, name):
                most = max(most, int(np.abs(gp.value(handle, name, len(gp.offsets(handle)) - 1)).max(initial=0)))
    return most + 1


class Hand:
    """The artist's decisions on two neighbouring keys, stored in their drawings."""

    def __init__(self, earlier, later):
        """`earlier` and `later` are the drawings of the keys."""
        self._handles = (earlier, later)
        self._names = (gp.NEXT, gp.BEFORE)

    def values(self) -> tuple[np.ndarray, np.ndarray]:
        """The marks of the strokes of both drawings."""
        to, of = (gp.value(handle, name, self._count(side)) for side, (handle, name) in enumerate(zip(self._handles, self._names)))
        return to, of

    def decided(self) -> tuple[np.ndarray, np.ndarray]:
        """The marks that count between these two drawings: the number of a pair, or `NONE`."""
        values = self.values()
        keys = [gp.value(handle, gp.KEY, self._count(side)) for side, handle in enumerate(self._handles)]
        to, of = (np.where(without(own, other), NONE, np.maximum(own, 0)) for own, other in zip(values, reversed(keys)))
        return to, of

    def _count(self, side: int) -> int:
        return len(gp.offsets(self._handles[side])) - 1

    def restore(self, values: tuple[np.ndarray, np.ndarray]) -> None:
        """Restores the result of `values`."""
        for handle, name, each in zip(self._handles, self._names, values):
            if len(each):
                gp.put(handle, name, each)

    def pair(self, i: int, j: int, number: int) -> None:
        """Pairs stroke `i` of the earlier key with stroke `j` of the later key, by a number that no other pair of the layer has. Earlier pairs of both
        are removed."""
        to, of = self._without(i, j)
        to[i] = of[j] = number
        self.restore((to, of))

    def alone(self, side: int, index: int, number: int) -> None:
        """Marks a stroke as without a counterpart on the other key. Side 0 is the earlier key. The other key gets a number, if it has none yet: `number`,
        which nothing else on the layer has."""
        values = self._without(*((index, None) if side == 0 else (None, index)))
        values[side][index] = NONE - self._key(1 - side, number)
        self.restore(values)

    def _key(self, side: int, number: int) -> int:
        """The number of a key; 0 for a drawing without strokes, which keeps none."""
        known = gp.value(self._handles[side], gp.KEY, self._count(side))
        if not len(known):
            return 0
        number = int(known.max()) or number
        if (known != number).any():
            gp.put(self._handles[side], gp.KEY, np.full(len(known), number, np.int32))
        return number

    def release(self, side: int, index: int) -> None:
        """Takes back the decision on a stroke."""
        self.restore(self._without(*((index, None) if side == 0 else (None, index))))

    def _without(self, i: int | None, j: int | None) -> tuple[np.ndarray, np.ndarray]:
        to, of = self.values()
        for index, own, other in ((i, to, of), (j, of, to)):
            if index is not None:
                if own[index] > 0:
                    other[other == own[index]] = 0
                own[index] = 0
        return to, of

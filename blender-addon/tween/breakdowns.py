"""In-betweens that the artist corrected become breakdowns, and their strokes stay the strokes that they were.

What: each stroke of an in-between is the stroke of its keys that has its number. So the pairs of a span, found or made by hand, hold on both sides of
a breakdown that was its in-between. Only strokes that the artist drew new, and those whose counterpart is gone, are matched.

How: an in-between notes for each stroke on which of its keys it has a counterpart (`rototoon_sides`). Strokes that the artist draws have no
note. `pairs.given` pairs strokes of neighbouring keys that have the same number, where one of them has such a note. The artist's own decisions
are marks on the two keys of the span (see `pairs`). They are passed on here: a pair is made of both halves, and "no counterpart" goes to
the stroke nearest to the key that lacks it.

Why so: matched anew, such strokes would be strangers, and pairs that the artist corrected would be lost. The note tells more than the number: where
strokes give way to others half way, or a drawing is held, equal numbers are a doubtful guess, so those strokes have a counterpart on one side only.

Limits: drawings of earlier versions have no notes; their strokes count as noted on both sides if their number is the only one on the
drawing. Of a stroke that the artist doubled, the lower one keeps the counterpart.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from ..blender import grease_pencil as gp
from . import pairs
from .pairs import EARLIER, LATER


@dataclass
class Marks:
    """The marks of a drawing's strokes."""

    track: np.ndarray
    next: np.ndarray
    before: np.ndarray
    sides: np.ndarray
    key: np.ndarray

    def find(self, number: int, side: int) -> int | None:
        """The stroke with a number that has a counterpart on a side."""
        found = np.flatnonzero((self.track == number) & ((self.sides & side) != 0)) if number > 0 else ()
        return int(found[0]) if len(found) else None

    def values(self) -> dict[str, np.ndarray]:
        """The marks that may have changed, by attribute."""
        return {gp.NEXT: self.next, gp.BEFORE: self.before, gp.SIDES: self.sides}


def sides(stands: np.ndarray, held: bool) -> np.ndarray:
    """The notes of in-betweens whose strokes are these of the earlier and the later key (S, 2), -1 for none. A held drawing is the earlier one."""
    found = np.where(stands[:, 0] >= 0, EARLIER, 0) + (0 if held else np.where(stands[:, 1] >= 0, LATER, 0))
    return found.astype(np.int32)


def passed_on(layer, keys: list[int], edited: Iterable[int]) -> dict[int, Marks]:
    """The marks of breakdowns and of the keys around them, by frame. `keys` are all keys, with those that were in-betweens until they were edited."""
    mine = set(edited)
    if not mine:
        return {}
    handles = {frame: handle for frame, (handle, _) in gp.drawings(layer).items()}
    found: dict[int, Marks] = {}
    for chain in _chains(keys, mine):
        for frame in chain:
            found.setdefault(frame, _read(handles[frame], frame in mine))
        _pass(*(found[frame] for frame in chain))
    return found


def write(layer, marks: dict[int, Marks]) -> None:
    """Writes marks into their drawings."""
    drawings = gp.drawings(layer) if marks else {}
    for frame, each in marks.items():
        for name, values in each.values().items():
            if len(values) and (values.any() or gp.has(drawings[frame][0], name)):
                gp.put(drawings[frame][0], name, values)


def _chains(keys: list[int], mine: set[int]) -> Iterable[list[int]]:
    """Breakdowns that follow each other, with the key before and the key after them."""
    chain: list[int] = []
    for frame in keys:
        chain.append(frame)
        if frame not in mine:
            if len(chain) > 2:
                yield chain
            chain = [frame]


def _read(handle, edited: bool) -> Marks:
    count = len(gp.offsets(handle)) - 1
    track, after, before, noted, key = (gp.value(handle, name, count).copy() for name in (gp.TRACK, gp.NEXT, gp.BEFORE, gp.SIDES, gp.KEY))
    if edited and not gp.has(handle, gp.SIDES):
        _, place, often = np.unique(track, return_inverse=True, return_counts=True)
        single = often[place] == 1 if count else np.zeros(0, bool)
        noted = np.where(gp.value(handle, gp.TWEENED, count) & single, EARLIER + LATER, 0).astype(np.int32)
    return Marks(track, after, before, noted, key)


def _pass(first: Marks, *rest: Marks) -> None:
    """Passes the decisions of two keys on to the breakdowns between them."""
    *between, last = rest
    for i in np.flatnonzero(first.next > 0):
        j = np.flatnonzero(last.before == first.next[i])
        if len(j):
            _link(first, last, between, int(i), int(j[0]))
    for i in np.flatnonzero(pairs.without(first.next, last.key)):
        _alone(first.next, int(i), int(first.track[i]), [(each, each.next, EARLIER) for each in between])
    for j in np.flatnonzero(pairs.without(last.before, first.key)):
        _alone(last.before, int(j), int(last.track[j]), [(each, each.before, LATER) for each in reversed(between)])


def _link(first: Marks, last: Marks, between: list[Marks], i: int, j: int) -> None:
    """Pairs a stroke with its counterpart on the key after the breakdowns, over them."""
    pair = first.next[i]
    for each in between:
        for side, own in ((EARLIER, each.before), (LATER, each.next)):
            ways = (each.find(int(number), side) for number in (first.track[i], last.track[j]))
            k = next((k for k in ways if k is not None), None)
            if k is not None and own[k] == 0 and not (own == pair).any():
                own[k] = pair


def _alone(own: np.ndarray, index: int, number: int, between) -> None:
    """Passes "no counterpart" on to the last breakdown on which the stroke goes on."""
    for marks, values, side in between:
        k = marks.find(number, side)
        if k is None or values[k]:
            return
        own[index], values[k] = 0, own[index]
        own, index = values, k

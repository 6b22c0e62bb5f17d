"""Parts that look alike and may have changed places, as the last Track found them. The object keeps them, by the parts' numbers.

The words are those of the command line (`rototoon.outcomes`). Frames are pictures here, and scene frames in what is told. A key or a pin says which part is
which, and the next Track finds out.

Limits: documents do not hold them, so parts that come in from one, or from a farm, have none until they are tracked in Blender.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache

from rototoon import Exchange, LibraryError, outcomes

from ..common import kept
from ..common.wording import counted

NAMED = 3
"""Largest number of pairs that a message tells. The panel tells all."""


@dataclass(frozen=True)
class Pair:
    """Two parts and the scene frames on which nothing says which is which."""

    parts: tuple[str, str]
    """Their names."""
    frames: tuple[int, ...]
    """They rise. There is at least one."""

    def __str__(self) -> str:
        """What the command line says of it; without a library, which finds such parts, nothing."""
        try:
            return _words(self)
        except LibraryError:
            return ""


@lru_cache(maxsize=64)
def _words(pair: Pair) -> str:
    """Panels are drawn often."""
    return outcomes([], [Exchange(pair.parts, list(pair.frames))]).exchanges[0]


def note(ob, found: Iterable[Exchange]) -> None:
    """Stores with an object what a run found. Its parts are known by name there."""
    numbers = {item.name: item.number for item in ob.rototoon.parts}
    put(ob, [(*(numbers[name] for name in pair.parts), list(pair.frames)) for pair in found])


def put(ob, rows: list[tuple[int, int, list[int]]]) -> None:
    """Stores the numbers of two parts and pictures, as `rows_of` gives them. Rows without a picture are left out."""
    rows = [row for row in rows if row[2]]
    text = json.dumps(rows) if rows else ""
    if ob.rototoon.exchanges != text:
        ob.rototoon.exchanges = text


def rows_of(ob) -> list[tuple[int, int, list[int]]]:
    """What `put` stored. Rows that are damaged are left out."""
    rows = kept.fields(f'{{"rows": {ob.rototoon.exchanges or "[]"}}}').get("rows")
    rows = rows if isinstance(rows, list) else []
    good = [row for row in rows if isinstance(row, list) and len(row) == 3 and isinstance(row[2], list)]
    return [(a, b, frames) for a, b, frames in good if frames and all(type(number) is int for number in (a, b, *frames))]


def of(ob) -> list[Pair]:
    """The pairs of parts that are still there."""
    names, offset = {item.number: item.name for item in ob.rototoon.parts}, ob.rototoon.frame_offset
    rows = [(a, b, frames) for a, b, frames in rows_of(ob) if a in names and b in names]
    return [Pair((names[a], names[b]), tuple(sorted(frame + offset for frame in set(frames)))) for a, b, frames in rows]


def told(ob) -> list[str]:
    """What a message says of an object's pairs."""
    said = [str(pair) for pair in of(ob)]
    more = len(said) - NAMED
    return said[:NAMED] + ([f"{counted(more, 'more pair')} that may have changed places, in the panel Track"] if more > 0 else [])

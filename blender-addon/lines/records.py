"""What the file keeps of traced drawings beside their strokes.

For each layer, as one JSON text on the Grease Pencil data:

- the checksum of the points and numbers of each traced drawing. It shows whether the artist has moved or numbered strokes since, or put another
  drawing there. Everything else that an artist may change shows in the drawing's mark (see `blender.marks`).
- which traced drawings have such a mark. Versions without marks do not write it, so the mark of a drawing that one of them traced anew does not count.
- the numbers of the strokes of each drawing that was traced or followed. They show which strokes the artist has deleted since.
"""

from __future__ import annotations

import json
import zlib
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

PROPERTY = "rototoon_lines"


@dataclass
class Layer:
    """The record of a layer, by frame."""

    sums: dict[int, int] = field(default_factory=dict)
    numbers: dict[int, list[int]] = field(default_factory=dict)
    marked: set[int] = field(default_factory=set)


Records = dict[str, Layer]


def read(data) -> Records:
    """The records of a data-block; none if the text cannot be read."""
    try:
        kept = json.loads(data.get(PROPERTY, "{}"))
        return {name: _layer(each) for name, each in kept.items()}
    except (ValueError, TypeError, KeyError, AttributeError):
        return {}


def _layer(kept) -> Layer:
    sums = {int(frame): int(total) for frame, total in kept["sums"].items()}
    numbers = {int(frame): _expanded(text) for frame, text in kept["numbers"].items()}
    return Layer(sums, numbers, set(_expanded(kept.get("marked", ""))))


def write(data, records: Records) -> None:
    """Writes the records into a data-block. Without any, the text is removed."""
    kept = {name: each for name, each in records.items() if each.sums or each.numbers or each.marked}
    if not kept:
        if PROPERTY in data:
            del data[PROPERTY]
        return
    data[PROPERTY] = json.dumps(
        {
            name: {
                "sums": each.sums,
                "numbers": {frame: _ranges(numbers) for frame, numbers in each.numbers.items()},
                "marked": _ranges(each.marked),
            }
            for name, each in kept.items()
        },
        separators=(",", ":"),
    )


def _ranges(numbers: Iterable[int]) -> str:
    """Numbers as a text such as 1-5,8."""
    spans: list[list[int]] = []
    for number in sorted(set(numbers)):
        if spans and number == spans[-1][1] + 1:
            spans[-1][1] = number
        else:
            spans.append([number, number])
    return ",".join(str(a) if a == b else f"{a}-{b}" for a, b in spans)


def _expanded(text: str) -> list[int]:
    found: list[int] = []
    for span in text.split(",") if text else ():
        first, _, last = span.partition("-")
        found.extend(range(int(first), int(last or first) + 1))
    return found


def checksum(points: np.ndarray, tracks: np.ndarray, sizes: np.ndarray) -> int:
    """Checksum of a drawing: points float32 (N, 3), and for each stroke its number and its number of points."""
    found = zlib.crc32(np.ascontiguousarray(points, np.float32))
    found = zlib.crc32(np.ascontiguousarray(tracks, np.int32), found)
    return zlib.crc32(np.ascontiguousarray(sizes, np.int32), found)

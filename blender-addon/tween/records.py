"""Records of in-betweens in the file, so that only changed spans are drawn again.

The records are one JSON text on the Grease Pencil data. For each layer it has the next free number of a stroke, and its spans by the
frame of the earlier key. A span has its last frame, a digest of everything from which it was drawn, the artist's choices, and checksums of the
points of its keys and of each drawing. Those of the keys say where a key is that was moved in time (see `moved_keys`). Whether the artist has
changed a drawing shows in its mark (see `blender.marks`), and in files of earlier versions in its checksum.
"""

from __future__ import annotations

import json
import zlib
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from .charts import Choices

PROPERTY = "rototoon_tween"


@dataclass
class Span:
    """A span that was drawn."""

    last: int
    digest: str
    choices: Choices
    sums: dict[int, int] = field(default_factory=dict)
    """Checksums of the drawings' points by frame."""
    marked: bool = False
    """Whether the drawings have marks (see `blender.marks`). Versions without marks do not write it."""
    ends: tuple[int, int] | None = None
    """Checksums of the points of its two keys, by which they are known again on other frames. Earlier versions do not write it."""


@dataclass
class Layer:
    """The records of a layer."""

    next_track: int = 1
    spans: dict[int, Span] = field(default_factory=dict)

    def holding(self, first: int, last: int) -> Span | None:
        """The recorded span that contains a span; the shortest, where another one was drawn inside of what is left of a longer one."""
        start = self._holding(first, last)
        return None if start is None else self.spans[start]

    def _holding(self, first: int, last: int) -> int | None:
        lengths = {start: span.last - start for start, span in self.spans.items() if start <= first and last <= span.last}
        return min(lengths, key=lambda start: lengths[start], default=None)

    def choices(self, first: int, last: int) -> Choices | None:
        """The choices of a span that is recorded, or that a key divides. Its spacing is divided with it."""
        start = self._holding(first, last)
        if start is None:
            return None
        return self.spans[start].choices.divided(start, self.spans[start].last, (first, last))

    def overlapping(self, first: int, last: int) -> Span | None:
        """The recorded span that shares most frames with a span."""
        shared = {start: min(last, span.last) - max(first, start) for start, span in self.spans.items()}
        best = max(shared, key=lambda start: (shared[start], -start), default=None)
        return self.spans[best] if best is not None and shared[best] > 0 else None


def read(data) -> dict[str, Layer]:
    """The records of a data-block by layer; none if the text cannot be read."""
    try:
        kept = json.loads(data.get(PROPERTY, "{}"))
        return {name: _layer(each) for name, each in kept.items()}
    except (ValueError, TypeError, KeyError, AttributeError):
        return {}


def _layer(kept: dict[str, Any]) -> Layer:
    spans = {
        int(first): Span(
            int(each["last"]),
            str(each["digest"]),
            Choices.of(each["choices"]),
            {int(frame): int(total) for frame, total in each["sums"].items()},
            bool(each.get("marked", False)),
            _ends(each.get("ends")),
        )
        for first, each in kept["spans"].items()
    }
    return Layer(int(kept["next"]), spans)


def _ends(kept: Any) -> tuple[int, int] | None:
    return (int(kept[0]), int(kept[1])) if isinstance(kept, list) and len(kept) == 2 else None


def write(data, records: dict[str, Layer]) -> None:
    """Writes the records into a data-block. Without records, the text is removed."""
    kept = {name: _kept(layer) for name, layer in records.items() if layer.spans or layer.next_track > 1}
    if kept:
        data[PROPERTY] = json.dumps(kept, separators=(",", ":"))
    elif PROPERTY in data:
        del data[PROPERTY]


def _kept(layer: Layer) -> dict[str, Any]:
    spans = {
        str(first): {"last": s.last, "digest": s.digest, "choices": s.choices.kept(), "sums": s.sums, "marked": s.marked}
        | ({"ends": list(s.ends)} if s.ends else {})
        for first, s in sorted(layer.spans.items())
    }
    return {"next": layer.next_track, "spans": spans}


def checksum(positions: np.ndarray) -> int:
    """Checksum of the points of a drawing, float32 (N, 3)."""
    return zlib.crc32(np.ascontiguousarray(positions, np.float32))

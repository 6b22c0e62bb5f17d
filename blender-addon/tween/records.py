"""Records of in-betweens in the file, so that only changed spans are drawn again.

The records are one JSON text on the Grease Pencil data. For each layer it has the next free number of a stroke, and its spans by the
frame of the earlier key. A span has its last frame, a digest of everything from which it was drawn, the artist's choices, and checksums of the
points of its keys and of each drawing. Those of the keys say where a key is that was moved in time (see `moved_keys`). Whether the artist has
changed a drawing shows in its mark (see `blender.marks`), and in files of earlier versions in its checksum.

An artist may give a layer another name, or double it. So a layer that has in-betweens and no spans gets those of the record that has checksums of its
drawings: all of it, if the layer of that name has no in-betweens, otherwise a copy.
"""

from __future__ import annotations

import json
import zlib
from copy import deepcopy
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..blender import grease_pencil as gp
from .charts import Choices

PROPERTY = "rototoon_tween"
EMPTY = zlib.crc32(b"")
"""Checksum of a drawing without points: of an in-between whose lines are all hidden."""


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
    """The records of a data-block by layer, under the names that the layers have now; none if the text cannot be read."""
    try:
        kept = json.loads(data.get(PROPERTY, "{}"))
        known = {name: _layer(each) for name, each in kept.items()}
    except (ValueError, TypeError, KeyError, AttributeError):
        return {}
    return _under_new_names(data, known)


def _under_new_names(data, known: dict[str, Layer]) -> dict[str, Layer]:
    sums = {name: {total for span in layer.spans.values() for total in span.sums.values()} for name, layer in known.items() if layer.spans}
    strangers = [layer.name for layer in data.layers if layer.name not in sums and _has_in_betweens(layer)] if sums else []
    if not strangers:
        return known
    left = {name for name in sums if (layer := gp.find_layer_of(data, name)) is None or not _has_in_betweens(layer)}
    with gp.copied(data) as copy:
        for name in strangers:
            drawn = {checksum(gp.positions(handle, int(gp.offsets(handle)[-1]))) for handle in gp.handles(gp.find_layer_of(copy, name), gp.GENERATED)}
            # A layer that is gone, or has lost its in-betweens, has another name now; only then is one with in-betweens the double of another.
            best = max(sums, key=lambda each: (len(sums[each] & drawn), each in left))
            if not sums[best] & drawn:
                continue
            known[name] = deepcopy(known[best])
            if best in left:
                del known[best], sums[best]
                left.discard(best)
            if not sums:
                break
    return known


def _has_in_betweens(layer) -> bool:
    """Whether a layer has in-betweens. Reads no array."""
    return any(gp.has(handle, gp.TWEENED) for handle in gp.handles(layer, gp.GENERATED))


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

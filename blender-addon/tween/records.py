"""What a file keeps of its in-betweens: from what each span was made, so that only what changed is made again.

One text on the Grease Pencil data: by layer the number of the next stroke, and by span (frame of its earlier key) the last
frame, a digest of all that it was made from, the artist's choices, and a checksum of each drawing, which tells whether
the artist has changed it since.
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
    """Checksum of each drawing by frame."""


@dataclass
class Layer:
    """What is known of a layer."""

    next_track: int = 1
    spans: dict[int, Span] = field(default_factory=dict)

    def holding(self, first: int, last: int) -> Span | None:
        """The span in which another one lies."""
        for start, span in self.spans.items():
            if start <= first and last <= span.last:
                return span
        return None


def read(data) -> dict[str, Layer]:
    """The records of a data-block by layer; none where the text is not understood."""
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
        )
        for first, each in kept["spans"].items()
    }
    return Layer(int(kept["next"]), spans)


def write(data, records: dict[str, Layer]) -> None:
    """Puts the records into a data-block; without any, nothing is left there."""
    kept = {name: _kept(layer) for name, layer in records.items() if layer.spans or layer.next_track > 1}
    if kept:
        data[PROPERTY] = json.dumps(kept, separators=(",", ":"))
    elif PROPERTY in data:
        del data[PROPERTY]


def _kept(layer: Layer) -> dict[str, Any]:
    spans = {
        str(first): {"last": s.last, "digest": s.digest, "choices": s.choices.kept(), "sums": s.sums}
        for first, s in sorted(layer.spans.items())
    }
    return {"next": layer.next_track, "spans": spans}


def checksum(positions: np.ndarray) -> int:
    """Of the points of a drawing, float32 (N, 3)."""
    return zlib.crc32(np.ascontiguousarray(positions, np.float32))

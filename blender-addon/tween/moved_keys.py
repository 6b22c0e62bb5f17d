"""Records of in-betweens follow keys that the artist moves in time.

What: records name a span by the frames of its keys. A selection that is moved in the dope sheet gives several keys other frames at once, with
the in-betweens or without them. `followed` gives the records the frames that their keys have now.

How: a record notes the checksum of its two keys' points. The noted checksums and those of the layer's keys are two lists in time order. Their
longest common stretches say which key is which. Where a stretch differs on both sides but has as many keys, such as a key that was moved and
redrawn, its keys are the same in order. Otherwise a key is the one on its own frame. Keys that stand where they stood count as such, unless more keys
are known again without that.

Why so: the order of drawings is what a move keeps. Single drawings may look alike, such as the poses of a cycle or a hold; only their
neighbours tell them apart.

Limits: records of earlier versions have no checksums, so their keys are known by their frames alone. Keys that change places with each other count as
redrawn.
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from difflib import SequenceMatcher
from itertools import pairwise

from ..blender import grease_pencil as gp
from . import keys as ks
from . import records


def sums_of(layer, frames: Iterable[int]) -> dict[int, int]:
    """Checksums of the points of a layer's drawings by frame."""
    drawings = gp.drawings(layer)
    handles = {frame: drawings[frame][0] for frame in frames}
    return {frame: records.checksum(gp.positions(handle, int(gp.offsets(handle)[-1]))) for frame, handle in handles.items()}


@dataclass
class Followed:
    """A layer's record between the frames that its keys have now."""

    record: records.Layer
    origin: dict[int, int] = field(default_factory=dict)
    """By the first frame of each of its spans the one under which it is recorded."""
    moved: list[tuple[tuple[int, int], set[int]]] = field(default_factory=list)
    """Spans that have other frames now, each with the frames on which its in-betweens were drawn."""

    def strays(self, found: ks.Frames, wanted: Iterable[tuple[int, int]]) -> set[int]:
        """Frames of in-betweens that moved keys have left behind: those of spans that are drawn anew, where no other span is drawn."""
        spans = list(wanted)
        left = {frame for span, frames in self.moved if span in spans for frame in frames & set(found.made)}
        return {frame for frame in left if not any(first < frame < last for first, last in spans)}


def followed(layer, record: records.Layer, keys: list[int]) -> Followed:
    """The record of a layer, with its spans between the frames that their keys have now."""
    if not record.spans:
        return Followed(record)
    places, spans = _places(record, sums_of(layer, keys), keys), {}
    half = []
    for first, span in sorted(record.spans.items()):
        a, b = places.get(first), places.get(span.last)
        if a is None or b is None:
            half.append((first, span, (a - first if a is not None else 0) or (b - span.last if b is not None else 0)))
        else:
            spans[a] = first, replace(span, last=b)
    for first, span, by in half:
        # One of its keys is gone. The rest of it goes along with the other one.
        spans.setdefault(first + by, (first, replace(span, last=span.last + by)))
    layout = {now: span for now, (_, span) in sorted(spans.items())}
    found = Followed(records.Layer(record.next_track, layout), {now: first for now, (first, _) in spans.items()})
    for now, (first, span) in spans.items():
        if (now, span.last) != (first, record.spans[first].last):
            found.moved.append(((now, span.last), set(span.sums)))
    return found


def drawn_now(layer, record: records.Layer, found: ks.Frames) -> list[tuple[int, int, records.Span]]:
    """The spans of a record as they lie now: the frame under which each is recorded, its first frame, and the span with the frames that its in-betweens
    have now."""
    known = followed(layer, record, found.keys)
    spans = []
    for now, span in known.record.spans.items():
        first = known.origin[now]
        if (now, span.last) != (first, record.spans[first].last):
            span = replace(span, sums=sums_of(layer, [frame for frame in found.made if now < frame < span.last]))
        spans.append((first, now, span))
    return spans


def note(layer, record: records.Layer) -> None:
    """Notes the keys of all spans whose keys were not noted yet."""
    new = {first: span for first, span in record.spans.items() if span.ends is None}
    there = gp.drawings(layer).keys()
    sums = sums_of(layer, {frame for first, span in new.items() for frame in (first, span.last) if frame in there})
    for first, span in new.items():
        if first in sums and span.last in sums:
            span.ends = sums[first], sums[span.last]


def _places(record: records.Layer, now: dict[int, int], keys: list[int]) -> dict[int, int]:
    """By the frame of a recorded key the frame that it has now."""
    noted: dict[int, int | None] = {}
    for first, span in record.spans.items():
        for frame, total in zip((first, span.last), span.ends or (None, None)):
            noted[frame] = noted.get(frame) if total is None else total
    before = sorted(noted)
    if None in noted.values():
        return {frame: frame for frame in before if frame in now}
    stand = [frame for frame in before if now.get(frame) == noted[frame]]
    standing: dict[int, int] = {frame: frame for frame in stand}
    for low, high in pairwise([-math.inf, *stand, math.inf]):
        old, new = ([frame for frame in frames if low < frame < high] for frames in (before, keys))
        standing |= in_order(old, noted, new, now)
    moving = in_order(before, noted, keys, now)
    return moving if len(moving) > len(standing) else standing


def in_order(before: list[int], noted: Mapping[int, Hashable], keys: list[int], now: Mapping[int, int]) -> dict[int, int]:
    """Which recorded drawing is which drawing, by their order alone. `noted` and `now` are checksums by frame."""
    found: dict[int, int] = {}
    match = SequenceMatcher(None, [noted[frame] for frame in before], [now[frame] for frame in keys], autojunk=False)
    for kind, a, b, c, d in match.get_opcodes():
        if kind == "equal" or (kind == "replace" and b - a == d - c):
            found.update(zip(before[a:b], keys[c:d]))
        else:
            found.update((frame, frame) for frame in before[a:b] if frame in keys[c:d])
    return found

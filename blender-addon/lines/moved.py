"""Records of traced drawings follow drawings that the artist moves in time.

What: `records` name drawings by frame. A selection that is moved in the dope sheet, as where a drawing is inserted in a film, gives them other frames.
`followed` gives the record of a layer the frames that its drawings have now. So a traced drawing that lies unchanged on another frame is still a traced
one, and what was deleted from a drawing is still known.

How: first, a drawing that has its frame's checksum stands. Then a drawing with the checksum of a recorded one that does not stand anywhere was moved
there; of several, the earlier ones come first. All others are the same by their order among their neighbours, as in `tween.moved_keys`, or are those of
their frame.

Why so: a checksum counts every point and number, so two drawings seldom share one. The artist's drawings, and traced ones that were changed, have
none that is known: only their neighbours tell where they were.

Limits: a copy of a traced drawing in the place of another one is the artist's, since the first one still stands. Where a changed drawing changes places
with its neighbours, strokes that were deleted from it are not known any more.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from ..blender import grease_pencil as gp
from ..tween import moved_keys
from . import records


def read(ob, names: Iterable[str]) -> records.Records:
    """The records of an object's data, those of the layers `names` on the frames that their drawings have now."""
    found = records.read(ob.data)
    with gp.copied(ob.data) as data:
        for name in names:
            layer = gp.find_layer_of(data, name)
            if name in found and layer is not None:
                found[name] = followed(found[name], sums_of({frame: handle for frame, (handle, _) in gp.drawings(layer).items()}))
    return found


def sums_of(handles: Mapping[int, object]) -> dict[int, int]:
    """Checksums of drawings by frame."""
    found = {}
    for frame, handle in handles.items():
        starts = gp.offsets(handle)
        tracks = gp.value(handle, gp.TRACK, len(starts) - 1)
        found[frame] = records.checksum(gp.positions(handle, int(starts[-1])), tracks, np.diff(starts))
    return found


def followed(record: records.Layer, now: Mapping[int, int]) -> records.Layer:
    """The record of a layer on the frames that its drawings have now. `now` are their checksums by frame."""
    known = record.sums.keys() | record.numbers.keys() | record.marked
    if all(now.get(frame) == total for frame, total in record.sums.items()) and record.numbers.keys() <= now.keys():
        return record
    places = _places(record, sorted(known), now)
    taken = set(places.values())
    # What lies on no other frame stays where it was.
    places |= {frame: frame for frame in known - places.keys() - taken}
    sums, numbers = ({places[frame]: each for frame, each in of.items() if frame in places} for of in (record.sums, record.numbers))
    return records.Layer(sums, numbers, {places[frame] for frame in record.marked if frame in places})


def _places(record: records.Layer, before: list[int], now: Mapping[int, int]) -> dict[int, int]:
    """By the frame of a recorded drawing the frame that it has now."""
    places = {frame: frame for frame, total in record.sums.items() if now.get(frame) == total}
    waiting: dict[int, list[int]] = {}
    for frame, total in sorted(record.sums.items()):
        if frame not in places:
            waiting.setdefault(total, []).append(frame)
    for frame, total in sorted(now.items()):
        if frame not in places and waiting.get(total):
            places[waiting[total].pop(0)] = frame
    # A drawing of the artist has a number of strokes, and no checksum.
    noted = {frame: record.sums.get(frame, ("", frame)) for frame in before}
    taken = set(places.values())
    for frame, there in moved_keys.in_order(before, noted, sorted(now), now).items():
        if frame not in places and there not in taken:
            places[frame] = there
    return places

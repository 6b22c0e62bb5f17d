"""The drawings of a layer: the artist's keys, and the in-betweens."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from ..blender import grease_pencil as gp
from ..blender import marks
from ..blender import strokes as st
from . import records

OURS = {gp.TRACK, gp.TWEENED, gp.NEXT, gp.BEFORE, gp.KEY, gp.SIDES, gp.MARK, gp.OFF_INK}
"""Attributes that do not affect the look of a stroke."""


@dataclass
class Frames:
    """The frames of a layer."""

    keys: list[int]
    """The artist's frames, in time order."""
    made: list[int]
    """Frames of in-betweens, in time order."""
    edited: list[int] = field(default_factory=list)
    """Keys that were in-betweens until the artist changed them."""
    blank: set[int] = field(default_factory=set)
    """Keys without strokes."""
    ends: set[int] = field(default_factory=set)
    """Those of them that are not the artist's: they end what was tracked or snapped."""


def is_tweened(handle, kind: str) -> bool:
    """Whether a drawing is an in-between, and has no strokes of the artist."""
    if kind != gp.GENERATED:
        return False
    if not gp.has(handle, gp.TWEENED):
        return False
    made = gp.value(handle, gp.TWEENED, len(gp.offsets(handle)) - 1)
    return bool(len(made) and made.all())


def is_emptied(handle, kind: str) -> bool:
    """Whether a drawing is a generated one without strokes. It bears no mark, so only records tell what it was."""
    return kind == gp.GENERATED and len(gp.offsets(handle)) < 2


def _has_tweened(handle) -> bool:
    return bool(gp.has(handle, gp.TWEENED) and gp.value(handle, gp.TWEENED, len(gp.offsets(handle)) - 1).any())


def frames_of(layer, record: records.Layer) -> Frames:
    """Sorts the frames of a layer into keys and in-betweens."""
    found, slots = Frames([], []), marks.Slots(layer.id_data)
    drawn = {number: total for span in record.spans.values() for number, total in span.sums.items()}
    with gp.copied(layer.id_data) as data:
        for number, (handle, kind) in gp.drawings(gp.find_layer_of(data, layer.name)).items():
            if is_emptied(handle, kind) and drawn.get(number) == records.EMPTY:
                found.made.append(number)
                continue
            if not is_tweened(handle, kind):
                found.keys.append(number)
                if kind == gp.GENERATED and (number in drawn or _has_tweened(handle)):
                    # The artist has drawn on it, in its place, or has emptied it.
                    found.edited.append(number)
            elif _is_edited(st.read(handle), number, record, slots):
                found.keys.append(number)
                found.edited.append(number)
            else:
                found.made.append(number)
                continue
            if len(gp.offsets(handle)) < 2:
                found.blank.add(number)
                if kind == gp.GENERATED and number not in drawn:
                    found.ends.add(number)
    found.keys.sort()
    found.made.sort()
    return found


def _is_edited(content: st.Content, number: int, record: records.Layer, slots: marks.Slots) -> bool:
    """Whether the artist has changed an in-between. One that lies as it was drawn on another frame was moved there, and is still one."""
    span = next((span for span in record.spans.values() if number in span.sums), None)
    if span is None or span.marked:
        same = marks.untouched(content, slots)
        if same is not None or span is None:
            return same is False
    # An older version may have drawn it anew: then the mark is of an earlier drawing, and the records say so.
    drawn = {total for each in record.spans.values() for total in each.sums.values()}
    return records.checksum(content.point["position"]) not in drawn


def digest(content: st.Content) -> bytes:
    """Digest of everything that a drawing shows."""
    summed = hashlib.blake2b(digest_size=16)
    summed.update(content.sizes.tobytes() + content.types.tobytes())
    for side in (content.point, content.curve):
        for name in sorted(side):
            if name not in OURS:
                summed.update(name.encode())
                summed.update(np.ascontiguousarray(side[name]))
    return summed.digest()


def around(frames: Iterable[int], current: int) -> tuple[int, int] | None:
    """The two keys around a frame. On a key: this key and the next one. On the last key: the one before and this key."""
    rising = sorted(frames)
    if len(rising) < 2 or current < rising[0]:
        return None
    k = max(index for index, frame in enumerate(rising) if frame <= current)
    if k == len(rising) - 1:
        # After the last key there are no in-betweens.
        return (rising[k - 1], rising[k]) if current == rising[k] else None
    return rising[k], rising[k + 1]

"""The drawings of a layer: the artist's, which are keys, and those that were drawn between them."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from ..blender import grease_pencil as gp
from ..blender import strokes as st
from . import records

OURS = {gp.TRACK, gp.TWEENED, gp.NEXT, gp.BEFORE}
"""Attributes that say nothing of how a stroke looks."""


@dataclass
class Frames:
    """The frames of a layer."""

    keys: list[int]
    """The artist's, rising."""
    made: list[int]
    """Those drawn between keys."""
    edited: list[int] = field(default_factory=list)
    """Keys that had been drawn between others, and that the artist has changed since."""
    blank: set[int] = field(default_factory=set)
    """Keys without strokes."""


def is_tweened(handle, kind: str) -> bool:
    """Whether a drawing was drawn between keys, and holds nothing else."""
    if kind != gp.GENERATED:
        return False
    if not gp.has(handle, gp.TWEENED):
        return False
    made = gp.value(handle, gp.TWEENED, len(gp.offsets(handle)) - 1)
    return bool(len(made) and made.all())


def frames_of(layer, record: records.Layer) -> Frames:
    """Tells the frames of a layer apart."""
    found = Frames([], [])
    sums = {frame: total for span in record.spans.values() for frame, total in span.sums.items()}
    for number, (handle, kind) in gp.drawings(layer).items():
        if not is_tweened(handle, kind):
            found.keys.append(number)
        elif number in sums and sums[number] != _sum(handle):
            found.keys.append(number)
            found.edited.append(number)
        else:
            found.made.append(number)
            continue
        if len(gp.offsets(handle)) < 2:
            found.blank.add(number)
    found.keys.sort()
    found.made.sort()
    return found


def _sum(handle) -> int:
    return records.checksum(gp.positions(handle, int(gp.offsets(handle)[-1])))


def digest(content: st.Content) -> bytes:
    """Of all that a drawing shows."""
    summed = hashlib.blake2b(digest_size=16)
    summed.update(content.sizes.tobytes() + content.types.tobytes())
    for side in (content.point, content.curve):
        for name in sorted(side):
            if name not in OURS:
                summed.update(name.encode())
                summed.update(np.ascontiguousarray(side[name]))
    return summed.digest()


def around(frames: Iterable[int], current: int) -> tuple[int, int] | None:
    """The two keys around a frame; on a key that and the next one, on the last the one before and that."""
    rising = sorted(frames)
    if len(rising) < 2 or current < rising[0]:
        return None
    k = max(index for index, frame in enumerate(rising) if frame <= current)
    if k == len(rising) - 1:
        # Behind the last key nothing is between.
        return (rising[k - 1], rising[k]) if current == rising[k] else None
    return rising[k], rising[k + 1]

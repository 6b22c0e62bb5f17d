"""In-betweens that Rototoon itself changes after it has drawn them: hidden lines are cut, strokes are fitted.

That is no change of the artist. So such drawings stay in-betweens: their marks and their checksums follow, and a later
Update In-betweens may draw them anew. It draws from the keys as they are then. A fitted key is as good as before, so the in-betweens can be fitted
again. A cut key has lost lines.

Where what is held is cut in another way on a later frame, that frame gets a generated copy of it. Between two keys with in-betweens such a copy is an in-between
too, whatever it was copied from: otherwise a cut copy would be a key from which others are drawn.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

import numpy as np

from ..blender import grease_pencil as gp
from ..blender import marks
from ..common.wording import counted
from . import keys as ks
from . import pairs, records


@dataclass
class Kept:
    """The in-betweens that stay what they are."""

    frames: dict[str, set[int]] = field(default_factory=dict)
    """By layer."""

    def among(self, changed: dict[str, set[int]]) -> int:
        """How many of the drawings that were changed, by layer, are in-betweens."""
        return sum(len(frames & self.frames.get(name, set())) for name, frames in changed.items())

    def said(self, changed: dict[str, set[int]]) -> str:
        """What that means for in-betweens from keys that are as good as before; empty without in-betweens."""
        count = self.among(changed)
        if not count:
            return ""
        them = "it" if count == 1 else "them"
        return f"{counted(count, 'in-between')} among them: do this again after Update In-betweens draws {them} anew"


def has_own_keys(ob, layers: Iterable) -> bool:
    """Whether one of the layers has in-betweens, which are drawn from the artist's keys. No array is read."""
    known = records.read(ob.data)
    return any(layer.name in known and known[layer.name].spans for layer in layers)


@contextmanager
def kept(ob) -> Iterator[Kept]:
    """Keeps in-betweens, and snapped drawings, what they are while Rototoon itself changes them."""
    known, there = records.read(ob.data), {}
    found = Kept()
    for layer in gp.every_layer(ob):
        record = known.get(layer.name)
        if record is not None and record.spans:
            found.frames[layer.name] = set(ks.frames_of(layer, record).made)
            there[layer.name] = set(gp.frame_numbers(layer))
    with marks.kept(ob):
        yield found
    for name, frames in found.frames.items():
        layer = gp.find_layer(ob, name)
        if layer is None:
            continue
        frames = frames | _new_in_betweens(layer, known[name], there[name])
        marks.note(ob.data, name, frames)
        drawings = gp.drawings(layer)
        for span in known[name].spans.values():
            for frame in frames & span.sums.keys() & drawings.keys():
                handle = drawings[frame][0]
                span.sums[frame] = records.checksum(gp.positions(handle, int(gp.offsets(handle)[-1])))
        _note_emptied(known[name], {frame for frame in frames if frame in drawings and ks.is_emptied(*drawings[frame])})
    records.write(ob.data, known)


def _note_emptied(record: records.Layer, frames: set[int]) -> None:
    """Notes in-betweens without strokes, which can bear no mark."""
    for first, span in record.spans.items():
        span.sums |= {frame: records.EMPTY for frame in frames if first < frame < span.last}


def _new_in_betweens(layer, record: records.Layer, there: set[int]) -> set[int]:
    """Makes in-betweens of the generated drawings that were added between recorded keys. `there` are the frames from before. Returns the new ones."""
    found = set()
    for frame, (handle, kind) in gp.drawings(layer).items():
        between = any(first < frame < span.last for first, span in record.spans.items())
        if frame in there or kind != gp.GENERATED or not (between or ks.is_tweened(handle, kind)):
            continue
        found.add(frame)
        if ks.is_tweened(handle, kind):
            continue
        count = len(gp.offsets(handle)) - 1
        # It shows what is held from the key before it. Decisions on that key are not its own.
        for name in (gp.NEXT, gp.BEFORE, gp.KEY):
            if gp.has(handle, name):
                gp.put(handle, name, np.zeros(count, np.int32))
        gp.put(handle, gp.SIDES, np.full(count, pairs.EARLIER, np.int32))
        gp.put(handle, gp.TWEENED, np.ones(count, bool))
    return found

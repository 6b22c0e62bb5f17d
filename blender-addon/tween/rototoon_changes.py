"""In-betweens that Rototoon itself changes after it has drawn them: hidden lines are cut, strokes are fitted.

That is no change of the artist. So such drawings stay in-betweens: their marks and their checksums follow, and a later
Update In-betweens may draw them anew. It draws from the keys as they are then. A fitted key is as good as before, so the in-betweens can be fitted
again. A cut key has lost lines.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

from ..blender import grease_pencil as gp
from ..blender import marks
from ..common.wording import counted
from . import keys as ks
from . import records


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
    known = records.read(ob.data)
    found = Kept()
    for layer in gp.every_layer(ob):
        record = known.get(layer.name)
        if record is not None and record.spans:
            found.frames[layer.name] = set(ks.frames_of(layer, record).made)
    with marks.kept(ob):
        yield found
    for name, frames in found.frames.items():
        layer = gp.find_layer(ob, name)
        if layer is None:
            continue
        marks.note(ob.data, name, frames)
        drawings = gp.drawings(layer)
        for span in known[name].spans.values():
            for frame in frames & span.sums.keys() & drawings.keys():
                handle = drawings[frame][0]
                span.sums[frame] = records.checksum(gp.positions(handle, int(gp.offsets(handle)[-1])))
    records.write(ob.data, known)

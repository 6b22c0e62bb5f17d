"""Traced strokes that Rototoon itself changes on one drawing: curves are fitted, hidden lines are cut.

That is no edit of the artist. So the marks by which *Edit on All Frames* tells an edit follow: what was not edited before is not edited afterwards. And traced
drawings stay traced: the next Trace Drawing or Carry Strokes draws them anew, whole and as polylines, as Update In-betweens does with in-betweens. The operators say so.

Why so: as drawings of the artist they would stop every later run. A film of which all drawings are fitted could not be traced again, nor cleared, and a
stroke that is hidden on a frame would end there for good.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field

import numpy as np

from ..blender import grease_pencil as gp
from ..blender import marks
from ..blender import strokes as st
from ..common.wording import counted
from . import aside, moved, records, spreading
from . import drawings as dr


def follow(before: st.Content, after: st.Content, source: np.ndarray, slots: marks.Slots) -> None:
    """Notes places and looks of the strokes `after`, where they were as noted `before`. `source` has for each stroke the index of the one that
    it comes from. `marks.remember` shall keep the `slots`."""
    if gp.LINE not in before.point or not len(after.sizes):
        return
    known = spreading.found(before, (), None, slots)
    still = np.repeat(~known.moved[source], after.sizes)
    after.point[gp.TRACKED] = np.where(still[:, None], after.point["position"], after.point[gp.TRACKED])
    after.set_strokes(gp.LOOK, np.where(known.same[source], marks.stroke_looks(after, slots.now), after.strokes(gp.LOOK)))


@dataclass
class Kept:
    """The traced drawings that stay what they are."""

    frames: dict[str, set[int]] = field(default_factory=dict)
    """By layer."""

    def said(self, changed: Mapping[str, set[int]]) -> str:
        """What that means for the drawings that were changed, by layer; empty if none is traced."""
        count = sum(len(frames & self.frames.get(name, set())) for name, frames in changed.items())
        if not count:
            return ""
        them = "it" if count == 1 else "them"
        return f"{counted(count, 'traced drawing')} among them: do this again after Trace Drawing or Carry Strokes draws {them} anew"


@contextmanager
def kept(ob, gone: Mapping[str, Mapping[int, set[int]]] | None = None) -> Iterator[Kept]:
    """Keeps traced drawings what they are while Rototoon itself changes them. A copy of what is held, which gets a frame because it is cut in another
    way there, is traced too: the next run holds the drawing again.

    `gone` are by layer and frame the numbers of strokes that Rototoon removes: they do not count as deleted by the artist.
    """
    names = [layer.name for layer in dr.layers(ob) if dr.is_lines(layer) and not aside.is_aside(ob, layer)]
    known = moved.read(ob, names)
    made = {layer.name: set(layer.made) for layer in dr.read(ob, names) if layer.made}
    there = {name: _sums(ob, name) for name in names}
    with aside.noted(ob, names):
        yield Kept(made)
    changed = False
    for name in names:
        record, now = known.setdefault(name, records.Layer()), _sums(ob, name)
        new = _new_copies(ob, name, now.keys() - there[name].keys()) if name in made else set()
        frames = {frame for frame in made.get(name, set()) & now.keys() if now[frame] != there[name][frame]} | new
        record.sums |= {frame: now[frame] for frame in frames}
        marks.note(ob.data, name, frames)
        record.marked |= frames
        left = {frame: numbers for frame, numbers in (gone or {}).get(name, {}).items() if frame in record.numbers}
        for frame, numbers in left.items():
            record.numbers[frame] = [number for number in record.numbers[frame] if number not in numbers]
        changed = changed or bool(frames or left)
    if changed:
        records.write(ob.data, known)


def _sums(ob, name: str) -> dict[int, int]:
    """Checksums of the drawings of a layer."""
    layer = gp.find_layer(ob, name)
    return {} if layer is None else moved.sums_of({frame: handle for frame, (handle, _) in gp.drawings(layer).items()})


def _new_copies(ob, name: str, frames: Iterable[int]) -> set[int]:
    """Makes traced drawings of the generated ones that a layer has on new frames. Returns these frames."""
    drawings = gp.drawings(gp.find_layer(ob, name))
    found = {frame for frame in frames if drawings[frame][1] == gp.GENERATED}
    for frame in found:
        handle = drawings[frame][0]
        gp.put(handle, gp.MADE, np.ones(len(gp.offsets(handle)) - 1, bool))
    return found

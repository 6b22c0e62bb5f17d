"""Marks for the generated drawings of files that a version without marks has saved (see `blender.marks`).

When such a file is opened, its in-betweens, traced drawings and snapped lines are marked as they are, if what that version noted says that they
are unchanged. So what an artist changes from then on counts in full. Snapped lines had no notes: all of them are marked, but for drawings on
which the artist has drawn too.
A file of this version costs no look at its drawings.
"""

from __future__ import annotations

from ..blender import grease_pencil as gp
from ..blender import guard, marks
from ..blender import strokes as st
from ..tween import keys as ks
from ..tween import records as tween_records
from . import drawings as dr
from . import records


def mark(ob) -> None:
    """Marks the drawings of an object, where they have no marks yet. Objects that may not be changed stay as they are."""
    if not gp.is_drawing(ob) or guard.refusal(ob):
        return
    _mark_in_betweens(ob.data)
    _mark_traced(ob.data)
    snapped = gp.find_layer(ob, ob.rototoon.snapped_layer)
    if snapped is not None:
        unmarked = {frame: handle for frame, (handle, kind) in gp.drawings(snapped).items() if kind == gp.GENERATED and not gp.has(handle, gp.MARK)}
        marks.note(ob.data, snapped.name, {frame for frame, handle in unmarked.items() if marks.all_made(handle)})


def _mark_in_betweens(data) -> None:
    kept = tween_records.read(data)
    for name, record in kept.items():
        spans = [span for span in record.spans.values() if not span.marked]
        layer = gp.find_layer_of(data, name)
        if not spans or layer is None:
            continue
        frames = {frame for span in spans for frame in span.sums}
        marks.note(data, name, frames & set(ks.frames_of(layer, record).made))
        for span in spans:
            span.marked = True
        # Nothing is written where nothing is new: a text that cannot be read stays.
        tween_records.write(data, kept)


def _mark_traced(data) -> None:
    kept = records.read(data)
    for name, record in kept.items():
        layer, unmarked = gp.find_layer_of(data, name), record.sums.keys() - record.marked
        if not unmarked or layer is None:
            continue
        with gp.copied(data) as copy:
            drawings = gp.drawings(gp.find_layer_of(copy, name))
            contents = {frame: st.read(drawings[frame][0]) for frame in unmarked & drawings.keys() if drawings[frame][1] == gp.GENERATED}
        same = {frame for frame, content in contents.items() if dr.sum_of(content) == record.sums[frame]}
        if same:
            marks.note(data, name, same)
            record.marked |= same
            records.write(data, kept)

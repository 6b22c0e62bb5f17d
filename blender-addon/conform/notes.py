"""The records that name drawings by frame, for the new frames: those of in-betweens, of traced lines, and of held drawings.

A checksum that was right before is right afterwards. One that was not, since the artist has changed the drawing, stays as it was, so that the change
still shows. The digest of a span of in-betweens stays: it knows the points and the frames of the keys, so where either is another one now, Update
In-betweens draws the span again.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ..blender import grease_pencil as gp
from ..blender import holds
from ..blender import strokes as st
from ..lines import records as line_records
from ..tween import records as tween_records
from . import looks, plan

Changes = Mapping[tuple[str, int, int], Mapping[str, np.ndarray]]


def follow(ob, made: plan.Plan, changes: Changes) -> None:
    """Writes the records of all layers."""
    lines, tween = line_records.read(ob.data), tween_records.read(ob.data)
    for layer in made.layers:
        if layer.lines is not None:
            lines[layer.name] = _lines(layer, changes)
        if layer.name in tween:
            tween[layer.name] = _tween(layer, changes)
        holds.forget(ob.data, layer.name)
        holds.note(ob.data, layer.name, layer.held, ())
    line_records.write(ob.data, lines)
    tween_records.write(ob.data, tween)


def _after(layer: plan.Layer, drawing: plan.Drawing, new: int, changes: Changes) -> st.Content:
    return looks.with_values(drawing.content, changes[layer.name, drawing.frame, new])


def _line_sum(content: st.Content) -> int:
    return line_records.checksum(content.point["position"], content.strokes(gp.TRACK), content.sizes)


def _span_sum(content: st.Content) -> int:
    return tween_records.checksum(content.point["position"])


def _lines(layer: plan.Layer, changes: Changes) -> line_records.Layer:
    old, new = layer.lines, line_records.Layer()
    # An end is a traced drawing without strokes: Trace Drawing may draw there again.
    new.sums = dict.fromkeys(layer.ends, line_records.checksum(np.zeros((0, 3)), np.zeros(0), np.zeros(0)))
    for drawing in layer.drawings:
        for target in drawing.targets:
            known = old.sums.get(drawing.frame)
            if known is not None:
                right = known == _line_sum(drawing.content)
                new.sums[target] = _line_sum(_after(layer, drawing, target, changes)) if right else known
            if drawing.frame in old.numbers:
                new.numbers[target] = old.numbers[drawing.frame]
            if drawing.frame in old.marked:
                new.marked.add(target)
    return new


def _tween(layer: plan.Layer, changes: Changes) -> tween_records.Layer:
    at = {drawing.frame: drawing for drawing in layer.drawings if drawing.targets}

    def summed(frame: int, known: int) -> int:
        drawing = at.get(frame)
        if drawing is None or _span_sum(drawing.content) != known:
            return known
        return _span_sum(_after(layer, drawing, drawing.targets[0], changes))

    spans = {}
    for first, ((begin, end), span) in layer.spans.items():
        sums = {at[frame].targets[0]: summed(frame, known) for frame, known in span.sums.items() if frame in at}
        ends = None if span.ends is None else (summed(first, span.ends[0]), summed(span.last, span.ends[1]))
        spans[begin] = replace(span, last=end, sums=sums, ends=ends)
    return tween_records.Layer(layer.next_track, spans)

"""Strokes in doubt that the artist has looked at and finds right.

What: the confidence of such a stroke on its frame is 1, so it is marked no more. When nothing on a traced drawing is in doubt any more, the drawing is
the artist's, as with every decision on a drawing: Trace Drawing and Carry Strokes leave it, and follow its strokes. A stroke of the artist that lies on
no line of the picture loses its mark.

Why so: a traced drawing is drawn anew by the next run, with the confidence that this run has. One with strokes that are still in doubt stays traced, since
all strokes of a drawing of the artist are beyond doubt.

Limits: of a drawing on which other strokes are in doubt, the next run asks again. So it does with strokes that lie on no line of the picture.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..blender import grease_pencil as gp
from ..blender import guard
from ..blender import strokes as st
from . import doubts
from . import drawings as dr


def shown(ob, frame: int) -> list[doubts.Place]:
    """The strokes in doubt on the drawings that a scene frame shows."""
    names = {layer.name: st.shown_frame(layer, frame) for layer in st.drawn_layers(ob, active=False)}
    return [place for place in doubts.places(ob) if names.get(place.layer) == place.frame]


def accept(ob, places: Sequence[doubts.Place]) -> set[tuple[str, int]]:
    """Says that strokes are right. Returns the drawings that are the artist's now, as layer and frame. Raises a `Problem` if a layer is closed."""
    by_drawing: dict[tuple[str, int], list[doubts.Place]] = {}
    for place in places:
        by_drawing.setdefault((place.layer, place.frame), []).append(place)
    guard.need_open(gp.find_layer(ob, name) for name in sorted({name for name, _ in by_drawing}))
    own = set()
    for (name, frame), accepted in by_drawing.items():
        layer = gp.find_layer(ob, name)
        gp.make_own(layer, [frame])
        handle, kind = gp.drawings(layer)[frame]
        which = [place.index for place in accepted]
        if kind != gp.GENERATED:
            off = gp.value(handle, gp.OFF_INK, len(gp.offsets(handle)) - 1)
            off[which] = False
            gp.put(handle, gp.OFF_INK, off)
        elif _accept_traced(handle, which):
            dr.make_the_artists(layer, [frame])
            own.add((name, frame))
    ob.data.update_tag()
    return own


def _accept_traced(handle, which: Sequence[int]) -> bool:
    """Gives strokes of a traced drawing the confidence 1. Returns whether no other stroke is in doubt."""
    starts = gp.offsets(handle)
    sure = gp.value(handle, gp.CONFIDENCE, int(starts[-1]))
    for i in which:
        sure[starts[i] : starts[i + 1]] = 1
    gp.put(handle, gp.CONFIDENCE, sure)
    return not np.any(doubts.verdicts(doubts.of_strokes(sure, starts)) != doubts.SURE)

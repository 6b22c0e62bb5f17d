"""Drawings with other values, and what the file has noted of their looks.

A stroke keeps a checksum of its look since it was generated, so that a change of the artist shows. Radii count in it. So where a radius grows with
the picture, the checksum follows if it was right before. It was made in one of several ways: by who generated the stroke, and in which version of
Blender.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import partial

import numpy as np

from ..blender import grease_pencil as gp
from ..blender import marks
from ..blender import strokes as st
from ..lines import drawings as dr


def with_values(content: st.Content, values: Mapping[str, np.ndarray]) -> st.Content:
    """The content with other values of some attributes."""
    point = {name: values.get(name, each) for name, each in content.point.items()}
    curve = {name: values.get(name, each) for name, each in content.curve.items()}
    return st.Content(content.sizes, content.types, point, curve, dict(content.kinds))


def followed(content: st.Content, values: Mapping[str, np.ndarray], slots: marks.Slots) -> np.ndarray:
    """The noted looks of a drawing's strokes where its attributes get other values. `slots` are the material slots of the object."""
    known = content.strokes(gp.LOOK)
    if not known.any():
        return known
    found, after = known.copy(), with_values(content, values)
    for way in _ways(content, slots):
        same = (known != 0) & (way(content) == known)
        found[same] = way(after)[same]
    return found


def _ways(content: st.Content, slots: marks.Slots) -> Iterator[Callable[[st.Content], np.ndarray]]:
    """How the looks may have been noted."""
    for by_id in (True, False):
        for names in slots.of(content):
            yield partial(marks.stroke_looks, names=names, by_id=by_id)
            yield partial(dr.painted_looks, names=names, by_id=by_id)
        yield partial(marks.numbered_looks, by_id=by_id)
    yield dr.look_sums
    yield dr.look_sums_without_fills

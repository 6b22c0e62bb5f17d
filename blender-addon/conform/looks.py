"""Drawings with other values, and what the file has noted of their looks.

A stroke keeps a checksum of its look since it was generated, so that a change of the artist shows. Radii count in it. So where a radius grows with
the picture, the checksum follows if it was right before. It was made in one of several ways: by who generated the stroke, and in which version of
Blender.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..blender import grease_pencil as gp
from ..blender import marks
from ..blender import strokes as st
from ..lines import drawings as dr

WAYS = (
    lambda content: marks.stroke_looks(content, True),
    lambda content: marks.stroke_looks(content, False),
    dr.look_sums,
)


def with_values(content: st.Content, values: Mapping[str, np.ndarray]) -> st.Content:
    """The content with other values of some attributes."""
    point = {name: values.get(name, each) for name, each in content.point.items()}
    curve = {name: values.get(name, each) for name, each in content.curve.items()}
    return st.Content(content.sizes, content.types, point, curve, dict(content.kinds))


def followed(content: st.Content, values: Mapping[str, np.ndarray]) -> np.ndarray:
    """The noted looks of a drawing's strokes where its attributes get other values."""
    known = content.strokes(gp.LOOK)
    if not known.any():
        return known
    found, after = known.copy(), with_values(content, values)
    for way in WAYS:
        same = (known != 0) & (way(content) == known)
        found[same] = way(after)[same]
    return found

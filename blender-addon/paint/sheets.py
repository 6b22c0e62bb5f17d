"""The drawings of the layer with paint.

A stroke is generated if painting made it and nobody has changed it since: place, number of points, or look. All other strokes are the
artist's. They are never changed but for their number and the kind of their frame, and each filled one tells a colour.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from ..blender import grease_pencil as gp
from ..blender import marks, stroke_lines
from ..blender import strokes as st
from ..common import polygons
from ..lines import drawings as dr
from ..lines import records
from . import shapes


@dataclass
class Sheet:
    """A drawing."""

    content: st.Content
    made: np.ndarray
    """For each stroke: whether it is generated."""
    kind: str
    """Keyframe type of its frame."""

    @property
    def own(self) -> np.ndarray:
        """The indices of the artist's strokes."""
        return np.flatnonzero(~self.made)

    @property
    def blank(self) -> bool:
        """Whether it is an empty drawing of the artist: there is no paint, and there will be none."""
        return not len(self.made) and self.kind != gp.GENERATED

    def sum(self) -> int:
        """Checksum of the artist's strokes."""
        own = st.chosen(self.content, self.own)
        looks = dr.look_sums(own) if len(own.sizes) else np.zeros(0, np.int32)
        return records.checksum(own.point["position"], looks, own.sizes) if len(own.sizes) else 0


def read(ob, name: str) -> dict[int, Sheet]:
    """The drawings of a layer by scene frame. Without the layer there are none."""
    with gp.copied(ob.data) as data:
        layer = gp.find_layer_of(data, name)
        slots = marks.Slots(ob.data)
        return {} if layer is None else {frame: of_drawing(*each, slots) for frame, each in gp.drawings(layer).items()}


def of_drawing(handle, kind: str, slots: marks.Slots) -> Sheet:
    """A drawing with a frame of this keyframe type. `slots` are the material slots of its object."""
    content = st.read(handle)
    return Sheet(content, made_of(content, slots), kind)


def made_of(content: st.Content, slots: marks.Slots) -> np.ndarray:
    """Which strokes are as painting made them."""
    made = content.strokes(gp.MADE).copy()
    if not made.any():
        return made
    tracked = content.point.get(gp.TRACKED)
    moved = np.ones(len(content.point["position"]), bool) if tracked is None else (tracked != content.point["position"]).any(1)
    changed = np.concatenate([[0], np.cumsum(moved)])
    starts = content.starts
    same = (changed[starts[1:]] == changed[starts[:-1]]) & content.strokes("cyclic")
    # A stroke that lost points has another sum: that of its look counts its points.
    return made & same & dr.has_painted_looks(content, slots)


@dataclass
class Shape:
    """A filled shape of a drawing, in footage pixels."""

    strokes: list[int]
    """Its strokes, as indices. Strokes with one fill are one shape, in which holes stay open."""
    loops: list[np.ndarray]
    """Their lines."""


def shapes_of(ob, content: st.Content, mapping, which: Iterable[int]) -> list[Shape]:
    """The filled shapes of some strokes, from back to front. Strokes without a fill, and those that cannot be read, are left out."""
    fills, fine = st.filled(ob, content), content.finite()
    lines, found = stroke_lines.lines(content), {}
    for i in which:
        if fills[i] and fine[i] and len(lines[i]) > 2:
            found.setdefault(int(fills[i]), []).append(int(i))
    return [Shape(own, [mapping.to_pixels(_open(lines[i])) for i in own]) for own in found.values()]


def _open(line: np.ndarray) -> np.ndarray:
    return line[:-1] if len(line) > 3 and np.array_equal(line[0], line[-1]) else line


def loops_of(shape: Shape) -> list[np.ndarray]:
    """The outlines of a shape: its own first, then those of its holes."""
    loops = [line[loop] for line in shape.loops for loop in shapes.parted(line)]
    return sorted(loops, key=lambda loop: -abs(polygons.area(loop)))

"""Reads the strokes of the contour layers as parts with keys and generated contours. Changes nothing.

A stroke is generated if tracking wrote it. All other strokes are the artist's keys. Two actions of the artist turn a generated
stroke into a key: setting its frame's keyframe type to anything but "Generated", and changing its number of points. So each
stroke is a key or not: parts may have keys on different frames, and a frame may have keys of some parts and generated strokes
of others.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..blender import grease_pencil as gp
from . import correspondence


@dataclass
class Stroke:
    """One stroke of a drawing."""

    layer: int
    """Index among the contour layers; the lowest layer is 0."""
    frame: int
    """Scene frame."""
    index: int
    """Index in the drawing."""
    span: slice
    """Its points in the drawing's arrays."""
    part: int
    """Number of its part; 0 if it has none."""
    made: bool
    """Whether it is generated, by the rules above."""
    cyclic: bool
    points: np.ndarray
    """(N, 3) in layer space, float32."""
    control: np.ndarray
    """Control numbers (N,), see `correspondence`."""
    where: np.ndarray | None = None
    """Fractional indices of the control points; `None` until the stroke is identified."""

    def control_points(self, closed: bool) -> np.ndarray:
        """The control points (count, 3) in layer space."""
        return correspondence.sample(self.points, self.where, closed)


@dataclass
class Drawing:
    """The arrays of one drawing."""

    starts: np.ndarray
    points: np.ndarray
    handle: object
    kind: str
    strokes: list[Stroke] = field(default_factory=list)
    _values: dict[str, np.ndarray] = field(default_factory=dict)

    def value(self, name: str) -> np.ndarray:
        """An attribute, or its defaults if it is missing. It is read once, and must not be changed."""
        if name not in self._values:
            count = len(self.points) if gp.TYPES[name][1] == "POINT" else len(self.starts) - 1
            self._values[name] = gp.value(self.handle, name, count)
            self._values[name].flags.writeable = False
        return self._values[name]


@dataclass
class Part:
    """A part with its strokes by scene frame."""

    number: int
    name: str
    closed: bool
    depth: float
    count: int
    extra: str = ""
    layer: int = 0
    keys: dict[int, Stroke] = field(default_factory=dict)
    made: dict[int, Stroke] = field(default_factory=dict)


@dataclass
class Contours:
    """The content of an object's contour layers."""

    drawings: dict[tuple[int, int], Drawing]
    """By layer index and scene frame."""
    parts: list[Part]
    """Parts in the order of the object's list."""
    loose: list[Stroke]
    """The artist's strokes without a part, sorted by frame, layer and drawing order."""
    layer_names: list[str]

    def part(self, number: int) -> Part | None:
        """The part with a number."""
        return next((part for part in self.parts if part.number == number), None)


def read(ob) -> Contours:
    """Reads the contour layers of a Grease Pencil object."""
    settings = ob.rototoon
    layers = gp.layers(ob, settings.contours_layer)
    parts = [Part(p.number, p.name, p.closed, p.depth, p.count, p.extra) for p in settings.parts]
    found = Contours({}, parts, [], [layer.name for layer in layers])
    for index, layer in enumerate(layers):
        for frame, (handle, kind) in gp.drawings(layer).items():
            found.drawings[index, frame] = read_drawing(handle, kind, index, frame)
    by_number = {part.number: part for part in parts}
    for place in sorted(found.drawings, key=lambda place: (place[1], place[0])):
        for stroke in found.drawings[place].strokes:
            _file(found, stroke, by_number.get(stroke.part))
    return found


def read_drawing(handle, kind: str, layer: int, frame: int) -> Drawing:
    """The strokes of one drawing."""
    starts = gp.offsets(handle)
    strokes, total = len(starts) - 1, int(starts[-1])
    drawing = Drawing(starts, gp.positions(handle, total), handle, kind)
    part, cyclic = drawing.value(gp.PART), drawing.value("cyclic")
    made, control = drawing.value(gp.MADE), drawing.value(gp.CONTROL)
    if kind != gp.GENERATED and made.all():
        made = np.zeros(strokes, bool)
    for i in range(strokes):
        span = slice(int(starts[i]), int(starts[i + 1]))
        points = drawing.points[span]
        stroke = Stroke(layer, frame, i, span, int(part[i]), bool(made[i]), bool(cyclic[i]), points, control[span])
        drawing.strokes.append(stroke)
    return drawing


def _file(found: Contours, stroke: Stroke, part: Part | None) -> None:
    """Adds a stroke to its part, if it is the part's first stroke on the frame."""
    if part is None or len(stroke.points) == 0:
        if not stroke.made and len(stroke.points):
            stroke.part = 0
            found.loose.append(stroke)
        return
    if stroke.made and len(stroke.points) != part.count:
        stroke.made = False
    if stroke.made:
        stroke.where = np.arange(part.count, dtype=np.float64)
        part.made.setdefault(stroke.frame, stroke)
        return
    stroke.where = where_of(stroke, part)
    if stroke.where is None or stroke.frame in part.keys:
        stroke.part = 0
        found.loose.append(stroke)
        return
    part.keys[stroke.frame] = stroke
    part.layer = stroke.layer


def where_of(stroke: Stroke, part: Part) -> np.ndarray | None:
    """Fractional indices of the part's control points on a stroke of the part; `None` if the stroke's control numbers do not
    give them."""
    if correspondence.is_identity(stroke.control, part.count):
        return np.arange(part.count, dtype=np.float64)
    where = correspondence.invert(stroke.control, part.count, part.closed)
    if where is None and len(stroke.points) == part.count:
        return np.arange(part.count, dtype=np.float64)
    return where

"""Reads the strokes of the contour layers as parts with keys and generated contours. Changes nothing.

A stroke is generated if tracking wrote it. All other strokes are the artist's keys. These actions of the artist turn a generated
stroke into a key: setting its frame's keyframe type to anything but "Generated", changing its number of points, copying it onto a frame
of the artist, and holding all its points beyond the keys of its part. So each stroke is a key or not: parts may have keys on different
frames, and a frame may have keys of some parts and generated strokes of others.

A copy of a generated stroke beside it, moved elsewhere, belongs to no part yet. Generated strokes of a part that has another number of points
since then are neither: the next Track draws them again.
"""

from __future__ import annotations

import functools
import time
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from rototoon.documents import by_frame

from ..blender import grease_pencil as gp
from ..blender import guard, own_attributes
from ..blender.errors import Changed
from ..common import jobs, kept
from . import correspondence, generated

SLICE = 0.03
"""Seconds of reading for which one copy of the drawings is made. A copy of 200 drawings takes 0.002 s."""


@dataclass(slots=True)
class Stroke:
    """One stroke of a drawing. A film has tens of thousands, so it has no dictionary."""

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


POINT_STYLE = ("radius", "opacity", "rotation", "vertex_color")
CURVE_STYLE = (
    "cyclic", "material_index", "fill_color", "fill_opacity", "fill_id", "hide_stroke", "softness", "aspect_ratio", "start_cap",
    "end_cap", "u_translation", "u_scale", "uv_rotation", "uv_translation", "uv_scale",
)  # fmt: skip
_IDENTITY = (gp.PART, "cyclic", gp.MADE, gp.CONTROL)
_OF_MADE = (gp.TRACKED, gp.PIN, gp.CENTER, gp.POINTS)


@dataclass
class Drawing:
    """The arrays of one drawing, read from a copy (see `grease_pencil.copied`)."""

    starts: np.ndarray
    points: np.ndarray
    handle: object
    """The drawing itself, to write."""
    kind: str
    names: frozenset[str]
    """The attributes that it has."""
    own: dict[str, own_attributes.Kind] = field(default_factory=dict)
    """Those of them that are the artist's own, if it has strokes of the artist."""
    strokes: list[Stroke] = field(default_factory=list)
    _values: dict[str, np.ndarray] = field(default_factory=dict)

    def has(self, name: str) -> bool:
        """Whether the drawing has an attribute."""
        return name in self.names

    def value(self, name: str) -> np.ndarray:
        """An attribute, or its defaults if it is missing. It is read once, and must not be changed."""
        if name not in self._values:
            self.take(self.handle, name)
        return self._values[name]

    def corrected(self) -> np.ndarray:
        """Which strokes have a pin, a corrected centre, or a point that is not where tracking put it."""
        if gp.TRACKED not in self.names:
            return np.zeros(len(self.strokes), bool)
        touched = self.value(gp.PIN) | (self.value(gp.TRACKED) != self.points).any(1)
        before = np.concatenate([[0], np.cumsum(touched)])
        return (before[self.starts[1:]] > before[self.starts[:-1]]) | (self.value(gp.CENTER)[:, 2] != 0)

    def take(self, handle, *names: str) -> None:
        """Reads attributes from `handle`, which is this drawing or a copy."""
        for name in names:
            kind, domain = self.own.get(name) or gp.TYPES[name]
            count = len(self.points) if domain == "POINT" else len(self.starts) - 1
            values = gp.get(handle, name, count) if name in self.names else None
            values = gp.blank(name, count, kind) if values is None else values
            values.flags.writeable = False
            self._values[name] = values


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
    depths: dict[int, float] = field(default_factory=dict)
    """By scene frame the depths that differ from `depth`, of a document that reshaping made."""

    def depth_at(self, frame: int) -> float:
        """The depth on a scene frame."""
        return self.depths.get(frame, self.depth)


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
    closed: frozenset[int] = frozenset()
    """Indices of locked layers. They are read, but never written, so strokes without a part do not count there."""
    stamp: int = 0
    """That of the object; 0 if it has none yet."""
    old: list[Stroke] = field(default_factory=list)
    """Generated strokes of parts that have another number of points since then."""

    @property
    def closed_names(self) -> tuple[str, ...]:
        """Names of the locked layers."""
        return tuple(self.layer_names[index] for index in sorted(self.closed))

    def own(self) -> dict[str, own_attributes.Kind]:
        """The artist's own attributes on all drawings."""
        return own_attributes.first_of(self.drawings[place].own for place in sorted(self.drawings, key=lambda place: (place[1], place[0])))

    def part(self, number: int) -> Part | None:
        """The part with a number."""
        return next((part for part in self.parts if part.number == number), None)


def read(ob, more: tuple[str, ...] = ()) -> Contours:
    """Reads the contour layers of a Grease Pencil object. `more` are attributes of generated strokes that will be needed too."""
    return jobs.drained(reading(ob, more))


def reading(ob, more: tuple[str, ...] = ()) -> Iterator[float]:
    """As `read`, in steps of about `SLICE` seconds, between which Blender may draw. Returns the contours.

    Nothing is kept in Blender from one step to the next. Raises `Changed` if a drawing came or went meanwhile.
    """
    settings = ob.rototoon
    layers = gp.layers(ob, settings.contours_layer)
    parts = [Part(p.number, p.name, p.closed, p.depth, p.count, p.extra, depths=_depths(p.extra, settings.frame_offset)) for p in settings.parts]
    closed = frozenset(index for index, layer in enumerate(layers) if guard.closed(layer, hidden=True))
    found = Contours({}, parts, [], [layer.name for layer in layers], closed, settings.stamp)
    yield from _reading_drawings(ob, found, more)
    _take_handles(ob, found)
    _take_pasted(found)
    by_number = {part.number: part for part in parts}
    for place in sorted(found.drawings, key=lambda place: (place[1], place[0])):
        for stroke in found.drawings[place].strokes:
            _file(found, stroke, by_number.get(stroke.part))
        yield 0.0
    _keep_beyond(found)
    _take_confidence(found)
    return found


def _depths(extra: str, offset: int) -> dict[int, float]:
    """A part's depths of single frames, by scene frame. Files may be damaged: what is no depth on a frame is left out."""
    given = kept.fields(kept.fields(extra).get("depths"))
    known = {frame: depth for frame, depth in given.items() if frame.removeprefix("-").isdecimal() and type(depth) in (int, float)}
    return {frame + offset: float(depth) for frame, depth in by_frame(known).items()}


def _reading_drawings(ob, found: Contours, more: tuple[str, ...]) -> Iterator[float]:
    places = [(index, frame) for index, name in enumerate(found.layer_names) for frame in gp.drawings(_layer(ob, name))]
    left = iter(places)
    place = next(left, None)
    while place is not None:
        until = time.perf_counter() + SLICE
        with gp.copied(ob.data) as data:
            copies = [gp.drawings(data.layers[name]) for name in found.layer_names if data.layers.get(name) is not None]
            if len(copies) < len(found.layer_names):
                raise Changed()
            while place is not None:
                index, frame = place
                if frame not in copies[index]:
                    raise Changed()
                found.drawings[place] = read_drawing(*copies[index][frame], index, frame, more, found.stamp)
                place = next(left, None)
                if time.perf_counter() > until:
                    break
        yield 0.0


def _take_confidence(found: Contours) -> None:
    """Reads the confidence of tracked contours beside new strokes, which are matched in a thread."""
    frames = {stroke.frame for stroke in found.loose}
    for (_, frame), drawing in found.drawings.items():
        if frame in frames and drawing.has(gp.CONFIDENCE):
            drawing.value(gp.CONFIDENCE)


def _layer(ob, name: str):
    layer = gp.find_layer(ob, name)
    if layer is None:
        raise Changed()
    return layer


def _take_handles(ob, found: Contours) -> None:
    """Gives each drawing the artist's drawing in place of the copy that it was read from."""
    own = [gp.drawings(_layer(ob, name)) for name in found.layer_names]
    if sum(map(len, own)) != len(found.drawings):
        raise Changed()
    for (index, frame), drawing in found.drawings.items():
        if frame not in own[index]:
            raise Changed()
        drawing.handle = own[index][frame][0]


def read_drawing(handle, kind: str, layer: int, frame: int, more: tuple[str, ...] = (), stamp: int = 0) -> Drawing:
    """The strokes of one drawing, with the attributes that are needed of them, and `more` if some are generated. Strokes of objects with
    another `stamp` have no part."""
    starts = gp.offsets(handle)
    drawing = Drawing(starts, gp.positions(handle, int(starts[-1])), handle, kind, gp.names(handle))
    drawing.take(handle, *_IDENTITY)
    if drawing.value(gp.MADE).any():
        drawing.take(handle, *_OF_MADE, *more)
    if not drawing.value(gp.MADE).all():
        drawing.own = own_attributes.of(handle)
        drawing.take(handle, *POINT_STYLE, *CURVE_STYLE, *drawing.own)
    drawing.take(handle, *drawing.names & {gp.BESIDE, gp.OWNER})
    part, cyclic = drawing.value(gp.PART), drawing.value("cyclic")
    made, control = drawing.value(gp.MADE), drawing.value(gp.CONTROL)
    if kind != gp.GENERATED:
        made = generated.by_marks(made, drawing.value(gp.BESIDE) if drawing.has(gp.BESIDE) else None, kind)
    if drawing.has(gp.OWNER):
        part = np.where(generated.foreign(drawing.value(gp.OWNER), stamp), 0, part)
    bounds = starts.tolist()
    rows = zip(bounds, bounds[1:], part.tolist(), made.tolist(), cyclic.tolist())
    for i, (start, end, number, is_made, is_closed) in enumerate(rows):
        span = slice(start, end)
        points = drawing.points[span]
        drawing.strokes.append(Stroke(layer, frame, i, span, number, is_made, is_closed, points, control[span]))
    return drawing


def _take_pasted(found: Contours) -> None:
    """Makes generated strokes without a part the artist's, as they were pasted from another layer or object.

    A layer without any stroke of a part has come as a whole, such as by joining objects. Its generated strokes stay generated.
    """
    ours = {layer for (layer, _), drawing in found.drawings.items() if any(stroke.part for stroke in drawing.strokes)}
    for (layer, _), drawing in found.drawings.items():
        for stroke in drawing.strokes if layer in ours else ():
            if stroke.made and not stroke.part:
                stroke.made = False


def _file(found: Contours, stroke: Stroke, part: Part | None) -> None:
    """Adds a stroke to its part, if it is the part's first stroke on the frame."""
    if part is None or len(stroke.points) == 0:
        if not stroke.made and len(stroke.points):
            _loosen(found, stroke)
        return
    if stroke.made and len(stroke.points) != part.count:
        if _is_old(found, stroke):
            found.old.append(stroke)
            return
        stroke.made = False
    if stroke.made:
        stroke.where = _whole(part.count)
        if part.made.setdefault(stroke.frame, stroke) is not stroke:
            _file_copy(found, stroke, part)
        return
    stroke.where = where_of(stroke, part)
    if stroke.where is None or stroke.frame in part.keys:
        _loosen(found, stroke)
        return
    part.keys[stroke.frame] = stroke
    part.layer = stroke.layer


def _is_old(found: Contours, stroke: Stroke) -> bool:
    """Whether a generated stroke has the number of points with which it was tracked, so that its part has changed and not the stroke."""
    points = int(found.drawings[stroke.layer, stroke.frame].value(gp.POINTS)[stroke.index])
    return points == len(stroke.points) if points else correspondence.is_identity(stroke.control, len(stroke.points))


def _file_copy(found: Contours, stroke: Stroke, part: Part) -> None:
    """Files a second generated stroke of a part on a frame. The one that is where tracking put it stays.

    The other one is the artist's if it was moved, or pasted from another frame: tracking writes one stroke of a part on a layer.
    """
    first = part.made[stroke.frame]
    kept, copy = (stroke, first) if _moved(found, first).any() and not _moved(found, stroke).any() else (first, stroke)
    part.made[stroke.frame] = kept
    if _moved(found, copy).any() or (copy.layer == kept.layer and not np.array_equal(copy.points, kept.points)):
        copy.made = False
        _loosen(found, copy)


def _moved(found: Contours, stroke: Stroke) -> np.ndarray:
    """Which points of a generated stroke are not where tracking put them."""
    return (found.drawings[stroke.layer, stroke.frame].value(gp.TRACKED)[stroke.span] != stroke.points).any(1)


def _keep_beyond(found: Contours) -> None:
    """Makes keys of generated strokes of which the artist holds all points, beyond the keys of their parts. Track would remove them."""
    for part in found.parts:
        if len(part.keys) < 2:
            continue
        first, last = min(part.keys), max(part.keys)
        for frame, stroke in list(part.made.items()):
            if first <= frame <= last:
                continue
            pinned = found.drawings[stroke.layer, frame].value(gp.PIN)[stroke.span]
            if (pinned | _moved(found, stroke)).all():
                stroke.made = False
                part.keys[frame] = part.made.pop(frame)


def _loosen(found: Contours, stroke: Stroke) -> None:
    stroke.part = 0
    if stroke.layer not in found.closed:
        found.loose.append(stroke)


@functools.lru_cache(maxsize=1024)
def _whole(count: int) -> np.ndarray:
    """0, 1, …, count - 1. All generated strokes of a part share it."""
    where = np.arange(count, dtype=np.float64)
    where.flags.writeable = False
    return where


def where_of(stroke: Stroke, part: Part) -> np.ndarray | None:
    """Fractional indices of the part's control points on a stroke of the part; `None` if the stroke's control numbers do not
    give them."""
    if correspondence.is_identity(stroke.control, part.count):
        return np.arange(part.count, dtype=np.float64)
    where = correspondence.invert(stroke.control, part.count, part.closed)
    if where is None and len(stroke.points) == part.count:
        return np.arange(part.count, dtype=np.float64)
    return where

"""The drawings of a layer with lines: the artist's, and traced ones.

A drawing is traced if its keyframe type is "Generated" and nobody has changed it since. Whatever the artist does there (redraw,
move, delete, another look, another number) makes it the artist's: it is never written again, and its strokes are followed. In-betweens are neither:
they stay as they are, and are not followed.
"""

from __future__ import annotations

import zlib
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from ..blender import grease_pencil as gp
from ..blender import marks
from ..blender import strokes as st
from . import moved, records


@dataclass
class Layer:
    """The drawings of a layer by scene frame."""

    name: str
    keys: dict[int, st.Content] = field(default_factory=dict)
    """The artist's drawings that have strokes."""
    blank: set[int] = field(default_factory=set)
    """The artist's drawings without strokes."""
    other: dict[int, st.Content] = field(default_factory=dict)
    """In-betweens. Only those that were asked for have their content."""
    made: dict[int, st.Content] = field(default_factory=dict)
    """Traced drawings. Only those that were asked for have their content."""
    sure: set[int] = field(default_factory=set)
    """Traced drawings with strokes of which none is in any doubt: they were traced for themselves."""
    edited: set[int] = field(default_factory=set)
    """Keys that were traced until the artist changed them."""
    highest: dict[int, int] = field(default_factory=dict)
    """The highest number on each frame."""

    @property
    def kept(self) -> set[int]:
        """The frames that tracing does not write."""
        return self.keys.keys() | self.blank | self.other.keys()

    def next_track(self, first: int, last: int) -> int:
        """The next free number, where traced drawings on the frames `first` to `last` are drawn anew."""
        stay = (number for frame, number in self.highest.items() if frame in self.kept or not first <= frame <= last)
        return max(stay, default=0) + 1

    def sums(self) -> dict[int, int]:
        """Checksums of the artist's drawings."""
        return {frame: sum_of(content) for frame, content in self.keys.items()}


EMPTY = st.Content(np.zeros(0, np.int32), np.zeros(0, np.int8))
"""In place of the content of a drawing that was not asked for."""


def layers(ob, active: bool = False) -> list:
    """The layers that may have lines, closed ones too: those without contours, snapped lines and paint. With `active`, only the active
    layer."""
    return [layer for layer in st.drawn_layers(ob, active) if may_have_lines(ob, layer)]


def may_have_lines(ob, layer) -> bool:
    """Whether a layer without contours may have lines: it has neither snapped lines nor paint."""
    return layer.name != ob.rototoon.snapped_layer and not st.is_paint(ob, layer)


def sum_of(content: st.Content) -> int:
    """Checksum of the content of a drawing."""
    return records.checksum(content.point["position"], content.strokes(gp.TRACK), content.sizes)


def read(ob, names: Iterable[str], wanted: Iterable[int] | None = ()) -> list[Layer]:
    """Sorts the drawings of layers. `wanted` are the frames of generated drawings whose content is needed, `None` for all."""
    kept = records.read(ob.data)
    wanted, slots = None if wanted is None else set(wanted), marks.Slots(ob.data)
    with gp.copied(ob.data) as data:
        return [_layer(name, gp.find_layer_of(data, name), kept.get(name, records.Layer()), wanted, slots) for name in names]


def _layer(name: str, layer, record: records.Layer, wanted: set[int] | None, slots: marks.Slots) -> Layer:
    found = Layer(name)
    if layer is None:
        return found

    def asked(content: st.Content, frame: int) -> st.Content:
        return content if wanted is None or frame in wanted else EMPTY

    drawings = gp.drawings(layer)
    sums = moved.sums_of({frame: handle for frame, (handle, _) in drawings.items()})
    record = moved.followed(record, sums)
    for frame, (handle, kind) in drawings.items():
        strokes = len(gp.offsets(handle)) - 1
        tracks = gp.value(handle, gp.TRACK, strokes)
        found.highest[frame] = int(tracks.max(initial=0))
        content = st.read(handle)
        if kind == gp.GENERATED and _is_traced(content, sums[frame], frame, record, slots):
            found.made[frame] = asked(content, frame)
            if strokes and (content.point.get(gp.CONFIDENCE, np.ones(0)) >= 1).all():
                found.sure.add(frame)
        elif kind == gp.GENERATED and strokes and content.strokes(gp.TWEENED).all():
            found.other[frame] = asked(content, frame)
        else:
            if strokes:
                found.keys[frame] = content
            else:
                found.blank.add(frame)
            if kind == gp.GENERATED:
                found.edited.add(frame)
    return found


def _is_traced(content: st.Content, total: int, frame: int, record: records.Layer, slots: marks.Slots) -> bool:
    """Whether a generated drawing with the checksum `total` is as tracing wrote it. Without a checksum, as on a renamed layer, the marks of the strokes tell."""
    known = record.sums.get(frame)
    if known is None:
        made = content.strokes(gp.MADE) & ~content.strokes(gp.TWEENED)
        traced = content.point.get(gp.TRACKED)
        if not (len(made) and made.all() and traced is not None and np.array_equal(traced, content.point["position"])):
            return False
    elif known != total:
        return False
    # An older version may have traced it anew: then the mark is of an earlier drawing, and the record says so.
    return not ((known is None or frame in record.marked) and marks.untouched(content, slots) is False)


def keep(ob, layer: Layer) -> None:
    """Makes traced drawings that the artist changed the artist's."""
    make_the_artists(gp.find_layer(ob, layer.name), layer.edited)


def make_the_artists(layer, frames: Iterable[int]) -> None:
    """Makes traced drawings of a layer the artist's."""
    frames = set(frames)
    handles = gp.drawings(layer) if frames else {}
    for frame in frames:
        handle = handles[frame][0]
        starts = gp.offsets(handle)
        gp.put(handle, gp.MADE, np.zeros(len(starts) - 1, bool))
        if gp.has(handle, gp.CONFIDENCE):
            # What the artist has drawn is beyond doubt.
            gp.put(handle, gp.CONFIDENCE, np.ones(int(starts[-1])))
    gp.set_keyframe_type(layer, dict.fromkeys(frames, gp.KEYFRAME))


def mark(content: st.Content, slots: marks.Slots) -> None:
    """Notes for each point where it is, on which stroke, and where on it, and the looks of strokes: an edit is measured from there. `slots` are the
    material slots of the drawing, which `marks.remember` shall keep."""
    mark_places(content)
    mark_looks(content, slots)


def mark_places(content: st.Content, chosen: np.ndarray | None = None, along: np.ndarray | None = None) -> None:
    """The same without looks, for the strokes `chosen`. `along` are those whose shares are noted. Both are all by default."""
    points, starts, tracks = content.point["position"], content.starts, content.strokes(gp.TRACK)
    for name in (gp.TRACKED, gp.LINE, gp.ALONG):
        if name not in content.point:
            content.kinds[name], content.point[name] = gp.TYPES[name][0], gp.blank(name, len(points))
    for i in range(len(content.sizes)) if chosen is None else np.flatnonzero(chosen):
        span = slice(starts[i], starts[i + 1])
        content.point[gp.TRACKED][span] = points[span]
        content.point[gp.LINE][span] = tracks[i]
        if along is None or along[i]:
            content.point[gp.ALONG][span] = shares(points[span])


def mark_looks(content: st.Content, slots: marks.Slots, chosen: np.ndarray | None = None) -> None:
    """The same for looks alone."""
    looks = marks.stroke_looks(content, slots.now)
    content.set_strokes(gp.LOOK, looks if chosen is None else np.where(chosen, looks, content.strokes(gp.LOOK)))


LOOKS = ("radius", "opacity", "vertex_color", "material_index", "fill_color", "fill_id", "hide_stroke")
"""What of a stroke counted as its look in files of versions without marks, and counts on painted ones."""
_FILLS = ("fill_id", "hide_stroke")
"""How Blender 5.1 and later keep fills. Earlier versions have these in the material."""


def painted_looks(content: st.Content, names: list[str], by_id: bool | None = None) -> np.ndarray:
    """Checksum of `LOOKS` of each stroke: int32. `names` and `by_id` are as for `marks.stroke_looks`."""
    return marks.with_materials(_painted_rests(content, gp.FILL_BY_ID if by_id is None else by_id), content, names)


def _painted_rests(content: st.Content, by_id: bool) -> np.ndarray:
    """Checksum of `LOOKS` of each stroke but for the material: uint32."""
    sides = [content.strokes(name) for name in ("fill_color", *(_FILLS if by_id else ()))]
    found = [zlib.crc32(b"".join(np.ascontiguousarray(each[i]).tobytes() for each in sides), total) for i, total in enumerate(_point_sums(content))]
    return np.array(found, np.uint32)


def _point_sums(content: st.Content) -> list[int]:
    """Checksum of those of `LOOKS` that are attributes of points, for each stroke."""
    starts, points = content.starts, len(content.point["position"])
    names = [name for name in LOOKS if gp.TYPES[name][1] == "POINT"]
    values = [content.point[name] if name in content.point else gp.blank(name, points) for name in names]
    found = []
    for a, b in zip(starts, starts[1:]):
        total = 0
        for each in values:
            total = zlib.crc32(np.ascontiguousarray(each[a:b]), total)
        found.append(total)
    return found


def look_sums(content: st.Content) -> np.ndarray:
    """Checksum of `LOOKS` of each stroke as earlier versions noted it, with the number of the material: int32."""
    of_strokes = [content.strokes(name) for name in LOOKS if gp.TYPES[name][1] == "CURVE" and name != "hide_stroke"]
    hidden = content.strokes("hide_stroke")
    found = np.zeros(len(content.sizes), np.int64)
    for i, total in enumerate(_point_sums(content)):
        for each in of_strokes:
            total = zlib.crc32(np.ascontiguousarray(each[i]), total)
        # Strokes whose line is shown have the sums of still earlier versions.
        found[i] = zlib.crc32(b"hidden", total) if hidden[i] else total
    return found.astype(np.uint32).view(np.int32)


def look_sums_without_fills(content: st.Content) -> np.ndarray:
    """The same as noted in a Blender that has fills in the material."""
    curve = {name: values for name, values in content.curve.items() if name not in _FILLS}
    return look_sums(st.Content(content.sizes, content.types, content.point, curve, content.kinds))


def has_looks(content: st.Content, slots: marks.Slots) -> np.ndarray:
    """For each stroke: whether its look is the one that was noted. What an earlier version noted counts as that version saw it."""
    known = content.strokes(gp.LOOK)
    older = (partial(marks.numbered_looks, by_id=gp.FILL_BY_ID), partial(marks.numbered_looks, by_id=not gp.FILL_BY_ID), look_sums)
    return _or_older(marks.has_looks(content, known, slots), content, known, older)


def has_painted_looks(content: st.Content, slots: marks.Slots) -> np.ndarray:
    """The same for painted strokes."""
    known = content.strokes(gp.LOOK)
    return _or_older(marks.has_looks(content, known, slots, _painted_rests), content, known, (look_sums, look_sums_without_fills))


def _or_older(same: np.ndarray, content: st.Content, known: np.ndarray, ways: Iterable[Callable[[st.Content], np.ndarray]]) -> np.ndarray:
    for way in ways:
        same = same if same.all() else same | (way(content) == known)
    return same


def shares(points: np.ndarray) -> np.ndarray:
    """The share of a line's length at each point."""
    steps = np.linalg.norm(np.diff(np.asarray(points, np.float64), axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    return along / along[-1] if along[-1] > 0 else np.linspace(0, 1, len(along))


def is_lines(layer) -> bool:
    """Whether a layer has traced drawings. Reads no array."""
    return any(gp.has(handle, gp.LINE) for handle in gp.handles(layer, gp.GENERATED))

"""The one place that knows Blender's Grease Pencil API (version 3: Blender 4.5 to 5.2).

A drawing is a set of strokes (Blender calls them curves) whose points lie in one flat array; the stroke `i` owns the
points `offsets[i]` to `offsets[i + 1]`. Values live in attributes of the POINT or CURVE domain. All values go in and
out as whole NumPy arrays: point by point, the Python API is a thousand times slower.

Three rules keep this safe: a frame is not held across `frames.new` (it dangles; the drawing stays valid), a stroke is
not held at all, and a new attribute is filled for all strokes, since Blender's default (0) means invisible for opacity.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import bpy
import numpy as np

GENERATED = "GENERATED"
"""Keyframe type of the frames that hold nothing of the artist's."""
KEYFRAME = "KEYFRAME"
"""Keyframe type of the artist's frames."""

PART = "rototoon_part"
"""Which part a stroke belongs to; 0 for a stroke that was never identified."""
MADE = "rototoon_generated"
"""Whether a stroke was written by tracking or snapping."""
CONTROL = "rototoon_control"
"""For each drawn point, which control point of the part it is; fractions lie between two control points."""
TRACKED = "rototoon_tracked"
"""Where tracking put a point: what differs from it was moved by the artist."""
PIN = "rototoon_pin"
"""Whether the artist fixed a point of a generated stroke."""
CENTER = "rototoon_center"
"""The corrected centre of a generated stroke in footage pixels (x, y, 1), or (0, 0, 0)."""
CONFIDENCE = "rototoon_confidence"
"""How sure a tracked point is, 0 to 1."""
SEGMENT = "rototoon_segment"
"""For each point of a snapped stroke, the segment between control points that it belongs to."""

STROKE = "rototoon_stroke"
"""Which stroke of its drawing a cut stroke is a part of; 0 for a stroke that was never cut."""
INTERVAL = "rototoon_interval"
"""From which parameter of that stroke to which a part reaches; both 0 for a whole stroke. Whole numbers are its points, or
the joints of its pieces where it is a curve."""

KEY_POINT = "rototoon_key_point"
"""Which key point of the skeleton a line across a limb tells, from 1; 0 for none."""

TRACK = "rototoon_track"
"""Which stroke of the whole film a stroke is: the same number on the keys of a layer and on the in-betweens; 0 for none."""
TWEENED = "rototoon_tweened"
"""Whether a stroke was drawn between keys."""
NEXT = "rototoon_next"
"""What the artist decided of a stroke and the next key: the number of the pair that it is in, -1 that it has no counterpart
there, 0 nothing."""
BEFORE = "rototoon_before"
"""The same of the key before: a pair is a stroke whose `NEXT` is the `BEFORE` of one on the next key."""

TYPES = {
    KEY_POINT: ("INT", "CURVE"),
    TRACK: ("INT", "CURVE"),
    TWEENED: ("BOOLEAN", "CURVE"),
    NEXT: ("INT", "CURVE"),
    BEFORE: ("INT", "CURVE"),
    "fill_opacity": ("FLOAT", "CURVE"),
    PART: ("INT", "CURVE"),
    MADE: ("BOOLEAN", "CURVE"),
    CENTER: ("FLOAT_VECTOR", "CURVE"),
    CONTROL: ("FLOAT", "POINT"),
    TRACKED: ("FLOAT_VECTOR", "POINT"),
    PIN: ("BOOLEAN", "POINT"),
    CONFIDENCE: ("FLOAT", "POINT"),
    SEGMENT: ("INT", "POINT"),
    "radius": ("FLOAT", "POINT"),
    "opacity": ("FLOAT", "POINT"),
    "rotation": ("FLOAT", "POINT"),
    "vertex_color": ("FLOAT_COLOR", "POINT"),
    "cyclic": ("BOOLEAN", "CURVE"),
    "material_index": ("INT", "CURVE"),
    "fill_color": ("FLOAT_COLOR", "CURVE"),
    "fill_id": ("INT", "CURVE"),
    "softness": ("FLOAT", "CURVE"),
    STROKE: ("INT", "CURVE"),
    INTERVAL: ("FLOAT2", "CURVE"),
    "nurbs_order": ("INT8", "CURVE"),
    "knots_mode": ("INT8", "CURVE"),
    "resolution": ("INT", "CURVE"),
}
"""Data type and domain of each attribute that is ever created here."""

DEFAULTS = {"radius": 0.01, "opacity": 1.0, "fill_opacity": 1.0, CONFIDENCE: 1.0, "nurbs_order": 4, "resolution": 12}
"""What a missing attribute means to Blender, where it is not 0."""

FILL_BY_ID = bpy.app.version >= (5, 1, 0)
"""Since Blender 5.1 a stroke is filled if its `fill_id` is not 0; before, if its material shows a fill."""

# Property name, NumPy type and width of an attribute's data, by data type.
_LAYOUT = {
    "FLOAT": ("value", np.float32, 1),
    "INT": ("value", np.int32, 1),
    "BOOLEAN": ("value", np.bool_, 1),
    "INT8": ("value", np.int8, 1),
    "FLOAT_VECTOR": ("vector", np.float32, 3),
    "FLOAT2": ("vector", np.float32, 2),
    "FLOAT_COLOR": ("color", np.float32, 4),
    "BYTE_COLOR": ("color", np.float32, 4),
    "QUATERNION": ("value", np.float32, 4),
}


def datablocks() -> bpy.types.bpy_prop_collection:
    """All Grease Pencil data of the file."""
    name = "grease_pencils_v3" if hasattr(bpy.data, "grease_pencils_v3") else "grease_pencils"
    return getattr(bpy.data, name)


def is_drawing(ob: bpy.types.Object | None) -> bool:
    """Whether an object is a Grease Pencil object."""
    return ob is not None and ob.type == "GREASEPENCIL"


def layers(ob: bpy.types.Object, name: str) -> list[bpy.types.bpy_struct]:
    """The layers called `name`, or `name` followed by a dot or a space and more, lowest first."""
    return [layer for layer in ob.data.layers if layer.name == name or layer.name.startswith((name + ".", name + " "))]


def layer(ob: bpy.types.Object, name: str) -> bpy.types.bpy_struct:
    """The layer called `name`, made on top if there is none; unlit, since in a scene without lamps ink would be black."""
    found = ob.data.layers.get(name)
    if found is None:
        found = ob.data.layers.new(name)
        found.use_lights = False
    return found


def find_layer(ob: bpy.types.Object, name: str) -> bpy.types.bpy_struct | None:
    """The layer called `name`; `None` if there is none."""
    return ob.data.layers.get(name)


def every_layer(ob: bpy.types.Object) -> list[bpy.types.bpy_struct]:
    """All layers, lowest first."""
    return list(ob.data.layers)


def frame_numbers(layer: bpy.types.bpy_struct, selected: bool = False) -> list[int]:
    """Frames of a layer in time order; with `selected`, those that are selected."""
    return [frame.frame_number for frame in layer.frames if frame.select or not selected]


def drawings(layer: bpy.types.bpy_struct) -> dict[int, tuple[bpy.types.bpy_struct, str]]:
    """Drawing and keyframe type by frame number, in time order."""
    return {frame.frame_number: (frame.drawing, frame.keyframe_type) for frame in layer.frames}


def set_keyframe_type(layer: bpy.types.bpy_struct, types: Mapping[int, str]) -> None:
    """Sets the keyframe type of the frames in `types`."""
    for frame in layer.frames:
        kind = types.get(frame.frame_number)
        if kind is not None and frame.keyframe_type != kind:
            frame.keyframe_type = kind


def make_frames(layer: bpy.types.bpy_struct, numbers: Iterable[int], kind: str) -> None:
    """Makes empty frames of a keyframe type where there is none yet."""
    have = {frame.frame_number for frame in layer.frames}
    for number in numbers:
        if number not in have:
            layer.frames.new(number).keyframe_type = kind


def remove_frames(layer: bpy.types.bpy_struct, numbers: Iterable[int]) -> None:
    """Removes frames."""
    for number in numbers:
        layer.frames.remove(number)


def copy_frame(layer: bpy.types.bpy_struct, source: int, number: int) -> None:
    """Copies the drawing on frame `source` to frame `number`, with everything that Blender knows of its strokes."""
    layer.frames.copy(source, number)


def offsets(drawing: bpy.types.bpy_struct) -> np.ndarray:
    """Where each stroke's points begin, and the number of points at the end: int32 (strokes + 1)."""
    position = drawing.attributes.get("position")
    if position is None or not len(position.data):
        # Of an empty drawing Blender claims one offset and refuses to hand it out.
        return np.zeros(1, np.int32)
    found = np.empty(len(drawing.curve_offsets), np.int32)
    drawing.curve_offsets.foreach_get("value", found)
    return found


def has(drawing: bpy.types.bpy_struct, name: str) -> bool:
    """Whether a drawing has an attribute."""
    return drawing.attributes.get(name) is not None


def get(drawing: bpy.types.bpy_struct, name: str, count: int) -> np.ndarray | None:
    """The values of an attribute, `count` rows; `None` where the drawing has no such attribute (of that length)."""
    attribute = drawing.attributes.get(name)
    if attribute is None or attribute.data_type not in _LAYOUT or len(attribute.data) != count:
        return None
    key, kind, width = _LAYOUT[attribute.data_type]
    values = np.empty(count * width, kind)
    attribute.data.foreach_get(key, values)
    return values if width == 1 else values.reshape(count, width)


def value(drawing: bpy.types.bpy_struct, name: str, count: int) -> np.ndarray:
    """As `get`, with what a missing attribute means in its place."""
    found = get(drawing, name, count)
    return blank(name, count) if found is None else found


def blank(name: str, count: int) -> np.ndarray:
    """`count` rows of what a missing attribute means."""
    _, kind, width = _LAYOUT[TYPES[name][0]]
    return np.full(count if width == 1 else (count, width), DEFAULTS.get(name, 0), kind)


def make(drawing: bpy.types.bpy_struct, name: str, kind: str, where: str) -> bpy.types.bpy_struct:
    """A new attribute of a drawing."""
    if name != "nurbs_order":
        return drawing.attributes.new(name, kind, where)
    # Blender 4.5 writes beyond its end when it makes this one by its name; renaming is safe.
    drawing.attributes.new("rototoon_order", kind, where).name = name
    return drawing.attributes[name]


def put(drawing: bpy.types.bpy_struct, name: str, values: np.ndarray) -> None:
    """Sets all values of an attribute, which is made if need be."""
    attribute = drawing.attributes.get(name)
    if attribute is None:
        attribute = make(drawing, name, *TYPES[name])
    key, kind, _ = _LAYOUT[attribute.data_type]
    attribute.data.foreach_set(key, np.ascontiguousarray(values, kind).ravel())


def points_changed(drawing: bpy.types.bpy_struct) -> None:
    """Tells Blender that points have moved."""
    drawing.tag_positions_changed()


def positions(drawing: bpy.types.bpy_struct, count: int) -> np.ndarray:
    """All points in layer space: float32 (points, 3)."""
    found = get(drawing, "position", count)
    return np.zeros((count, 3), np.float32) if found is None else found


def domain(drawing: bpy.types.bpy_struct, name: str) -> str:
    """POINT or CURVE."""
    return TYPES[name][1] if name in TYPES else drawing.attributes[name].domain


@dataclass
class Rows:
    """Strokes to write into one drawing: their sizes and the attributes by name, rows in the order of the strokes."""

    sizes: np.ndarray
    values: dict[str, np.ndarray] = field(default_factory=dict)


def replace_made(drawing: bpy.types.bpy_struct, rows: Rows) -> None:
    """Puts `rows` in the place of all generated strokes; the artist's strokes stay as they are, below them.

    A drawing that holds just these rows already is not touched.
    """
    starts = offsets(drawing)
    strokes, count = len(starts) - 1, len(rows.sizes)
    made = value(drawing, MADE, strokes)
    first = strokes - count
    fits = made.sum() == count and made[first:].all() and np.array_equal(np.diff(starts)[first:], rows.sizes)
    if fits and _holds(drawing, rows, first, starts):
        return
    if not fits:
        if made.any():
            drawing.remove_strokes(indices=np.flatnonzero(made).tolist())
        if len(rows.sizes):
            drawing.add_strokes(rows.sizes.tolist())
    _write_tail(drawing, rows)


def _holds(drawing: bpy.types.bpy_struct, rows: Rows, first: int, starts: np.ndarray) -> bool:
    """Whether the strokes from `first` on have the values of `rows`."""
    for name, values in rows.values.items():
        curve = name != "position" and domain(drawing, name) == "CURVE"
        found = get(drawing, name, len(starts) - 1 if curve else int(starts[-1]))
        if found is None:
            return False
        found = found[first if curve else starts[first] :]
        if not np.array_equal(found, np.asarray(values).astype(found.dtype)):
            return False
    return True


def append(drawing: bpy.types.bpy_struct, rows: Rows) -> None:
    """Adds strokes behind those that are there."""
    if len(rows.sizes):
        drawing.add_strokes(rows.sizes.tolist())
    _write_tail(drawing, rows)


def _write_tail(drawing: bpy.types.bpy_struct, rows: Rows) -> None:
    """Sets the attributes of the drawing's last strokes, and defaults where the new strokes have no value."""
    starts = offsets(drawing)
    strokes, points = len(starts) - 1, int(starts[-1])
    if not len(rows.sizes):
        drawing.tag_positions_changed()
        return
    for name, values in rows.values.items():
        total = points if name == "position" or domain(drawing, name) == "POINT" else strokes
        if len(values) < total:
            head = positions(drawing, points) if name == "position" else value(drawing, name, total)
            head[total - len(values) :] = values
            values = head
        put(drawing, name, values)
    for name in DEFAULTS:
        if TYPES[name][1] == "POINT" and name not in rows.values and drawing.attributes.get(name) is not None:
            values = value(drawing, name, points)
            values[points - int(rows.sizes.sum()) :] = DEFAULTS[name]
            put(drawing, name, values)
    drawing.tag_positions_changed()


def remove_strokes(drawing: bpy.types.bpy_struct, indices: list[int]) -> None:
    """Removes strokes."""
    drawing.remove_strokes(indices=indices)


def copy_strokes(source: bpy.types.bpy_struct, indices: list[int], target: bpy.types.bpy_struct) -> None:
    """Adds the strokes `indices` of a drawing to another one, with all attributes that both can hold."""
    starts = offsets(source)
    sizes = np.diff(starts)[indices]
    points = np.concatenate([np.arange(starts[i], starts[i + 1]) for i in indices])
    rows = Rows(sizes)
    for attribute in list(source.attributes):
        name = attribute.name
        if name.startswith(".") or name == "curve_type" or attribute.data_type not in _LAYOUT:
            continue
        total = int(starts[-1]) if attribute.domain == "POINT" else len(starts) - 1
        values = get(source, name, total)
        if values is None:
            continue
        if name != "position" and target.attributes.get(name) is None:
            make(target, name, attribute.data_type, attribute.domain)
        rows.values[name] = values[points if attribute.domain == "POINT" else indices]
    append(target, rows)


def selected_points(drawing: bpy.types.bpy_struct) -> np.ndarray:
    """Which points are selected in edit mode; all where Blender has no selection stored, as it does itself."""
    starts = offsets(drawing)
    attribute = drawing.attributes.get(".selection")
    if attribute is None:
        return np.ones(int(starts[-1]), np.bool_)
    if attribute.domain == "CURVE":
        return np.repeat(get(drawing, ".selection", len(starts) - 1), np.diff(starts))
    return get(drawing, ".selection", int(starts[-1]))


def selected_strokes(drawing: bpy.types.bpy_struct) -> np.ndarray:
    """Which strokes have a selected point in edit mode; none where Blender has no selection stored."""
    starts = offsets(drawing)
    attribute = drawing.attributes.get(".selection")
    if attribute is None:
        return np.zeros(len(starts) - 1, bool)
    values = np.zeros(len(attribute.data), bool)
    attribute.data.foreach_get("value", values)
    if len(values) == len(starts) - 1 and attribute.domain == "CURVE":
        return values
    return np.array([values[a:b].any() for a, b in zip(starts, starts[1:])], bool)


def new_object(name: str, collection: bpy.types.Collection) -> bpy.types.Object:
    """A Grease Pencil object with a black ink material, linked to `collection`."""
    data = datablocks().new(name)
    ob = bpy.data.objects.new(name, data)
    collection.objects.link(ob)
    material = bpy.data.materials.get("Rototoon Ink")
    if material is None:
        material = bpy.data.materials.new("Rototoon Ink")
        bpy.data.materials.create_gpencil_data(material)
        material.grease_pencil.color = (0.9, 0.1, 0.35, 1.0)
    data.materials.append(material)
    return ob

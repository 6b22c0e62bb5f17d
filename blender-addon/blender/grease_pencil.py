"""Blender's Grease Pencil API (version 3, Blender 4.5 to 5.2): layers, frames, drawings and their attributes.

A drawing is a set of strokes, which Blender calls curves. The points of all strokes are in one flat array: stroke `i` has the
points `offsets[i]` to `offsets[i + 1]`. Values are in attributes of the POINT or CURVE domain. All values are read and written
as complete NumPy arrays, since the Python API is a thousand times slower point by point.

Four rules keep this safe. No reference to a frame is kept across `frames.new`, which makes it dangle; the drawing stays valid. No
reference to a stroke is kept. A new attribute is set for all strokes, since Blender's default is 0, which makes opacity invisible. Many drawings are
read from a copy (`copied`), since undo would remember them once more otherwise.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager

import bpy
import numpy as np

GENERATED = "GENERATED"
"""Keyframe type of frames on which nothing is the artist's."""
KEYFRAME = "KEYFRAME"
"""Keyframe type of the artist's frames."""

PART = "rototoon_part"
"""Number of the part of a stroke; 0 for a stroke without a part."""
MADE = "rototoon_generated"
"""Whether tracking, snapping or tracing wrote the stroke."""
BESIDE = "rototoon_beside"
"""Whether a tracked stroke was written on a frame of the artist, beside the artist's strokes. See `capture.generated`."""
OWNER = "rototoon_owner"
"""The object to whose parts a contour belongs, by the object's `stamp`; 0 where that is not known."""
POINTS = "rototoon_points"
"""Number of points of a stroke when it was tracked; 0 where that is not known."""
CONTROL = "rototoon_control"
"""For each drawn point the index of its control point; fractions are between two control points."""
TRACKED = "rototoon_tracked"
"""Where tracking or tracing put a point. If the point is elsewhere, the artist moved it."""
PIN = "rototoon_pin"
"""Whether the artist fixed a point of a generated stroke."""
CENTER = "rototoon_center"
"""The corrected centre of a generated stroke in footage pixels (x, y, 1), or (0, 0, 0)."""
CONFIDENCE = "rototoon_confidence"
"""Confidence of a tracked point, 0 to 1."""
SEGMENT = "rototoon_segment"
"""For each point of a snapped stroke the index of its segment between control points."""

STROKE = "rototoon_stroke"
"""Number of the stroke of which a cut stroke is a part; 0 for a stroke that was never cut."""
INTERVAL = "rototoon_interval"
"""Parameters of that stroke at the start and the end of the part; both 0 for a complete stroke. Whole numbers are the stroke's
points, or the joints of a curve's pieces."""

KEY_POINT = "rototoon_key_point"
"""Number of the skeleton's key point that a line across a limb marks, from 1; 0 for none."""

CLICK = "rototoon_click"
"""Where Paint Bucket was clicked for a filled stroke, in footage pixels (x, y, 1), or (0, 0, 0)."""

TRACK = "rototoon_track"
"""Number that a stroke keeps on all keys, in-betweens and traced drawings of a layer; 0 for none."""
LINE = "rototoon_line"
"""For each point the number of the stroke that it was on when the drawing was traced; 0 for a point that was drawn since."""
LOOK = "rototoon_look"
"""Checksum of a stroke's look when the drawing was traced or tracked."""
MARK = "rototoon_mark"
"""Checksum of the whole drawing when it was generated, the same on all its strokes; 0 for none. See `marks`."""
ALONG = "rototoon_along"
"""For each point its share of that stroke's length, 0 to 1."""
FIELDS = "rototoon_fields"
"""Number of the further fields that the stroke has in a document, such as its peg; 0 for none. The object keeps the fields."""
TWEENED = "rototoon_tweened"
"""Whether the stroke is an in-between."""
NEXT = "rototoon_next"
"""The artist's decision on a stroke's counterpart on the next key: the number of the pair; -1 - n for no counterpart on the key with the number n;
-1 for no counterpart on any key, as earlier versions wrote it; 0 if there is no decision."""
BEFORE = "rototoon_before"
"""The same for the key before. Two strokes are a pair if the `NEXT` of one is the `BEFORE` of the other on the next key."""
KEY = "rototoon_key"
"""The number of a key, the same on all its strokes, where strokes of a neighbour have no counterpart on it; 0 for none, and on strokes drawn since."""
SIDES = "rototoon_sides"
"""On which of its two keys a stroke of an in-between has a counterpart of its number: 1 for the earlier one, 2 for the later one, added; 0 for a
stroke that was drawn since. A breakdown that was an in-between keeps it."""
OFF_INK = "rototoon_off_ink"
"""Whether a stroke of the artist lies for the most part off the lines of its picture, as where the picture was drawn anew."""

TYPES = {
    KEY_POINT: ("INT", "CURVE"),
    CLICK: ("FLOAT_VECTOR", "CURVE"),
    TRACK: ("INT", "CURVE"),
    LINE: ("INT", "POINT"),
    LOOK: ("INT", "CURVE"),
    MARK: ("INT", "CURVE"),
    ALONG: ("FLOAT", "POINT"),
    FIELDS: ("INT", "CURVE"),
    TWEENED: ("BOOLEAN", "CURVE"),
    NEXT: ("INT", "CURVE"),
    BEFORE: ("INT", "CURVE"),
    KEY: ("INT", "CURVE"),
    SIDES: ("INT", "CURVE"),
    OFF_INK: ("BOOLEAN", "CURVE"),
    "fill_opacity": ("FLOAT", "CURVE"),
    PART: ("INT", "CURVE"),
    MADE: ("BOOLEAN", "CURVE"),
    BESIDE: ("BOOLEAN", "CURVE"),
    OWNER: ("INT", "CURVE"),
    POINTS: ("INT", "CURVE"),
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
    "hide_stroke": ("BOOLEAN", "CURVE"),
    "softness": ("FLOAT", "CURVE"),
    "aspect_ratio": ("FLOAT", "CURVE"),
    "start_cap": ("INT8", "CURVE"),
    "end_cap": ("INT8", "CURVE"),
    "u_translation": ("FLOAT", "CURVE"),
    "u_scale": ("FLOAT", "CURVE"),
    "uv_rotation": ("FLOAT", "CURVE"),
    "uv_translation": ("FLOAT2", "CURVE"),
    "uv_scale": ("FLOAT2", "CURVE"),
    STROKE: ("INT", "CURVE"),
    INTERVAL: ("FLOAT2", "CURVE"),
    "nurbs_order": ("INT8", "CURVE"),
    "knots_mode": ("INT8", "CURVE"),
    "resolution": ("INT", "CURVE"),
}
"""Data type and domain of each attribute that the add-on creates."""

DEFAULTS = {
    "radius": 0.01, "opacity": 1.0, "fill_opacity": 1.0, CONFIDENCE: 1.0, "nurbs_order": 4, "resolution": 12,
    "aspect_ratio": 1.0, "u_scale": 1.0, "uv_scale": 1.0,
}  # fmt: skip
"""The value that Blender uses if the attribute is missing, where it is not 0."""

FILL_BASE = 1_000_000
"""Added to the number of a part or stroke for its `fill_id`, so that it differs from those of strokes that the artist filled."""
FILL_BY_ID = bpy.app.version >= (5, 1, 0)
"""Whether a stroke is filled by its `fill_id` and hides its line by `hide_stroke` (Blender 5.1 and later). Before, its material
decides both."""

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
    """The layers called `name`, or whose name begins with `name` and a dot or space; the lowest first."""
    return [layer for layer in ob.data.layers if is_named(layer.name, name)]


def is_named(layer: str, name: str) -> bool:
    """Whether a layer of this name is one of the layers called `name`."""
    return layer == name or layer.startswith((name + ".", name + " "))


def layer(ob: bpy.types.Object, name: str) -> bpy.types.bpy_struct:
    """The layer called `name`. If there is none, it is made on top, without lights: in a scene without lamps, lit ink is
    black."""
    found = ob.data.layers.get(name)
    if found is None:
        found = new_layer(ob, name)
        found.use_lights = False
    return found


def new_layer(ob: bpy.types.Object, name: str) -> bpy.types.bpy_struct:
    """A new layer. The active layer stays active, if there is one."""
    return ob.data.layers.new(name, set_active=ob.data.layers.active is None)


def remove_layer(ob: bpy.types.Object, layer: bpy.types.bpy_struct) -> None:
    """Removes a layer with its drawings."""
    ob.data.layers.remove(layer)


def find_layer(ob: bpy.types.Object, name: str) -> bpy.types.bpy_struct | None:
    """The layer called `name`; `None` if there is none."""
    return ob.data.layers.get(name)


def find_layer_of(data: bpy.types.ID, name: str) -> bpy.types.bpy_struct | None:
    """The layer called `name` of Grease Pencil data; `None` if there is none."""
    return data.layers.get(name)


def active_layer(ob: bpy.types.Object) -> bpy.types.bpy_struct | None:
    """The layer on which the artist draws."""
    return ob.data.layers.active


def activate(ob: bpy.types.Object, layer: bpy.types.bpy_struct) -> None:
    """Makes a layer the one on which the artist draws."""
    ob.data.layers.active = layer


def every_layer(ob: bpy.types.Object) -> list[bpy.types.bpy_struct]:
    """All layers, lowest first."""
    return list(ob.data.layers)


def frame_numbers(layer: bpy.types.bpy_struct, selected: bool = False) -> list[int]:
    """Frame numbers of a layer's drawings in time order; with `selected`, only those of selected frames."""
    numbers = [frame.frame_number for frame in layer.frames if frame.select or not selected]
    return [number for number in numbers if layer.get_frame_at(number) is not None]


def ends(layer: bpy.types.bpy_struct) -> list[int]:
    """The frames on which a drawing ends by itself. Blender has them where a drawing was made with a duration, and they have no drawing."""
    numbers = [frame.frame_number for frame in layer.frames]
    return [number for number in numbers if layer.get_frame_at(number) is None]


def drawings(layer: bpy.types.bpy_struct) -> dict[int, tuple[bpy.types.bpy_struct, str]]:
    """Drawing and keyframe type by frame number, in time order."""
    found = ((frame, frame.drawing) for frame in layer.frames)
    return {frame.frame_number: (drawing, frame.keyframe_type) for frame, drawing in found if drawing is not None}


def handles(layer: bpy.types.bpy_struct, kind: str = "") -> Iterator[bpy.types.bpy_struct]:
    """The drawings of a layer one by one, without their numbers; with `kind`, only those on frames of that keyframe type. Blender searches
    for each drawing, so whoever looks for one should stop there."""
    wanted = (frame.drawing for frame in layer.frames if kind in ("", frame.keyframe_type))
    return (drawing for drawing in wanted if drawing is not None)


def shown(layer: bpy.types.bpy_struct, number: int) -> tuple[int, bpy.types.bpy_struct, str] | None:
    """What a layer shows on a frame: the frame of the drawing, the drawing, and its keyframe type. `None` if it shows none."""
    frame = layer.get_frame_at(number)
    return None if frame is None else (frame.frame_number, frame.drawing, frame.keyframe_type)


def has_strokes(layer: bpy.types.bpy_struct) -> bool:
    """Whether any drawing of a layer has strokes. No array is read."""
    positions_of = (drawing.attributes.get("position") for drawing in handles(layer))
    return any(each is not None and len(each.data) for each in positions_of)


@contextmanager
def copied(data: bpy.types.ID) -> Iterator[bpy.types.ID]:
    """A copy of Grease Pencil data, to read from, which is removed at the end.

    Blender shares arrays between data, their copies and the undo steps. Python gets an attribute's values only as if to change
    them, which makes the array its owner's own. So if the data themselves were read, the last undo step would keep a second array:
    for 200 drawings of 300 strokes, 200 MB for each step. The copy takes the loss instead. Where Blender lets no data-block be
    made, as while panels are drawn, the data themselves are read.
    """
    try:
        copy = data.copy()
    except (RuntimeError, AttributeError):
        yield data
        return
    try:
        yield copy
    finally:
        # Nothing uses it, so nobody must be searched for users.
        datablocks().remove(copy, do_unlink=False, do_id_user=True, do_ui_user=False)


def set_keyframe_type(layer: bpy.types.bpy_struct, types: Mapping[int, str]) -> None:
    """Sets the keyframe type of the frames in `types`."""
    changed = [frame for frame in layer.frames if types.get(frame.frame_number, frame.keyframe_type) != frame.keyframe_type]
    for frame in changed:
        frame.keyframe_type = types[frame.frame_number]
    if changed:
        # Files and undo steps get the frames as they were when one was last made, moved or removed: a new type alone would be lost.
        # The one before all others is made and removed; behind others it could cut a drawing's fixed duration.
        number = min(frame.frame_number for frame in layer.frames) - 1
        layer.frames.new(number)
        layer.frames.remove(number)


def make_frames(layer: bpy.types.bpy_struct, numbers: Iterable[int], kind: str) -> None:
    """Makes empty frames of a keyframe type on the numbers that have no frame. The others get drawings of their own, to be written."""
    numbers, have = list(numbers), {frame.frame_number for frame in layer.frames}
    make_own(layer, have.intersection(numbers))
    for number in numbers:
        if number not in have:
            layer.frames.new(number).keyframe_type = kind


def make_own(layer: bpy.types.bpy_struct, numbers: Iterable[int]) -> None:
    """Gives frames a drawing of their own that share one with other frames. What is written there would show on the others too."""
    wanted = set(numbers)
    for number in [frame.frame_number for frame in layer.frames if frame.frame_number in wanted and _is_shared(frame.drawing)]:
        if _is_shared(drawings(layer)[number][0]):
            aside = min(frame.frame_number for frame in layer.frames) - 1
            layer.frames.copy(number, aside)
            layer.frames.remove(number)
            layer.frames.move(aside, number)


def _is_shared(drawing: bpy.types.bpy_struct | None) -> bool:
    return drawing is not None and drawing.user_count > 1


def remove_frames(layer: bpy.types.bpy_struct, numbers: Iterable[int]) -> None:
    """Removes frames."""
    for number in numbers:
        layer.frames.remove(number)


def copy_frame(layer: bpy.types.bpy_struct, source: int, number: int) -> None:
    """Copies the drawing on frame `source` to frame `number`, with everything that Blender knows of its strokes."""
    layer.frames.copy(source, number)


def put_frames(layer: bpy.types.bpy_struct, places: Mapping[int, Iterable[int]]) -> None:
    """Puts each drawing on other frames: by its frame those on which it is to be. On several it is copied; without any it is removed.

    A drawing that is on no frame of `places` stays where it is, so none of the new frames may have one.
    """
    before = sorted(places)
    if all(list(places[number]) == [number] for number in before):
        return
    taken = [frame.frame_number for frame in layer.frames]
    aside = min([*taken, *(number for each in places.values() for number in each)]) - 1 - len(before)
    for k, number in enumerate(before):
        layer.frames.move(number, aside + k)
    for k, number in enumerate(before):
        first, *others = list(places[number]) or [None]
        for other in others:
            layer.frames.copy(aside + k, other)
        if first is None:
            layer.frames.remove(aside + k)
        else:
            layer.frames.move(aside + k, first)


def offsets(drawing: bpy.types.bpy_struct) -> np.ndarray:
    """Index of each stroke's first point, then the number of points: int32 (strokes + 1)."""
    position = drawing.attributes.get("position")
    if position is None or not len(position.data):
        # For an empty drawing Blender reports one offset, but reading it fails.
        return np.zeros(1, np.int32)
    found = np.empty(len(drawing.curve_offsets), np.int32)
    drawing.curve_offsets.foreach_get("value", found)
    return found


def has(drawing: bpy.types.bpy_struct, name: str) -> bool:
    """Whether a drawing has an attribute."""
    return drawing.attributes.get(name) is not None


def names(drawing: bpy.types.bpy_struct) -> frozenset[str]:
    """The attributes that a drawing has."""
    return frozenset(attribute.name for attribute in drawing.attributes)


def get(drawing: bpy.types.bpy_struct, name: str, count: int) -> np.ndarray | None:
    """The values of an attribute, `count` rows. `None` if the drawing has no such attribute of that length."""
    attribute = drawing.attributes.get(name)
    if attribute is None or attribute.data_type not in _LAYOUT or len(attribute.data) != count:
        return None
    key, kind, width = _LAYOUT[attribute.data_type]
    values = np.empty(count * width, kind)
    attribute.data.foreach_get(key, values)
    return values if width == 1 else values.reshape(count, width)


def value(drawing: bpy.types.bpy_struct, name: str, count: int) -> np.ndarray:
    """The values of an attribute, `count` rows. A missing attribute has its default values."""
    found = get(drawing, name, count)
    return blank(name, count) if found is None else found


def is_numeric(data_type: str) -> bool:
    """Whether the values of attributes of a data type can be read and written."""
    return data_type in _LAYOUT


def blank(name: str, count: int, data_type: str | None = None) -> np.ndarray:
    """`count` rows of an attribute's default value. `data_type` is that of an attribute that is not in `TYPES`."""
    _, kind, width = _LAYOUT[data_type or TYPES[name][0]]
    return np.full(count if width == 1 else (count, width), DEFAULTS.get(name, 0), kind)


def make(drawing: bpy.types.bpy_struct, name: str, kind: str, where: str) -> bpy.types.bpy_struct:
    """A new attribute of a drawing."""
    if name != "nurbs_order":
        return drawing.attributes.new(name, kind, where)
    # Blender 4.5 writes beyond the attribute's end if it makes it under this name. Renaming it is safe.
    drawing.attributes.new("rototoon_order", kind, where).name = name
    return drawing.attributes[name]


def put(drawing: bpy.types.bpy_struct, name: str, values: np.ndarray) -> None:
    """Sets all values of an attribute. A missing attribute is made."""
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


def remove_strokes(drawing: bpy.types.bpy_struct, indices: list[int]) -> None:
    """Removes strokes."""
    drawing.remove_strokes(indices=indices)


def new_object(name: str, collection: bpy.types.Collection) -> bpy.types.Object:
    """A new Grease Pencil object with the material Rototoon Ink, linked to `collection`."""
    data = datablocks().new(name)
    ob = bpy.data.objects.new(name, data)
    collection.objects.link(ob)
    material = bpy.data.materials.get("Rototoon Ink")
    if material is None or material.grease_pencil is None:
        material = bpy.data.materials.new("Rototoon Ink")
        bpy.data.materials.create_gpencil_data(material)
        material.grease_pencil.color = (0.9, 0.1, 0.35, 1.0)
    data.materials.append(material)
    return ob

"""Keys from pixels: polygons become strokes on a contour layer, as if the artist had drawn them."""

from __future__ import annotations

import operator
from collections.abc import Mapping
from typing import Any

import bpy
import numpy as np

from ..blender import grease_pencil as gp
from ..blender import guard, placement, stroke_rows
from ..blender.errors import Problem
from ..capture import closing, contours, correspondence, document, generated, identity, stamps
from ..common.operators import OnDrawing
from .refusing import need, told


@told
def set_key(
    ob: bpy.types.Object,
    frame: int,
    polygons: Mapping[str, Any],
    *,
    closed: bool = True,
    layer: str = "",
    replace: bool = False,
    radius: float = 0.01,
    material: int = 0,
) -> list[str]:
    """Draws contours as keys on a scene frame. Returns the names of the parts that are new.

    `polygons` are footage pixels (N, 2) by the name of a part, farther parts first. Of a known part, N points are its control points
    if it has as many; otherwise they are matched to it by shape, so order, direction and number of points are free. A name that is
    not known makes a part, `closed` or not, nearer than all others.

    New parts are drawn on `layer`, one of the contour layers; by default on the settings' contour layer, which is made if there is
    none. Known parts stay on their layer. A generated contour on the frame becomes the key. A key of the artist is only replaced
    with `replace`. The frame must be one of the footage. `radius` is that of the points in Blender's unit, `material` the index in the object's list.
    """
    need(ob, OnDrawing)
    placement.view_of(ob)
    frame = _frame(ob, frame)
    name = layer or ob.rototoon.contours_layer
    wanted = _wanted(polygons)
    found = contours.read(ob)
    known = {part.name: part for part in found.parts}
    places = {part: _place(found, known.get(part), name) for part in wanted}
    _need_places(ob, name, set(places.values()))
    for part in wanted:
        if part in known and frame in known[part].keys and not replace:
            raise Problem(f'"{part}" has a key on frame {frame} already: call set_key with replace=True to replace it')
    mapper = document.mapper_on(ob, found, [frame])
    controls = {part: _control(known.get(part), part, points, frame, mapper) for part, points in wanted.items()}
    placed = _on_layers(ob, name, frame, wanted, places)
    made = [_new_part(ob, found, part, closed, len(wanted[part])) for part in wanted if part not in known]
    for item in ob.rototoon.parts:
        if item.name in wanted and not _has_strokes(known.get(item.name)):
            item.count = len(wanted[item.name])
    for place in dict.fromkeys(places.values()):
        mine = {part: placed[part] for part in wanted if places[part] == place}
        _draw(ob, place, frame, mine, controls, radius, material)
    ob.data.update_tag()
    return made


def _need_places(ob: bpy.types.Object, name: str, places: set[str]) -> None:
    """Raises a `Problem` if one of the layers may not be written, or `name` is no contour layer."""
    guard.need_named(ob, sorted(places | {name}), hidden=True)
    prefix = ob.rototoon.contours_layer
    if name != prefix and not name.startswith((f"{prefix}.", f"{prefix} ")):
        raise Problem(f'The layer "{name}" is not a contour layer: its name must begin with "{prefix}"')


def _on_layers(ob: bpy.types.Object, name: str, frame: int, wanted, places: dict[str, str]) -> dict[str, np.ndarray]:
    """Points (N, 3) of the parts in the space of their layers. The layer `name` is made if there is none."""
    is_new = gp.find_layer(ob, name) is None
    layer = gp.layer(ob, name)
    found = contours.read(ob)
    try:
        mapper = document.mapper_on(ob, found, [frame])
        index = {place: found.layer_names.index(place) for place in places.values()}
        return {part: mapper.at(index[places[part]], frame).to_layer(points) for part, points in wanted.items()}
    except Problem:
        if is_new:
            gp.remove_layer(ob, layer)
        raise


def _frame(ob: bpy.types.Object, frame: Any) -> int:
    settings = ob.rototoon
    first, last = settings.first + settings.frame_offset, settings.last + settings.frame_offset
    try:
        whole = operator.index(frame)
    except TypeError:
        raise Problem(f"frame: found {frame!r}, expected a whole number from {first} to {last}") from None
    if settings.pattern and not first <= whole <= last:
        raise Problem(f"frame: found {whole}, expected a frame of the footage, from {first} to {last}")
    return whole


def _wanted(polygons: Mapping[str, Any]) -> dict[str, np.ndarray]:
    """Points (N, 2) by the name of a part, as the list of parts has it: without spaces around it."""
    wanted: dict[str, np.ndarray] = {}
    for part, points in polygons.items():
        if not isinstance(part, str) or not part.strip():
            raise Problem(f"polygons: found {part!r}, expected the name of a part")
        name = part.strip()
        if name in wanted:
            raise Problem(f'polygons: found two contours of "{name}", expected one for each part')
        wanted[name] = _points(name, points)
    return wanted


def _has_strokes(part: contours.Part | None) -> bool:
    return part is not None and bool(part.keys or part.made)


def _points(part: str, points: Any) -> np.ndarray:
    try:
        array = np.asarray(points, np.float64)
    except (TypeError, ValueError):
        array = np.zeros(0)
    if array.ndim != 2 or array.shape[1:] != (2,) or len(array) < 2 or not np.isfinite(array).all():
        raise Problem(f'"{part}": expected at least two points [x, y] of finite numbers, found an array of shape {array.shape}')
    return array


def _place(found: contours.Contours, part: contours.Part | None, name: str) -> str:
    strokes = [] if part is None else [*part.keys.values(), *part.made.values()]
    return found.layer_names[strokes[0].layer] if strokes else name


def _control(part: contours.Part | None, name: str, points: np.ndarray, frame: int, mapper) -> np.ndarray:
    """Control numbers of the points of a key."""
    if not _has_strokes(part) or len(points) == part.count:
        return correspondence.identity(len(points))
    near = min([*part.keys, *part.made], key=lambda other: (abs(other - frame), other))
    stroke = part.keys.get(near) or part.made[near]
    mapper.extend([near])
    reference = mapper.at(stroke.layer, near).to_pixels(stroke.control_points(part.closed))
    for _, _, matched in identity.match([(part.closed, reference, [])], [(part.closed, points, [])]):
        where = correspondence.locate(points, matched, part.closed)
        control = correspondence.invert(where, len(points), part.closed)
        if control is not None and correspondence.invert(control, part.count, part.closed) is not None:
            return control.astype(np.float32)
    raise Problem(
        f'"{name}": {len(points)} points could not be matched to its contour on frame {near}: give its {part.count} control points'
    )


def _new_part(ob: bpy.types.Object, found: contours.Contours, name: str, closed: bool, count: int) -> str:
    settings = ob.rototoon
    item = settings.parts.add()
    item.number, item.name, item.count = settings.next_number, name, count
    with closing.lines_kept():
        item.closed = closed
    depths = [part.depth for part in found.parts]
    item.depth = max(depths, default=-1.0) + 1
    found.parts.append(contours.Part(item.number, name, closed, item.depth, count))
    settings.next_number += 1
    return name


def _draw(ob, layer_name: str, frame: int, polygons, controls, radius: float, material: int) -> None:
    """Adds strokes, points (N, 3) by part, to the drawing on a frame, in the place of earlier strokes of their parts."""
    stamp, layer = stamps.settled(ob), gp.find_layer(ob, layer_name)
    gp.make_frames(layer, [frame], gp.KEYFRAME)
    handle, kind = gp.drawings(layer)[frame]
    generated.settle(handle, kind)
    items = {item.name: item for item in ob.rototoon.parts}
    numbers = np.array([items[name].number for name in polygons], np.int32)
    strokes = len(gp.offsets(handle)) - 1
    gone = np.flatnonzero(np.isin(gp.value(handle, gp.PART, strokes), numbers))
    if len(gone):
        gp.remove_strokes(handle, gone.tolist())
    points = np.concatenate(list(polygons.values()))
    rows = stroke_rows.Rows(np.array([len(each) for each in polygons.values()], np.int32))
    rows.values = {
        "position": points.astype(np.float32),
        "radius": np.full(len(points), radius, np.float32),
        "opacity": gp.blank("opacity", len(points)),
        "cyclic": np.array([items[name].closed for name in polygons]),
        "material_index": np.full(len(polygons), material, np.int32),
        gp.PART: numbers,
        gp.OWNER: np.full(len(polygons), stamp, np.int32),
        gp.MADE: np.zeros(len(polygons), bool),
        gp.CONTROL: np.concatenate([controls[name] for name in polygons]),
    }
    stroke_rows.append(handle, rows)
    gp.set_keyframe_type(layer, {frame: gp.KEYFRAME})

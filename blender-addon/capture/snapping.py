"""Snapped lines, which follow the ink, as strokes on a layer of their own.

A snapped stroke joins the paths of a part's segments. Each of its points carries the index of its segment, so the paths can be
read back. A stroke that was fitted or cut since has no longer all of its paths, and is not read: the control points stand for it.
Frames of this layer that the artist made (with another keyframe type than "Generated") are not changed, and neither are generated
ones that the artist changed: they become keys (`keep_edited`). Fit Strokes and Remove Hidden Lines are no such change, since the next Snap
makes these lines anew, as ever.
"""

from __future__ import annotations

from collections.abc import Container
from typing import Any

import numpy as np

from ..blender import grease_pencil as gp
from ..blender import guard, hierarchy, marks, own_attributes, stroke_rows
from ..blender import strokes as st
from ..blender.placement import Mapper
from ..common.wording import listed
from . import writing
from .contours import Contours, Part, read_drawing
from .corrections import MOVED


def join(segments: list[np.ndarray], closed: bool) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points (M, 2) of the joined paths, the segment of each point, and its fractional index between control points (0, 1,
    2, …)."""
    points, owner, place = [], [], []
    for index, path in enumerate(segments):
        path = np.asarray(path, np.float64).reshape(-1, 2)
        last = index == len(segments) - 1
        along = _arc(path)
        keep = len(path) - (0 if last and not closed else 1)
        keep = max(keep, 1)
        points.append(path[:keep])
        owner.append(np.full(keep, index))
        place.append(index + along[:keep])
    return np.concatenate(points), np.concatenate(owner), np.concatenate(place)


def split(points: np.ndarray, owner: np.ndarray, closed: bool) -> list[np.ndarray]:
    """Splits a joined stroke into its paths."""
    count = int(owner.max()) + 1
    paths = []
    for index in range(count):
        path = points[owner == index]
        if index + 1 < count:
            following = points[owner == index + 1][:1]
        else:
            following = points[:1] if closed else points[:0]
        paths.append(np.concatenate([path, following]))
    return paths


def complete(segments: list, count: int, closed: bool) -> bool:
    """Whether there is a path for each segment between `count` control points."""
    return len(segments) == count - (0 if closed else 1) and all(len(path) for path in segments)


def _arc(path: np.ndarray) -> np.ndarray:
    """The arc length up to each point of a path, as a share of the path's length."""
    steps = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
    return steps / steps[-1] if steps[-1] > 0 else np.linspace(0, 1, len(path)) if len(path) > 1 else steps


def aside(ob):
    """The layer with the hidden lines of snapped ones, which Remove Hidden Lines makes; `None` if there is none."""
    return gp.find_layer(ob, ob.rototoon.snapped_layer + hierarchy.ASIDE)


def old_aside(ob) -> set[int]:
    """The frames of hidden lines that were cut from generated snapped drawings. Those of the artist's snapped drawings belong to these."""
    layer, whole = aside(ob), gp.find_layer(ob, ob.rototoon.snapped_layer)
    if layer is None:
        return set()
    generated = set() if whole is None else made_frames(whole)
    shown = {frame: st.shown_frame(whole, frame) if whole is not None else None for frame in made_frames(layer)}
    return {frame for frame, source in shown.items() if source is None or source in generated}


def made_frames(layer) -> set[int]:
    """The frames of a layer with snapped or hidden lines that may be drawn anew. Other drawings are the artist's as a whole, with the
    snapped strokes on them."""
    return {frame for frame, (_, kind) in gp.drawings(layer).items() if kind == gp.GENERATED}


def clear_aside(ob) -> tuple[list[int], str]:
    """Removes the hidden lines of snapped drawings that are drawn anew. Returns the frames of those that stay because the artist changed
    them, and a warning if none may be removed."""
    layer = aside(ob)
    if layer is None or not gp.frame_numbers(layer):
        return [], ""
    if guard.closed(layer):
        return [], guard.left_out([layer])
    edited = keep_edited(ob, layer=layer)
    writing.clear(layer, old_aside(ob))
    return edited, ""


def keep_edited(ob, frames: Container[int] | None = None, layer=None) -> list[int]:
    """Makes snapped drawings that the artist changed the artist's, so that they are not written again: all, or those on `frames`.

    `layer` is by default that of snapped lines. Returns their frames.
    """
    layer = layer or gp.find_layer(ob, ob.rototoon.snapped_layer)
    if layer is None:
        return []
    edited = [each for each in marks.changed_frames(ob.data, layer.name) if frames is None or each in frames]
    gp.set_keyframe_type(layer, dict.fromkeys(edited, gp.KEYFRAME))
    return edited


def write(ob, curves: dict[tuple[int, int], list[np.ndarray]], found: Contours, mapper: Mapper) -> int:
    """Writes snapped paths. `curves` are pixels by part number and scene frame. Returns the number of strokes.

    Drawings that the artist changed are written too, unless `keep_edited` made them the artist's.
    """
    layer = gp.layer(ob, ob.rototoon.snapped_layer)
    old = made_frames(layer)
    own = set(gp.frame_numbers(layer)) - old
    parts = [part for part in found.parts if part.keys]
    kinds = found.own()
    style = {part.number: writing.styles(part, found, kinds) for part in parts}
    frames = sorted({frame for _, frame in curves} - own)
    ends = writing.ends_of(frames, own | set(frames), ob.rototoon.last + ob.rototoon.frame_offset)
    gp.remove_frames(layer, sorted(old - set(frames)))
    gp.make_frames(layer, sorted({*frames, *ends}), gp.GENERATED)
    drawings = gp.drawings(layer)
    snapped = Mapper(ob, frames, _plane_points(ob, found), [layer.name])
    written = 0
    for frame in frames:
        strokes = [
            _stroke(part, frame, curves[part.number, frame], style[part.number], snapped)
            for part in sorted(parts, key=lambda part: part.depth_at(frame))
            if curves.get((part.number, frame))
        ]
        rows = _rows(strokes, kinds)
        if not stroke_rows.has_made(drawings[frame][0], rows):
            stroke_rows.replace_made(drawings[frame][0], rows)
        written += len(strokes)
    marks.note(ob.data, layer.name, frames)
    return written


def _plane_points(ob, found: Contours) -> dict[int, np.ndarray]:
    """The artist's points, which show the drawing plane of the snapped layer."""
    rows = [s.points for d in found.drawings.values() for s in d.strokes if not s.made]
    return {0: np.concatenate(rows)} if rows else {}


def _stroke(part: Part, frame: int, segments: list[np.ndarray], style, mapper: Mapper) -> dict[str, np.ndarray]:
    point, curve, frames = style
    pixels, owner, place = join(segments, part.closed)
    wanted = np.array([frame])
    stroke = {
        "position": mapper.at(0, frame).to_layer(pixels).astype(np.float32),
        gp.SEGMENT: owner,
        gp.PART: np.array([part.number]),
        gp.MADE: np.array([True]),
    }
    low = np.clip(np.floor(place).astype(int), 0, part.count - 1)
    high = (low + 1) % part.count if part.closed else np.minimum(low + 1, part.count - 1)
    share = place - low
    for name, values in point.items():
        now = writing.mixed(name, values, frames, wanted)[0]
        weight = share[:, None] if now.ndim > 1 else share
        blended = own_attributes.is_blended(now)
        stroke[name] = now[low] * (1 - weight) + now[high] * weight if blended else now[np.where(share < 0.5, low, high)]
    for name, values in curve.items():
        stroke[name] = writing.mixed(name, values, frames, wanted)
    return stroke


def _rows(strokes: list[dict[str, np.ndarray]], kinds: dict[str, own_attributes.Kind]) -> stroke_rows.Rows:
    rows = stroke_rows.Rows(np.array([len(stroke["position"]) for stroke in strokes], np.int32), own=kinds)
    names = {name for stroke in strokes for name in stroke}
    for name in sorted(names):
        values = []
        for stroke in strokes:
            kind, domain = kinds.get(name) or gp.TYPES.get(name, ("", "POINT"))
            count = len(stroke["position"]) if domain == "POINT" else 1
            values.append(stroke[name] if name in stroke else gp.blank(name, count, kind or None))
        rows.values[name] = np.concatenate(values)
    return rows


def read(ob) -> dict[tuple[int, int], list[np.ndarray]]:
    """Snapped paths in pixels, by part number and scene frame, of the strokes that are as they were snapped or were moved."""
    return {place: paths for place, paths in _read(ob).items() if paths is not None}


def reshaped(ob) -> list[int]:
    """The scene frames with snapped strokes that were fitted or cut since."""
    return sorted({frame for (_, frame), paths in _read(ob).items() if paths is None})


def older(ob, project: dict[str, Any]) -> str:
    """The snapped lines that are older than their contours, of a document of the object with results, in words. Empty if there are none."""
    found = [f'"{name}" on {listed(frames)}' for name, frames in _older(ob, project).items()]
    return f"snapped lines are older than the contours: {', '.join(found)}; Snap to Ink makes them again" if found else ""


def _older(ob, project: dict[str, Any]) -> dict[str, list[int]]:
    """By part the scene frames.

    A path begins and ends at the control points that it was snapped from. Lines that the artist changed lie as the artist wants.
    """
    layer = gp.find_layer(ob, ob.rototoon.snapped_layer)
    if layer is None:
        return {}
    own = set(gp.frame_numbers(layer)) - made_frames(layer) | set(marks.changed_frames(ob.data, layer.name))
    found = {}
    for entry in project["parts"]:
        contours = {**entry["keys"], **entry.get("tracks", {})}
        frames = [int(label) + ob.rototoon.frame_offset for label, paths in entry.get("curves", {}).items() if _moved_off(paths, contours.get(label))]
        left = [frame for frame in frames if frame not in own]
        if left:
            found[entry["name"]] = left
    return found


def _moved_off(paths: list, contour: list | None) -> bool:
    """Whether the ends of paths are not the control points of a contour, or there is none."""
    if contour is None:
        return True
    ends = [path[0] for path in paths] + ([paths[-1][-1]] if len(paths) < len(contour) else [])
    return len(ends) != len(contour) or bool(np.linalg.norm(np.subtract(ends, contour), axis=1).max() > MOVED)


def _read(ob) -> dict[tuple[int, int], list[np.ndarray] | None]:
    """As `read`, with `None` for strokes that have no longer all of their paths."""
    layer = gp.find_layer(ob, ob.rototoon.snapped_layer)
    if layer is None or not gp.frame_numbers(layer):
        return {}
    with gp.copied(ob.data) as data:
        handles = gp.drawings(data.layers[layer.name])
        drawings = {f: read_drawing(handle, kind, 0, f) for f, (handle, kind) in handles.items()}
        owners = {f: gp.get(handles[f][0], gp.SEGMENT, len(drawing.points)) for f, drawing in drawings.items()}
        types = {f: gp.get(handles[f][0], "curve_type", len(drawing.strokes)) for f, drawing in drawings.items()}
    parts = {part.number: part for part in ob.rototoon.parts}
    mapper = Mapper(ob, drawings, {}, [layer.name])
    found = {}
    for frame, drawing in drawings.items():
        owner = owners[frame]
        if owner is None:
            continue
        for stroke in drawing.strokes:
            part = parts.get(stroke.part)
            if part is None or not len(stroke.points):
                continue
            # Guides of a curve do not lie on it.
            straight = types[frame] is None or types[frame][stroke.index] == st.POLY
            found[part.number, frame] = None
            if straight and _ordered(owner[stroke.span], part.count - (0 if part.closed else 1)):
                pixels = mapper.at(0, frame).to_pixels(stroke.points)
                found[part.number, frame] = split(pixels, owner[stroke.span], part.closed)
    return found


def _ordered(owner: np.ndarray, segments: int) -> bool:
    """Whether the points belong to all segments, one after the other."""
    return bool((np.diff(owner) >= 0).all()) and np.array_equal(np.unique(owner), np.arange(segments))

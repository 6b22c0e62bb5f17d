"""A project document as strokes: keys, corrections, tracks and snapped curves."""

from __future__ import annotations

from typing import Any

import numpy as np
from rototoon.documents import by_frame

from ..blender import grease_pencil as gp
from ..blender import guard, placement, stroke_rows
from ..capture import contours, corrections, correspondence, document, ends, exchanged, snapping, stamps, unseen, writing
from . import files
from .looks import Looks


def apply(ob, project: dict[str, Any], looks: Looks | None = None) -> None:
    """Replaces an object's contours by those of a checked document. The object's footage must be set before. `looks` are those that its parts had;
    an object without contours has none."""
    settings, looks = ob.rototoon, looks or Looks()
    _empty(ob)
    settings.extra = files.unknown_of_document(project)
    gp.layer(ob, settings.contours_layer)
    for number, entry in enumerate(project.get("parts", []), 1):
        _add_part(settings, number, entry)
    settings.next_number = len(settings.parts) + 1
    _write_keys(ob, project, looks)
    found = contours.read(ob)
    corrected = {frame for entry in project.get("parts", []) for name in ("pins", "centers") for frame in by_frame(entry.get(name))}
    mapper = document.mapper_of(ob, found, *(frame + settings.frame_offset for frame in corrected))
    tracks, fixed = {}, {}
    for part, entry in zip(list(found.parts), project.get("parts", []), strict=True):
        track, fix = _results(part, entry, mapper, settings.frame_offset)
        if track is not None:
            tracks[part.number], fixed[part.number] = track, fix
    if tracks:
        parts = [part for part in found.parts if part.keys]
        for index, name in enumerate(found.layer_names):
            block = writing.lay_out(index, parts, tracks, found, mapper, fixed)
            writing.limit(block, ob, index, found)
            writing.write(gp.find_layer(ob, name), block, [])
        unseen.note_pictures(ob, unseen.of_document(project))
    curves = _curves(project, settings.frame_offset)
    if curves:
        snapping.write(ob, curves, found, mapper)


def need_open(ob, project: dict[str, Any]) -> None:
    """Raises a `Problem` if the contours of an object cannot be replaced by those of a document: the object or one of the layers is closed."""
    guard.need(ob)
    settings = ob.rototoon
    guard.need_open(gp.layers(ob, settings.contours_layer) + gp.layers(ob, settings.snapped_layer), hidden=True)
    guard.need_named(ob, [settings.contours_layer, settings.snapped_layer], hidden=True)
    if _curves(project, settings.frame_offset):
        guard.need_apart(ob, [settings.snapped_layer], hidden=True)


def _empty(ob) -> None:
    settings = ob.rototoon
    settings.parts.clear()
    exchanged.put(ob, [])
    for layer in gp.layers(ob, settings.contours_layer) + gp.layers(ob, settings.snapped_layer):
        gp.remove_frames(layer, gp.frame_numbers(layer))


def _add_part(settings, number: int, entry: dict[str, Any]) -> None:
    part = settings.parts.add()
    # A name gets another form here if it has blanks at its ends, and limbs and marks go with it.
    part.number, part.known_as = number, entry["name"]
    part.name = entry["name"]
    part.closed, part.depth = bool(entry.get("closed", True)), float(entry.get("depth", 0.0))
    part.count = len(next(iter(entry.get("keys", {}).values()), []))
    part.extra = files.unknown_of_part(entry)
    ends.put(part, [(frame, ends.LOST) for frame in entry.get("wants_key", [])])


def _write_keys(ob, project: dict[str, Any], looks: Looks) -> None:
    """Writes the artist's strokes on the planes that points show. Farther parts come first, so that nearer ones are drawn over them."""
    settings, stamp = ob.rototoon, stamps.settled(ob)
    drawn: dict[str, dict[int, list[tuple[float, int, dict[str, Any], np.ndarray]]]] = {}
    for number, entry in enumerate(project.get("parts", []), 1):
        frames, depths = drawn.setdefault(looks.layer_of(entry["name"], settings.contours_layer), {}), by_frame(entry.get("depths"))
        for picture, points in by_frame(entry.get("keys")).items():
            depth = float(depths.get(picture, entry.get("depth", 0.0)))
            frames.setdefault(picture, []).append((depth, number, entry, np.asarray(points, np.float64)))
    for name, frames in drawn.items():
        layer, offset = gp.find_layer(ob, name), settings.frame_offset
        plane = {0: looks.planes[name]} if name in looks.planes else {}
        mapper = placement.Mapper(ob, [picture + offset for picture in frames], plane, [name])
        gp.make_frames(layer, sorted(picture + offset for picture in frames), gp.KEYFRAME)
        drawings = gp.drawings(layer)
        for picture, strokes in frames.items():
            strokes.sort(key=lambda row: row[:2])
            rows = _rows(strokes, picture, mapper.at(0, picture + offset), looks)
            rows.values[gp.OWNER] = np.full(len(strokes), stamp, np.int32)
            stroke_rows.append(drawings[picture + offset][0], rows)


def _rows(strokes: list[tuple[float, int, dict[str, Any], np.ndarray]], picture: int, mapping, looks: Looks) -> stroke_rows.Rows:
    """The strokes of a key drawing, with the looks that their parts had."""
    rows = stroke_rows.Rows(np.array([len(points) for *_, points in strokes], np.int32), own=looks.own)
    points = np.concatenate([points for *_, points in strokes])
    rows.values = {
        "position": mapping.to_layer(points).astype(np.float32),
        "radius": gp.blank("radius", len(points)),
        "opacity": gp.blank("opacity", len(points)),
        "cyclic": np.array([bool(entry.get("closed", True)) for _, _, entry, _ in strokes]),
        "material_index": np.zeros(len(strokes), np.int32),
        gp.PART: np.array([number for _, number, _, _ in strokes], np.int32),
        gp.CONTROL: np.concatenate([correspondence.identity(len(points)) for *_, points in strokes]),
    }
    rows.values |= looks.rows([(entry["name"], number, len(points)) for _, number, entry, points in strokes], picture)
    return rows


def _results(part: contours.Part, entry: dict[str, Any], mapper, offset: int):
    """The part's track and corrections. Frames with a correction and without a track get the blended keys."""
    pins, centers = by_frame(entry.get("pins")), by_frame(entry.get("centers"))
    points = {f: np.asarray(p, np.float64) for f, p in by_frame(entry.get("tracks")).items()}
    sure = by_frame(entry.get("confidence"))
    keys = {f: np.asarray(p, np.float64) for f, p in by_frame(entry.get("keys")).items()}
    if not keys:
        return None, None
    fixed = corrections.Corrections()
    for frame in sorted(set(pins) | set(centers)):
        if not corrections.correctable(keys, frame):
            continue
        base = points.get(frame)
        if base is None:
            known = sorted(keys)
            base = writing.blend(np.stack([keys[f] for f in known]), known, np.array([frame]))[0]
            if frame in centers:
                base = base + np.asarray(centers[frame]) - base.mean(0)
        base = base.copy()
        for index, place in pins.get(frame, {}).items():
            base[int(index)] = place
        points[frame] = base
        _fix(fixed, frame, offset, pins, centers, base, mapper.at(part.layer, frame + offset))
    if not points:
        return None, None
    frames = sorted(points)
    # Values of another number are those of other tracks, and are not known here.
    known = {f: values for f, values in sure.items() if len(values) == part.count}
    confidence = [np.asarray(known.get(f, np.ones(part.count)), np.float64) for f in frames]
    track = writing.Track(np.array(frames) + offset, np.stack([points[f] for f in frames]), np.stack(confidence))
    return track, fixed


def _fix(fixed, frame: int, offset: int, pins, centers, base: np.ndarray, mapping) -> None:
    if pins.get(frame):
        fixed.pins[frame + offset] = {int(i): base[int(i)] for i in pins[frame]}
        fixed.held[frame + offset] = mapping.to_layer(base).astype(np.float32)
    if frame in centers:
        fixed.centers[frame + offset] = np.asarray(centers[frame], np.float64)


def _curves(project: dict[str, Any], offset: int) -> dict[tuple[int, int], list[np.ndarray]]:
    return {
        (number, frame + offset): [np.asarray(path, np.float64) for path in segments]
        for number, entry in enumerate(project.get("parts", []), 1)
        for frame, segments in by_frame(entry.get("curves")).items()
        if snapping.complete(segments, len(next(iter(entry.get("keys", {}).values()), [])), bool(entry.get("closed", True)))
    }

"""A project document as strokes: keys, corrections, tracks and snapped curves."""

from __future__ import annotations

from typing import Any

import numpy as np
from rototoon.documents import by_frame

from ..blender import grease_pencil as gp
from ..blender import guard, placement, stroke_rows
from ..capture import contours, corrections, correspondence, document, ends, exchanged, snapping, stamps, unseen, writing
from . import files


def apply(ob, project: dict[str, Any], material: int = 0) -> None:
    """Replaces an object's contours by those of a checked document. The object's footage must be set before."""
    settings, plane = ob.rototoon, plane_of(ob)
    _empty(ob)
    settings.extra = files.unknown_of_document(project)
    layer = gp.layer(ob, settings.contours_layer)
    for number, entry in enumerate(project.get("parts", []), 1):
        _add_part(settings, number, entry)
    settings.next_number = len(settings.parts) + 1
    _write_keys(ob, layer, project, material, plane)
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
        block = writing.lay_out(0, parts, tracks, found, mapper, fixed)
        writing.limit(block, ob, 0, found)
        writing.write(gp.find_layer(ob, found.layer_names[0]), block, [])
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


def plane_of(ob) -> dict[int, np.ndarray]:
    """The artist's points on the layer of the contours, as the first layer of a `Mapper`. Contours of a document come onto their plane."""
    found = contours.read(ob)
    name = ob.rototoon.contours_layer
    points = document.drawn_points(found).get(found.layer_names.index(name)) if name in found.layer_names else None
    return {} if points is None else {0: points}


def _empty(ob) -> None:
    settings = ob.rototoon
    settings.parts.clear()
    exchanged.put(ob, [])
    for layer in gp.layers(ob, settings.contours_layer) + gp.layers(ob, settings.snapped_layer):
        gp.remove_frames(layer, gp.frame_numbers(layer))


def _add_part(settings, number: int, entry: dict[str, Any]) -> None:
    part = settings.parts.add()
    part.number, part.name = number, entry["name"]
    part.closed, part.depth = bool(entry.get("closed", True)), float(entry.get("depth", 0.0))
    part.count = len(next(iter(entry.get("keys", {}).values()), []))
    part.extra = files.unknown_of_part(entry)
    ends.put(part, [(frame, ends.LOST) for frame in entry.get("wants_key", [])])


def _write_keys(ob, layer, project: dict[str, Any], material: int, plane: dict[int, np.ndarray]) -> None:
    """Writes the artist's strokes on the plane that points show. Farther parts come first, so that nearer ones are drawn over them."""
    offset, stamp = ob.rototoon.frame_offset, stamps.settled(ob)
    drawn: dict[int, list[tuple[float, int, bool, np.ndarray]]] = {}
    for number, entry in enumerate(project.get("parts", []), 1):
        for frame, points in by_frame(entry.get("keys")).items():
            row = (float(entry.get("depth", 0.0)), number, bool(entry.get("closed", True)), np.asarray(points, np.float64))
            drawn.setdefault(frame + offset, []).append(row)
    mapper = placement.Mapper(ob, drawn, plane, [layer.name])
    gp.make_frames(layer, sorted(drawn), gp.KEYFRAME)
    drawings = gp.drawings(layer)
    for frame, strokes in drawn.items():
        strokes.sort(key=lambda row: row[:2])
        rows = stroke_rows.Rows(np.array([len(points) for *_, points in strokes], np.int32))
        points = np.concatenate([points for *_, points in strokes])
        rows.values = {
            "position": mapper.at(0, frame).to_layer(points).astype(np.float32),
            "radius": gp.blank("radius", len(points)),
            "opacity": gp.blank("opacity", len(points)),
            "cyclic": np.array([closed for _, _, closed, _ in strokes]),
            "material_index": np.full(len(strokes), material, np.int32),
            gp.PART: np.array([number for _, number, _, _ in strokes], np.int32),
            gp.OWNER: np.full(len(strokes), stamp, np.int32),
            gp.CONTROL: np.concatenate([correspondence.identity(len(points)) for *_, points in strokes]),
        }
        stroke_rows.append(drawings[frame][0], rows)


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

"""Blender's scene as a project document, and a project document as strokes.

Document frames are picture numbers: the scene's frame minus the object's frame offset. Fields that are not known here
are kept as JSON on the object and its parts, and written back on export.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from . import contours, corrections, ends, footage, identity, snapping
from . import grease_pencil as gp
from .errors import Problem
from .placement import Mapper

VERSION = 1
_FOOTAGE = {"pattern", "first", "last", "fps", "width", "height"}
_PART = {"name", "closed", "depth", "keys", "pins", "centers", "tracks", "confidence", "curves", "wants_key"}
_TOP = {"rototoon", "footage", "parts"}


@dataclass
class Reading:
    """An object's contours, all that was decided about them, and the document that they make."""

    found: contours.Contours
    mapper: Mapper
    decisions: identity.Decisions
    corrections: dict[int, corrections.Corrections]
    document: dict[str, Any]
    folder: str


def read(ob, results: bool = False) -> Reading:
    """Reads an object; changes nothing. With `results`, tracks, confidence and snapped curves are in the document."""
    settings = ob.rototoon
    pattern = footage_pattern(ob)
    found = contours.read(ob)
    if not found.layer_names:
        name = settings.contours_layer
        raise Problem(f'"{ob.name}" has no layer "{name}": draw the contours on a layer of that name')
    mapper = mapper_of(ob, found)
    decisions = identity.decide(found, mapper, settings.next_number)
    corrected = corrections.detect(found, mapper)
    document = _extra(settings.extra)
    known = {
        "pattern": pattern,
        "first": settings.first,
        "last": settings.last,
        "fps": settings.fps,
        "width": settings.width,
        "height": settings.height,
    }
    document.update({"rototoon": VERSION, "footage": _extra(document.get("footage")) | known})
    document["parts"] = [
        _part(part, mapper, corrected[part.number], settings.frame_offset)
        for part in found.parts
        if part.keys
    ]
    if results:
        _add_results(ob, document, found, mapper)
    return Reading(found, mapper, decisions, corrected, document, os.path.dirname(pattern))


def footage_pattern(ob) -> str:
    """The absolute pattern of the object's footage; a `Problem` if its pictures are not there."""
    import bpy

    settings = ob.rototoon
    if not settings.pattern:
        raise Problem("No footage chosen: choose it in the panel Footage")
    if settings.pattern.startswith("//") and not bpy.data.filepath:
        raise Problem(f"The footage {settings.pattern} is relative to a file that is not saved: choose it again")
    pattern = os.path.normpath(bpy.path.abspath(settings.pattern))
    for number in (settings.first, settings.last):
        path = footage.picture(pattern, number)
        if not os.path.isfile(path):
            raise Problem(f"No picture {path}: the footage was moved or renamed; choose it again in the panel Footage")
    return pattern


def mapper_of(ob, found: contours.Contours) -> Mapper:
    """The mappings of an object's contour layers."""
    drawn: dict[int, list[np.ndarray]] = {}
    frames = {frame for _, frame in found.drawings}
    for (layer, _), drawing in found.drawings.items():
        drawn.setdefault(layer, []).extend(stroke.points for stroke in drawing.strokes if not stroke.made)
    points = {layer: np.concatenate(rows) for layer, rows in drawn.items() if rows}
    if frames:
        frames = range(min(frames), max(frames) + 1)
    return Mapper(ob, frames, points, found.layer_names)


def _extra(text: Any) -> dict[str, Any]:
    if isinstance(text, dict):
        return dict(text)
    return json.loads(text) if text else {}


def _part(part: contours.Part, mapper: Mapper, corrected: corrections.Corrections, offset: int) -> dict[str, Any]:
    keys = {}
    for frame in sorted(part.keys):
        stroke = part.keys[frame]
        points = mapper.at(stroke.layer, frame).to_pixels(stroke.control_points(part.closed))
        keys[str(frame - offset)] = points.tolist()
    entry = _extra(part.extra)
    entry.update({"name": part.name, "closed": part.closed, "depth": part.depth, "keys": keys})
    pins = {
        str(frame - offset): {str(i): point.tolist() for i, point in sorted(points.items())}
        for frame, points in sorted(corrected.pins.items())
    }
    centers = {str(frame - offset): point.tolist() for frame, point in sorted(corrected.centers.items())}
    if pins:
        entry["pins"] = pins
    if centers:
        entry["centers"] = centers
    return entry


def _add_results(ob, document: dict[str, Any], found: contours.Contours, mapper: Mapper) -> None:
    offset = ob.rototoon.frame_offset
    curves = snapping.read(ob)
    for entry, part in zip(document["parts"], [part for part in found.parts if part.keys], strict=True):
        first, last = min(part.keys), max(part.keys)
        if first == last:
            first, last = _around(part, first)
            wanted = _wanted(ob, part)
            if wanted:
                entry["wants_key"] = wanted
        if last > first and all(f in part.made or f in part.keys for f in range(first, last + 1)):
            tracks, confidence = {}, {}
            for frame in range(first, last + 1):
                label = str(frame - offset)
                if frame in part.keys:
                    tracks[label], confidence[label] = entry["keys"][label], [1.0] * part.count
                    continue
                stroke = part.made[frame]
                tracks[label] = mapper.at(stroke.layer, frame).to_pixels(stroke.points).tolist()
                sure = found.drawings[stroke.layer, frame].value(gp.CONFIDENCE)[stroke.span]
                confidence[label] = sure.astype(np.float64).tolist()
            entry["tracks"], entry["confidence"] = tracks, confidence
        paths = {
            str(frame - offset): [path.tolist() for path in segments]
            for (number, frame), segments in sorted(curves.items())
            if number == part.number
        }
        if paths:
            entry["curves"] = paths


def _around(part: contours.Part, key: int) -> tuple[int, int]:
    """First and last of the frames around a part's only key that have its contour without a gap."""
    first, last = key, key
    while first - 1 in part.made:
        first -= 1
    while last + 1 in part.made:
        last += 1
    return first, last


def _wanted(ob, part: contours.Part) -> list[int]:
    """Pictures on which a part was lost."""
    item = next((item for item in ob.rototoon.parts if item.number == part.number), None)
    return ends.wanted(item) if item is not None else []


# -- from a file ----------------------------------------------------------------------------------------------------


def load(path: str) -> dict[str, Any]:
    """A document from a file, its form checked as far as strokes are made of it."""
    try:
        with open(path, encoding="utf-8") as file:
            document = json.load(file)
    except OSError as error:
        raise Problem(f"Cannot read {path}: {error.strerror}") from error
    except ValueError as error:
        raise Problem(f"{path} is not a project document: {error}") from error
    try:
        check(document)
    except Problem as problem:
        raise Problem(f"{path}: {problem}") from None
    return document


def check(document: Any) -> None:
    """A `Problem` that names the field unless `document` has the form of a project document."""
    version = document.get("rototoon") if isinstance(document, dict) else None
    if not isinstance(version, int):
        raise Problem('not a project document: no field "rototoon" with a version number')
    if version > VERSION:
        raise Problem(f"document of version {version}; this Rototoon knows version {VERSION}: update the extension")
    shot = document.get("footage")
    if not isinstance(shot, dict) or not isinstance(shot.get("pattern"), str):
        raise Problem("footage.pattern: expected a file name pattern")
    for name in ("first", "last", "width", "height"):
        if not isinstance(shot.get(name), int):
            raise Problem(f"footage.{name}: expected a whole number, found {shot.get(name)!r}")
    if not isinstance(document.get("parts", []), list):
        raise Problem("parts: expected a list")
    names = set()
    for index, part in enumerate(document.get("parts", [])):
        _check_part(f"parts[{index}]", part, names)


def _check_part(place: str, part: Any, names: set[str]) -> None:
    if not isinstance(part, dict) or not isinstance(part.get("name"), str):
        raise Problem(f"{place}.name: expected a name")
    if part["name"] in names:
        raise Problem(f"{place}.name: {part['name']!r} is the name of another part")
    names.add(part["name"])
    counts = set()
    for field in ("keys", "tracks"):
        for frame, points in _frames(place, field, part.get(field)):
            array = _points(f"{place}.{field}[{frame}]", points)
            counts.add(len(array))
    if len(counts) > 1:
        raise Problem(f"{place}: keys and tracks have different numbers of points: {sorted(counts)}")
    for field in ("pins", "centers", "confidence", "curves"):
        list(_frames(place, field, part.get(field)))


def _frames(place: str, field: str, entries: Any):
    if entries is None:
        return
    if not isinstance(entries, dict):
        raise Problem(f"{place}.{field}: expected frames, found {type(entries).__name__}")
    for frame, value in entries.items():
        try:
            yield int(frame), value
        except ValueError:
            raise Problem(f"{place}.{field}: {frame!r} is not a frame number") from None


def _points(place: str, points: Any) -> np.ndarray:
    try:
        array = np.asarray(points, np.float64)
    except (TypeError, ValueError):
        array = None
    if array is None or array.ndim != 2 or array.shape[1] != 2 or not np.isfinite(array).all():
        raise Problem(f"{place}: expected points [x, y] of finite numbers")
    return array


def by_frame(entries: Mapping[str, Any] | None) -> dict[int, Any]:
    """An entry by frame number."""
    return {int(frame): value for frame, value in sorted((entries or {}).items(), key=lambda item: int(item[0]))}


def unknown(entry: Mapping[str, Any], known: set[str]) -> str:
    """The fields that are not known here, as JSON; empty if there are none."""
    rest = {name: value for name, value in entry.items() if name not in known}
    return json.dumps(rest) if rest else ""


def unknown_of_document(document: Mapping[str, Any]) -> str:
    """The unknown fields of the document and of its footage."""
    rest = {name: value for name, value in document.items() if name not in _TOP}
    shot = {name: value for name, value in document["footage"].items() if name not in _FOOTAGE}
    if shot:
        rest["footage"] = shot
    return json.dumps(rest) if rest else ""


def unknown_of_part(entry: Mapping[str, Any]) -> str:
    """The unknown fields of a part."""
    return unknown(entry, _PART)


def save(path: str, document: dict[str, Any]) -> None:
    """Writes a document, its footage relative to its folder where that is near; the file appears whole or not at all."""
    folder = os.path.dirname(os.path.abspath(path))
    shot = dict(document["footage"])
    near = os.path.relpath(shot["pattern"], folder)
    if near.count("..") <= 3:
        shot["pattern"] = near.replace(os.sep, "/")
    unfinished = f"{path}.{os.getpid()}.unfinished"
    try:
        with open(unfinished, "w", encoding="utf-8") as file:
            json.dump({**document, "footage": shot}, file, allow_nan=False, separators=(",", ":"))
            file.write("\n")
        os.replace(unfinished, path)
    except OSError as error:
        raise Problem(f"Cannot write {path}: {error.strerror}") from error
    finally:
        if os.path.exists(unfinished):
            os.remove(unfinished)

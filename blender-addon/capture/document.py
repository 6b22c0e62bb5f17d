"""An object's contours as a project document.

Frames of the document are picture numbers: the scene's frame minus the object's frame offset. The object and its parts keep unknown
fields of an imported document as JSON, and they are in the document again.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..blender import footage
from ..blender import grease_pencil as gp
from ..blender.errors import Problem
from ..blender.placement import Mapper
from ..common import jobs, kept
from ..common.wording import listed
from . import absence, contours, corrections, ends, identity, part_names, snapping

VERSION = 1


@dataclass
class Reading:
    """An object's contours, the decisions about new strokes, and the document."""

    found: contours.Contours
    mapper: Mapper
    decisions: identity.Decisions
    corrections: dict[int, corrections.Corrections]
    document: dict[str, Any]
    folder: str
    offset: int
    """From picture numbers to scene frames."""
    missing: dict[str, list[int]] = field(default_factory=dict)
    """By part the scene frames without its contour within its track, as where the artist deleted it. Only with results."""
    left: list[str] = field(default_factory=list)
    """Limbs and marks that the document has not, since they name a part without contours."""


def read(ob, results: bool = False, needed: bool = True, gaps: bool = False) -> Reading:
    """Reads an object. Changes nothing. With `results`, the document has tracks, confidence and snapped curves. Tracks from which contours are
    missing are left out, unless `gaps` are wanted. Raises `Problem` if there is no layer of contours, unless they are not `needed`: then the
    document may have no parts."""
    found = jobs.drained(reading(ob, results, needed))
    if not gaps:
        leave_out_missing(found)
    return found


def reading(ob, results: bool = False, needed: bool = True) -> Iterator[float]:
    """As `read` with `gaps`, in steps between which Blender may draw. Returns the reading. Raises `Changed` as `contours.reading` does."""
    settings = ob.rototoon
    pattern = footage.pattern_of(ob)
    found = yield from contours.reading(ob, (gp.CONFIDENCE,) if results else ())
    if not found.layer_names and needed:
        name = settings.contours_layer
        raise Problem(f'"{ob.name}" has no layer "{name}": draw the contours on a layer of that name')
    mapper = mapper_of(ob, found)
    yield 0.0
    decisions = identity.decide(found, mapper, settings.next_number)
    yield 0.0
    corrected = corrections.detect(found, mapper, settles=settings.moved_line == "SETTLE")
    yield 0.0
    document = kept.fields(settings.extra)
    known = footage.fields(ob, pattern)
    document.update({"rototoon": VERSION, "footage": kept.fields(document.get("footage")) | known})
    document["parts"] = [
        _part(part, mapper, corrected[part.number], settings.frame_offset)
        for part in found.parts
        if part.keys
    ]
    document, left = part_names.among(document, {part.name for part in found.parts if part.keys})
    made = Reading(found, mapper, decisions, corrected, document, os.path.dirname(pattern), settings.frame_offset, left=left)
    if results:
        _add_results(ob, made)
    return made


def leave_out_missing(reading: Reading) -> str:
    """Takes tracks out of the document from which contours are missing: a document has those on every frame. Of a part with one key, the frames
    up to the missing ones stay. Returns what the artist is told."""
    missing = reading.missing
    parts = {part.name: part for part in reading.found.parts}
    for entry in reading.document["parts"]:
        if entry["name"] in missing:
            _cut_track(entry, parts[entry["name"]], missing[entry["name"]], reading.offset)
    said = ", ".join(f'"{name}", since its contours on {listed(frames)} are missing' for name, frames in missing.items())
    return f"tracks are left out: {said}; Track draws them again" if said else ""


def _cut_track(entry: dict[str, Any], part: contours.Part, missing: list[int], offset: int) -> None:
    if len(part.keys) > 1:
        del entry["tracks"], entry["confidence"]
        return
    (key,) = part.keys
    after, before = max([-np.inf, *(f for f in missing if f < key)]), min([np.inf, *(f for f in missing if f > key)])
    for name in ("tracks", "confidence"):
        entry[name] = {label: values for label, values in entry[name].items() if after < int(label) + offset < before}


def need_pictures(ob, reading: Reading) -> None:
    """Raises a `Problem` if a key lies where the footage has no picture."""
    settings = ob.rototoon
    first, last = settings.first + settings.frame_offset, settings.last + settings.frame_offset
    beyond = {}
    for part in reading.found.parts:
        for frame, stroke in part.keys.items():
            if not first <= frame <= last:
                beyond.setdefault(reading.found.layer_names[stroke.layer], set()).add(frame)
    if beyond:
        where = ", ".join(f'on the layer "{name}" on {listed(sorted(frames))}' for name, frames in beyond.items())
        raise Problem(f"The footage has no picture for the contours {where}: delete or move them; it has frames {first} to {last}")


DECIMALS = 4
"""Of pixels that were computed, in files. What the artist made is written exactly."""


def round_off(project: dict[str, Any]) -> None:
    """Rounds computed coordinates as the core does when it saves. Points of keys and pins stay, so tracks contain them exactly."""
    for entry in project["parts"]:
        for frame, points in entry.get("tracks", {}).items():
            if frame not in entry["keys"]:
                pins = entry.get("pins", {}).get(frame, {})
                made = {int(i): place for i, place in pins.items() if points[int(i)] == place}
                entry["tracks"][frame] = [made.get(i, point) for i, point in enumerate(_rounded(points))]
        for frame, values in entry.get("confidence", {}).items():
            entry["confidence"][frame] = _rounded(values)
        for frame, paths in entry.get("curves", {}).items():
            entry["curves"][frame] = [_rounded(path) for path in paths]


def _rounded(values: list) -> list:
    # Without a zero that is negative.
    return (np.asarray(values, np.float64).round(DECIMALS) + 0.0).tolist()


def reach(project: dict[str, Any]) -> list[int]:
    """Lets the footage of a document go on to its last contour, if it is one picture: a drawing on it that was reshaped moves on before that
    picture, which is held. Returns the frames of contours that longer footage does not reach; those are in no picture and no shape."""
    shot = project["footage"]
    numbers = {int(label) for part in project["parts"] for label in part.get("tracks", ())}
    if numbers and shot["first"] == shot["last"] < max(numbers):
        shot["last"], shot["gaps"] = max(numbers), footage.HELD
    return sorted(number for number in numbers if not shot["first"] <= number <= shot["last"])


def _need_places(found: contours.Contours) -> None:
    """Raises a `Problem` if a point of a line is no number."""
    for (layer, frame), drawing in found.drawings.items():
        if not np.isfinite(drawing.points).all():
            where = f'A line on frame {frame} of the layer "{found.layer_names[layer]}"'
            raise Problem(f"{where} has a point without a place (not a number): delete the line, and draw it again")


def mapper_of(ob, found: contours.Contours, *more: int) -> Mapper:
    """The mappings of an object's contour layers, on the frames of all drawings, those between them, and `more`."""
    frames = {frame for _, frame in found.drawings} | set(more)
    return mapper_on(ob, found, range(min(frames), max(frames) + 1) if frames else ())


def mapper_on(ob, found: contours.Contours, frames: Iterable[int]) -> Mapper:
    """The same on some frames alone. Through a camera that moves, each frame costs a look at the whole scene."""
    _need_places(found)
    return Mapper(ob, frames, drawn_points(found), found.layer_names)


def drawn_points(found: contours.Contours) -> dict[int, np.ndarray]:
    """The artist's points by the index of their layer. They show the plane on which the artist drew."""
    drawn: dict[int, list[np.ndarray]] = {}
    for (layer, _), drawing in found.drawings.items():
        drawn.setdefault(layer, []).extend(stroke.points for stroke in drawing.strokes if not stroke.made)
    return {layer: np.concatenate(rows) for layer, rows in drawn.items() if rows}


def _part(part: contours.Part, mapper: Mapper, corrected: corrections.Corrections, offset: int) -> dict[str, Any]:
    keys = {}
    for frame in sorted(part.keys):
        stroke = part.keys[frame]
        points = mapper.at(stroke.layer, frame).to_pixels(stroke.control_points(part.closed))
        keys[str(frame - offset)] = points.tolist()
    entry = kept.fields(part.extra)
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


def _add_results(ob, reading: Reading) -> None:
    offset = ob.rototoon.frame_offset
    found, curves = reading.found, snapping.read(ob)
    for entry, part in zip(reading.document["parts"], [part for part in found.parts if part.keys], strict=True):
        item = next((item for item in ob.rototoon.parts if item.number == part.number), None)

        def hidden(frame: int, item=item, part=part) -> bool:
            return item is not None and frame not in part.keys and absence.is_hidden(item, frame - offset)

        first, last = min(part.keys), max(part.keys)
        if first == last:
            first, last = min([first, *part.made]), max([last, *part.made])
            wanted = _wanted(ob, part)
            if wanted:
                entry["wants_key"] = wanted
        there = [frame for frame in range(first, last + 1) if not hidden(frame)]
        missing = [frame for frame in there if frame not in part.made and frame not in part.keys]
        if last > first and (not missing or any(frame in part.made for frame in there)):
            _add_track(entry, part, [frame for frame in there if frame not in missing], reading, offset)
            if missing:
                reading.missing[part.name] = missing
        paths = {
            str(frame - offset): [path.tolist() for path in segments]
            for (number, frame), segments in sorted(curves.items())
            if number == part.number
        }
        if paths:
            entry["curves"] = paths


def _add_track(entry: dict[str, Any], part: contours.Part, frames: list[int], reading: Reading, offset: int) -> None:
    tracks, confidence = {}, {}
    for frame in frames:
        label = str(frame - offset)
        if frame in part.keys:
            tracks[label], confidence[label] = entry["keys"][label], [1.0] * part.count
            continue
        stroke = part.made[frame]
        tracks[label] = reading.mapper.at(stroke.layer, frame).to_pixels(stroke.points).tolist()
        sure = reading.found.drawings[stroke.layer, frame].value(gp.CONFIDENCE)[stroke.span]
        confidence[label] = sure.astype(np.float64).tolist()
    entry["tracks"], entry["confidence"] = tracks, confidence


def _wanted(ob, part: contours.Part) -> list[int]:
    """Picture numbers on which a part was lost."""
    item = next((item for item in ob.rototoon.parts if item.number == part.number), None)
    return ends.wanted(item) if item is not None else []

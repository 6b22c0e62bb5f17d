"""An object's contours as a project document.

Frames of the document are picture numbers: the scene's frame minus the object's frame offset. The object and its parts keep unknown
fields of an imported document as JSON, and they are in the document again.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..blender import footage
from ..blender import grease_pencil as gp
from ..blender.errors import Problem
from ..blender.placement import Mapper
from ..common import jobs, kept
from ..common.wording import listed
from . import absence, contours, corrections, ends, identity, snapping

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


def read(ob, results: bool = False, needed: bool = True) -> Reading:
    """Reads an object. Changes nothing. With `results`, the document has tracks, confidence and snapped curves. Raises `Problem` if
    there is no layer of contours, unless they are not `needed`: then the document may have no parts."""
    return jobs.drained(reading(ob, results, needed))


def reading(ob, results: bool = False, needed: bool = True) -> Iterator[float]:
    """As `read`, in steps between which Blender may draw. Returns the reading. Raises `Changed` as `contours.reading` does."""
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
    if results:
        _add_results(ob, document, found, mapper)
    return Reading(found, mapper, decisions, corrected, document, os.path.dirname(pattern))


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
    _need_places(found)
    drawn: dict[int, list[np.ndarray]] = {}
    frames = {frame for _, frame in found.drawings} | set(more)
    for (layer, _), drawing in found.drawings.items():
        drawn.setdefault(layer, []).extend(stroke.points for stroke in drawing.strokes if not stroke.made)
    points = {layer: np.concatenate(rows) for layer, rows in drawn.items() if rows}
    if frames:
        frames = range(min(frames), max(frames) + 1)
    return Mapper(ob, frames, points, found.layer_names)


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


def _add_results(ob, document: dict[str, Any], found: contours.Contours, mapper: Mapper) -> None:
    offset = ob.rototoon.frame_offset
    curves = snapping.read(ob)
    for entry, part in zip(document["parts"], [part for part in found.parts if part.keys], strict=True):
        item = next((item for item in ob.rototoon.parts if item.number == part.number), None)

        def hidden(frame: int, item=item, part=part) -> bool:
            return item is not None and frame not in part.keys and absence.is_hidden(item, frame - offset)

        first, last = min(part.keys), max(part.keys)
        if first == last:
            first, last = _around(part, first, hidden)
            wanted = _wanted(ob, part)
            if wanted:
                entry["wants_key"] = wanted
        there = [frame for frame in range(first, last + 1) if not hidden(frame)]
        if last > first and all(f in part.made or f in part.keys for f in there):
            tracks, confidence = {}, {}
            for frame in there:
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


def _around(part: contours.Part, key: int, hidden: Callable[[int], bool]) -> tuple[int, int]:
    """First and last frame around a part's only key, up to the first frame without its contour on which it is not hidden."""
    first, last = key, key
    low, high = min([key, *part.made]), max([key, *part.made])
    while first > low and (first - 1 in part.made or hidden(first - 1)):
        first -= 1
    while last < high and (last + 1 in part.made or hidden(last + 1)):
        last += 1
    return first, last


def _wanted(ob, part: contours.Part) -> list[int]:
    """Picture numbers on which a part was lost."""
    item = next((item for item in ob.rototoon.parts if item.number == part.number), None)
    return ends.wanted(item) if item is not None else []

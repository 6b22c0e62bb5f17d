"""A drawing's contours on every frame of a clip, as generated strokes after the drawing's key.

The drawing does not change. The motion begins on the frame after it, on generated frames, which Clear Generated removes. Strokes
keep the radius, colours, material and fill of the drawing.

A contour that the artist corrected on a generated frame stays as it is there, as with Track. All its points become pins, since the rest of
another clip's contour would not fit those that were moved. Release Pins lets it follow again. One on a frame that the clip does not reach
stays too. Those that only were tracked go.

Where the artist marked a part as hidden, the motion has no contour of it. The mark stays, and is named.
"""

from __future__ import annotations

import copy
from dataclasses import dataclass
from typing import Any

import numpy as np
from rototoon import documents

from ..blender import grease_pencil as gp
from ..blender import guard, placement
from ..blender.errors import Problem
from ..capture import absence, corrections, document, identity, writing
from . import limbs


@dataclass
class Drawing:
    """The drawing that is reshaped."""

    uid: int
    inputs: dict[str, Any]
    """The object's document at the beginning. It must be the same at the end."""
    project: dict[str, Any]
    """The document of the drawing: its contours on one frame, with limbs."""
    frame: int
    """The drawing's frame in the scene."""
    idle: str
    """Which marks have no effect, as a warning; empty if all have."""


def begin(ob, frame: int) -> Drawing:
    """The drawing at a frame: the last frame up to it on which every part has a key."""
    reading = document.read(ob)
    idle = limbs.needed(ob, reading.document)
    offset = ob.rototoon.frame_offset
    keys = [sorted(part.keys) for part in reading.found.parts if part.keys]
    known = {number for frames in keys for number in frames}
    before = [number for number in known if number <= frame and all(number in frames for frames in keys)]
    if not before:
        raise Problem(f"No frame up to {frame} has a key of every part: go to the drawing that you want to reshape")
    rest = max(before)
    if max(known) > rest:
        raise Problem(f"Frame {max(known)} has a key after the drawing on frame {rest}: reshape a drawing without later keys")
    project = copy.deepcopy(reading.document)
    for part in project["parts"]:
        part["keys"] = {str(rest - offset): part["keys"][str(rest - offset)]}
        # Where parts are hidden is seen to when the frames are written.
        for name in ("pins", "centers", "tracks", "confidence", "curves", "wants_key", "absent"):
            part.pop(name, None)
    # The drawing's key is the artist's, whatever an imported document says.
    project.pop("reshaped", None)
    return Drawing(ob.session_uid, reading.document, project, rest, idle)


@dataclass
class Written:
    """What was written."""

    frames: int
    """The number of frames."""
    kept: dict[str, list[int]]
    """By part the frames on which the artist's corrections stay."""
    hidden: dict[str, list[int]]
    """By part the frames of the motion on which it is marked as hidden."""


def finish(ob, drawing: Drawing, made) -> Written:
    """Writes the result, on hidden layers too, not on locked ones."""
    guard.need(ob)
    reading = document.read(ob)
    if reading.document != drawing.inputs:
        raise Problem("The drawing changed while it was reshaped, so the result was dropped: do it again")
    identity.write(ob, reading.found, reading.decisions)
    reading = document.read(ob)
    tracks, frames = _tracks(reading, drawing, made.document)
    hidden = _without_hidden(tracks, ob)
    names, kept = reading.found.layer_names, _kept(reading, drawing.frame)
    if not reading.mapper.still:
        points = {index: _drawn(reading, index) for index in range(len(names))}
        reading.mapper = placement.Mapper(ob, {drawing.frame, *frames, *(f for own in kept.values() for f in own.pins)}, points, names)
    _hold(tracks, kept, reading)
    by_number = {part.number: copy.copy(part) for part in reading.found.parts}
    for part in by_number.values():
        # Styles come from the drawing only.
        part.keys = {drawing.frame: part.keys[drawing.frame]} if drawing.frame in part.keys else {}
        part.layer = part.keys[drawing.frame].layer if part.keys else part.layer
    parts = [part for part in by_number.values() if part.keys]
    for index, name in enumerate(names):
        if index in reading.found.closed:
            continue
        block = writing.lay_out(index, parts, tracks, reading.found, reading.mapper, kept)
        block.order = _order(block, index, parts, tracks, (made.document, drawing.frame + 1))
        writing.hide(block, ob, index, reading.found)
        layer = gp.find_layer(ob, name)
        writing.write(layer, block, list(gp.drawings(layer)))
    ob.data.update_tag()
    names_of = {part.number: part.name for part in reading.found.parts}
    stay = {names_of[number]: sorted(each.pins) for number, each in kept.items() if each.pins}
    return Written(len(frames), stay, {names_of[number]: on for number, on in hidden.items()})


def _without_hidden(tracks: dict[int, writing.Track], ob) -> dict[int, list[int]]:
    """Takes the frames out of tracks on which their part is marked as hidden. Returns these frames by part."""
    found, offset = {}, ob.rototoon.frame_offset
    for item in ob.rototoon.parts:
        track = tracks.get(item.number)
        if track is None:
            continue
        there = np.array([not absence.is_hidden(item, int(frame) - offset) for frame in track.frames])
        if there.all():
            continue
        found[item.number] = track.frames[~there].tolist()
        tracks[item.number] = writing.Track(track.frames[there], track.points[there], track.confidence[there])
    return found


def _kept(reading: document.Reading, rest: int) -> dict[int, corrections.Corrections]:
    """By part the contours that the artist corrected on generated frames after the drawing, with all their points as pins."""
    corrected = {place: drawing.corrected() for place, drawing in reading.found.drawings.items()}
    found = {}
    for part in reading.found.parts:
        own = found[part.number] = corrections.Corrections()
        for frame, stroke in part.made.items():
            if frame > rest and stroke.layer not in reading.found.closed and corrected[stroke.layer, frame][stroke.index]:
                points = reading.mapper.at(stroke.layer, frame).to_pixels(stroke.points)
                own.pins[frame], own.held[frame] = dict(enumerate(points)), stroke.points
    return found


def _hold(tracks: dict[int, writing.Track], kept: dict[int, corrections.Corrections], reading: document.Reading) -> None:
    """Gives tracks the frames on which a corrected contour stays, also those that the clip does not reach."""
    for number, own in kept.items():
        track = tracks.get(number)
        known = set() if track is None else set(track.frames.tolist())
        beyond = sorted(own.pins.keys() - known)
        if not beyond:
            continue
        points = np.stack([np.stack(list(own.pins[frame].values())) for frame in beyond])
        frames, sure = np.array(beyond), np.ones(points.shape[:2])
        if track is not None:
            frames = np.concatenate([track.frames, frames])
            points, sure = np.concatenate([track.points, points]), np.concatenate([track.confidence, sure])
        order = np.argsort(frames)
        tracks[number] = writing.Track(frames[order], points[order], sure[order])


def _order(block: writing.Block, layer: int, parts, tracks, result: tuple[dict[str, Any], int]) -> np.ndarray:
    """The block's parts from back to front on each frame. `result` is the document that was made, and the scene frame of its first picture."""
    project, begin = result
    columns = sorted((p for p in parts if p.number in tracks and p.layer == layer), key=lambda p: p.depth)
    shift = begin - project["footage"]["first"]
    rows = {int(frame): row for row, frame in enumerate(block.frames)}
    entries = {part["name"]: part for part in project["parts"]}
    depths = np.empty((len(block.frames), len(columns)))
    for column, part in enumerate(columns):
        entry = entries[part.name]
        depths[:, column] = entry.get("depth", 0.0)
        for frame, depth in documents.by_frame(entry.get("depths")).items():
            if frame + shift in rows:
                depths[rows[frame + shift], column] = depth
    return np.argsort(depths, axis=1, kind="stable")


def _drawn(reading: document.Reading, layer: int) -> np.ndarray:
    drawings = [d for (index, _), d in reading.found.drawings.items() if index == layer]
    return np.concatenate([d.points for d in drawings]) if drawings else np.zeros((0, 3))


def _tracks(reading: document.Reading, drawing: Drawing, project: dict[str, Any]):
    first = project["footage"]["first"]
    shift = drawing.frame + 1 - first
    numbers = {part.name: part.number for part in reading.found.parts}
    tracks, frames = {}, []
    for part in project["parts"]:
        by_frame = documents.by_frame(part.get("tracks"))
        if not by_frame:
            continue
        frames = [frame + shift for frame in by_frame]
        points = np.array(list(by_frame.values()), np.float64)
        sure = np.ones(points.shape[:2])
        tracks[numbers[part["name"]]] = writing.Track(np.array(frames), points, sure)
    if not tracks:
        raise Problem("Nothing was reshaped: no closed contour on the drawing")
    return tracks, frames

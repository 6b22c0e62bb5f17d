"""Contours as data: parts, keys, tracks in pixels and in the world, and where keys are wanted. Changes nothing.

Linked objects can be read too. Strokes without a part are left out: `track` and the operator Match Contours give them one.
"""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np

from ..blender import grease_pencil as gp
from ..blender import guard
from ..capture import contours, document, exchanged
from ..capture import unseen as part_unseen
from ..capture import ends as track_ends
from ..capture.doubt import weakest
from ..common.operators import OnContours
from .refusing import need, told


@dataclass(frozen=True)
class Part:
    """A part of the list of parts."""

    name: str
    number: int
    """The number that its strokes carry in the attribute `rototoon_part`."""
    closed: bool
    depth: float
    """Larger is nearer to the viewer."""
    points: int
    """Number of control points."""
    layer: str
    """The layer of its strokes."""
    keys: tuple[int, ...]
    """Frames of the artist's keys, rising."""
    tracked: tuple[int, ...]
    """Frames of generated contours, rising."""


@dataclass(frozen=True)
class Track:
    """A part's contours, keys and generated ones, on F frames with N control points."""

    frames: np.ndarray
    """Scene frames, int32 (F,), rising. They may have gaps."""
    pixels: np.ndarray
    """Footage pixels, float64 (F, N, 2)."""
    world: np.ndarray
    """The same points in the world, in scene units, float64 (F, N, 3)."""
    confidence: np.ndarray
    """float64 (F, N), 0 to 1; 1 on keys."""
    is_key: np.ndarray
    """bool (F,): whether the artist drew the contour."""
    closed: bool


@dataclass(frozen=True)
class End:
    """Where the track of a part with a single key ends before the footage does."""

    part: str
    frame: int
    """The first frame beyond the track."""
    reason: str
    """``lost``: the part needs a key there. ``cut``: another shot begins there. ``left``: the part left the picture."""


@dataclass(frozen=True)
class Exchange:
    """Two parts that look alike and may have changed places."""

    parts: tuple[str, str]
    """Their names."""
    frames: tuple[int, ...]
    """Frames on which nothing says which is which, rising. A key or a pin there does."""


@told
def parts(ob: bpy.types.Object) -> list[Part]:
    """The parts of an object, in the order of its list."""
    need(ob, OnContours, guard.NOTHING)
    found = contours.read(ob)
    return [
        Part(
            part.name,
            part.number,
            part.closed,
            part.depth,
            part.count,
            _layer_of(found, part),
            tuple(sorted(part.keys)),
            tuple(sorted(set(part.made) - set(part.keys))),
        )
        for part in found.parts
    ]


def _layer_of(found: contours.Contours, part: contours.Part) -> str:
    stroke = next(iter([*part.keys.values(), *part.made.values()]), None)
    return found.layer_names[stroke.layer if stroke is not None else part.layer]


@told
def tracks(ob: bpy.types.Object) -> dict[str, Track]:
    """The contours of all parts that have any, by name. Points go round as on the keys."""
    need(ob, OnContours, guard.NOTHING)
    found = contours.read(ob, (gp.CONFIDENCE,))
    mapper = document.mapper_of(ob, found)
    return {part.name: _track(part, found, mapper) for part in found.parts if part.keys or part.made}


def _track(part: contours.Part, found: contours.Contours, mapper) -> Track:
    strokes = [part.keys.get(frame) or part.made[frame] for frame in sorted({*part.keys, *part.made})]
    pixels, world, sure = [], [], []
    for stroke in strokes:
        points = np.asarray(stroke.control_points(part.closed), np.float64)
        mapping = mapper.at(stroke.layer, stroke.frame)
        matrix = np.linalg.inv(mapping.view.to_view) @ mapping.to_view
        pixels.append(mapping.to_pixels(points))
        world.append(points @ matrix[:3, :3].T + matrix[:3, 3])
        value = found.drawings[stroke.layer, stroke.frame].value(gp.CONFIDENCE)[stroke.span] if stroke.made else None
        sure.append(np.ones(part.count) if value is None else value.astype(np.float64))
    is_key = np.array([stroke.frame in part.keys for stroke in strokes])
    frames = np.array([stroke.frame for stroke in strokes], np.int32)
    return Track(frames, np.stack(pixels), np.stack(world), np.stack(sure), is_key, part.closed)


@told
def ends(ob: bpy.types.Object) -> list[End]:
    """The ends that the last Track found, by part and frame. Parts with two keys or more have none."""
    need(ob, OnContours, guard.NOTHING)
    offset = ob.rototoon.frame_offset
    return [End(item.name, frame + offset, reason) for item in ob.rototoon.parts for frame, reason in track_ends.of(item)]


@told
def exchanges(ob: bpy.types.Object) -> list[Exchange]:
    """Parts that may have changed places, as the last Track found them."""
    need(ob, OnContours, guard.NOTHING)
    return [Exchange(pair.parts, pair.frames) for pair in exchanged.of(ob)]


@told
def unseen(ob: bpy.types.Object) -> dict[str, list[int]]:
    """By part the frames on which it can probably not be seen, as the last Track found them, without those on which it is marked as hidden."""
    need(ob, OnContours, guard.NOTHING)
    return {question.part: list(question.frames) for question in part_unseen.questions(ob)}


def wanted_keys(ob: bpy.types.Object) -> dict[str, list[int]]:
    """By part the frames on which it was lost, and needs a key. Empty if every part could be followed."""
    wanted: dict[str, list[int]] = {}
    for end in ends(ob):
        if end.reason == track_ends.LOST:
            wanted.setdefault(end.part, []).append(end.frame)
    return wanted


@told
def lost_frames(ob: bpy.types.Object) -> dict[str, list[int]]:
    """By part the frames of the footage without its contour, from where it was lost to the end of the footage on that side."""
    need(ob, OnContours, guard.NOTHING)
    settings, lost = ob.rototoon, {}
    first, last = settings.first + settings.frame_offset, settings.last + settings.frame_offset
    for part in contours.read(ob).parts:
        wanted = wanted_keys(ob).get(part.name, [])
        have = {*part.keys, *part.made}
        if wanted and have:
            frames = {f for frame in wanted for f in (range(first, frame + 1) if frame < min(have) else range(frame, last + 1))}
            lost[part.name] = sorted(frames - have)
    return lost


@told
def weakest_frame(ob: bpy.types.Object) -> tuple[int, float]:
    """The frame where the next key helps most, and its doubt (0 to 1). As the operator Go to Weakest Frame, which also goes
    there."""
    need(ob, OnContours, guard.NOTHING)
    return weakest(ob, contours.read(ob, (gp.CONFIDENCE,)))

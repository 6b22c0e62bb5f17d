"""What one run follows and traces: groups of layers, each with a document for the library.

Layers whose drawings are on the same frames are followed together, as one drawing. A drawing of the library is a complete one, so a
layer that has no drawing on some frame of the others makes a group of its own. New strokes are drawn by one group alone, that of the layer for them: each
group looks for all lines of the film.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from rototoon.lines import Traced

from ..blender import colours, footage, stroke_lines
from ..blender import grease_pencil as gp
from ..blender import strokes as st
from ..blender.errors import Problem
from ..blender.placement import Mapper
from . import drawings as dr
from . import numbers, plane

VERSION = 1


@dataclass
class Seed:
    """Strokes of a drawing that are followed."""

    keys: list[numbers.Key]
    sources: list[tuple[int, int]]
    """For each stroke its layer, as an index in the group, and its index in the drawing."""


@dataclass
class Group:
    """Layers that are followed together."""

    layers: list[dr.Layer]
    seeds: dict[int, Seed]
    """By scene frame."""
    pictures: tuple[int, int]
    """Numbers of the first and the last picture to trace: all pictures from and to which strokes are carried."""
    document: dict[str, Any]
    folder: str
    mapper: Mapper
    new: bool = False
    """Whether ink that no stroke explains makes new strokes."""
    keep_first: bool = False
    """Whether the first of the pictures was traced for itself by an earlier run, and stays so."""


@dataclass
class Plan:
    """A run: its groups, and what it writes."""

    groups: list[Group]
    first: int
    """First scene frame that is written."""
    last: int
    offset: int
    """The scene shows picture n on frame n + offset."""
    hold: bool = True
    """Whether a frame with the same picture as the one before holds its drawing."""
    held: set[int] = field(default_factory=set)
    """The scene frames of such pictures, once they are known."""
    inks: dict[int, Traced] = field(default_factory=dict)
    """By scene frame of a drawing of the artist the lines of its own picture, once they are known."""
    sums: dict[str, dict[int, int]] = field(default_factory=dict)
    """Checksums of the artist's drawings, to see whether they change during the work."""


def film(ob) -> tuple[int, int]:
    """First and last scene frame of an object's footage."""
    settings = ob.rototoon
    return settings.first + settings.frame_offset, settings.last + settings.frame_offset


def make(ob, layers: list[dr.Layer], first: int, last: int, home: str) -> Plan:
    """A plan for the scene frames `first` to `last`. `home` is the layer on which ink that no stroke explains makes new strokes; empty if it makes
    none. Other layers without a drawing to follow are left out."""
    pattern = footage.pattern_of(ob)
    low, high = film(ob)
    first, last = max(first, low), min(last, high)
    if first > last:
        raise Problem(f"There are no pictures on these frames: the footage is on frames {low} to {high}")
    by_frames: dict[tuple[int, ...], list[dr.Layer]] = {}
    for layer in layers:
        seeds = _seeds_of(layer, first, last, (low, high))
        if seeds or layer.name == home:
            by_frames.setdefault(tuple(seeds), []).append(layer)
    if not by_frames:
        raise Problem("There are no strokes to carry: draw them on a frame of the footage first")
    groups = [_group(ob, own, frames, first, last, pattern, home) for frames, own in by_frames.items()]
    return Plan(groups, first, last, ob.rototoon.frame_offset, sums={layer.name: layer.sums() for layer in layers})


def of_picture(layer: dr.Layer, frame: int, path: str, size: tuple[int, int], mapper) -> Plan:
    """A plan for a single picture file, whose name is a pattern with one number, 1. It is drawn on one frame."""
    shown = {"pattern": path, "first": 1, "last": 1, "fps": 24.0, "width": size[0], "height": size[1]}
    document = {"rototoon": VERSION, "footage": shown, "parts": [], "drawings": []}
    group = Group([layer], {}, (1, 1), document, os.path.dirname(path), mapper, new=True)
    return Plan([group], frame, frame, frame - 1, sums={layer.name: layer.sums()})


def find_held(plan: Plan) -> None:
    """Finds the pictures that are the same file as the one before, as in films on twos. Uses no Blender."""
    if plan.hold and plan.groups:
        plan.held |= held_pictures(plan.groups[0].document["footage"], plan.first, plan.last, plan.offset)


def held_pictures(shown: Mapping[str, Any], first: int, last: int, offset: int) -> set[int]:
    """The scene frames after the first whose picture is the same file as the one before. The scene shows picture n on frame n + offset.

    `shown` is the footage in the form of a document. It may say that a frame without a file holds the picture before it.
    """
    held: set[int] = set()
    before: tuple[int, bytes] | None = None
    for frame in range(first, last + 1):
        path = footage.picture(shown["pattern"], frame - offset)
        try:
            size = os.path.getsize(path)
            with open(path, "rb") as file:
                now = size, hashlib.file_digest(file, "blake2b").digest()
        except OSError as error:
            if isinstance(error, FileNotFoundError) and shown.get("gaps") == footage.HELD:
                held |= {frame} - {first}
                continue
            # The library says which picture is missing.
            return held
        if now == before:
            held.add(frame)
        before = now
    return held


def needed(layer: dr.Layer, first: int, last: int) -> set[int]:
    """The traced drawings whose content a plan for these frames needs: the nearest ones outside."""
    known = [*layer.keys, *layer.made]
    before = max((frame for frame in known if frame < first), default=None)
    after = min((frame for frame in known if frame > last), default=None)
    return {frame for frame in (before, after) if frame in layer.made}


def _seeds_of(layer: dr.Layer, first: int, last: int, shown: tuple[int, int]) -> list[int]:
    """The frames whose strokes are followed: the artist's drawings within, and the nearest drawing on either side."""
    inside = [frame for frame in layer.keys if first <= frame <= last]
    known = [*layer.keys, *(frame for frame, content in layer.made.items() if len(content.sizes))]
    around = [
        max((frame for frame in known if shown[0] <= frame < first), default=None),
        min((frame for frame in known if last < frame <= shown[1]), default=None),
    ]
    return sorted({*inside, *(frame for frame in around if frame is not None)})


def _group(ob, layers: list[dr.Layer], frames: tuple[int, ...], first: int, last: int, pattern: str, home: str) -> Group:
    names = [layer.name for layer in layers]
    points = {k: _points(ob, layer, frames) for k, layer in enumerate(layers)}
    low, high = min([first, *frames]), max([last, *frames])
    mapper = Mapper(ob, range(low, high + 1), {k: each for k, each in points.items() if len(each)}, names)
    offset, seeds, drawn = ob.rototoon.frame_offset, {}, []
    for frame in frames:
        seed, strokes = _drawing(ob, layers, frame, mapper)
        if strokes:
            seeds[frame] = seed
            drawn.append({"frame": frame - offset, "strokes": strokes})
    document = {"rototoon": VERSION, "footage": footage.fields(ob, pattern), "parts": [], "drawings": drawn}
    new = home in names
    keep_first = new and low not in seeds and any(low in layer.sure for layer in layers)
    return Group(layers, seeds, (low - offset, high - offset), document, os.path.dirname(pattern), mapper, new, keep_first)


def _points(ob, layer: dr.Layer, frames: Iterable[int]) -> np.ndarray:
    contents = [_content(layer, frame) for frame in frames]
    rows = [c.point["position"] for c in contents if len(c.sizes)]
    rows = [each[np.isfinite(each).all(1)] for each in rows]
    return np.concatenate(rows) if rows else plane.points(ob, layer.name)


def _content(layer: dr.Layer, frame: int) -> st.Content:
    return layer.keys.get(frame) or layer.made.get(frame) or dr.EMPTY


def _drawing(ob, layers: list[dr.Layer], frame: int, mapper: Mapper) -> tuple[Seed, list[dict[str, Any]]]:
    """The strokes of all layers on a frame, lowest layer first. Strokes that are no lines are left out: the library could not follow
    them."""
    seed, strokes = Seed([], []), []
    palette = colours.palette(ob)
    for k, layer in enumerate(layers):
        content = _content(layer, frame)
        if not len(content.sizes):
            continue
        seen = colours.of_strokes(ob, content, palette)
        tracks, closed = content.strokes(gp.TRACK), content.strokes("cyclic")
        fills = st.solid(ob, content)
        mapping = mapper.at(k, frame)
        for i, line in enumerate(stroke_lines.lines(content)):
            line = line[:-1] if closed[i] and len(line) > 2 and np.array_equal(line[0], line[-1]) else line
            if len(line) < 2 or not np.isfinite(line).all():
                continue
            seed.keys.append((layer.name, int(tracks[i])))
            seed.sources.append((k, i))
            pixels = np.round(mapping.to_pixels(line), 4)
            stroke = {"points": pixels.tolist(), "closed": bool(closed[i]), "colour": seen[i].clip(0, 1).tolist()}
            if fills[i]:
                stroke["fill"] = True
            strokes.append(stroke)
    return seed, strokes

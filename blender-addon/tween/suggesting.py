"""The frame on which a breakdown helps most.

In-betweens are drawn as In-between would draw them, and thrown away. Where the object has footage, they are laid on its pixels and
compared with its pictures, as with a line test. Layers with other keys make a group of their own: each group is judged by itself.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from rototoon import Strokes, tween

from ..blender import footage, stroke_lines
from ..blender import strokes as st
from ..blender.placement import Mapper
from . import between, tweening

Line = tuple[np.ndarray, bool]
"""Points (N, 2), and whether the line is closed."""
ToPixels = Callable[[str, int, np.ndarray], np.ndarray]
"""Pixels of a layer's points on a scene frame."""


@dataclass
class Pictures:
    """The footage of an object."""

    written: dict[str, Any]
    """In the form of documents."""
    folder: str
    offset: int
    """The scene shows picture n on frame n + offset."""


@dataclass
class Group:
    """The drawings of layers with the same keys, by scene frame."""

    keys: set[int] = field(default_factory=set)
    lines: dict[int, list[Line]] = field(default_factory=dict)


def pictures_of(ob) -> Pictures | None:
    """The footage of an object; `None` if none was chosen. Raises a `Problem` if its pictures are missing."""
    settings = ob.rototoon
    if not settings.pattern:
        return None
    pattern = footage.pattern_of(ob)
    return Pictures(footage.fields(ob, pattern), os.path.dirname(pattern), settings.frame_offset)


def to_pixels(ob, plan: tweening.Plan, pictures: Pictures | None) -> ToPixels | None:
    """The map to the footage's pixels. `None` without footage: then drawings are measured on their own plane."""
    if pictures is None:
        return None
    names = sorted({name for call in plan.calls for name in call.sheet.layers})
    frames = {frame for call in plan.calls for frame in range(call.sheet.frames[0], call.sheet.frames[-1] + 1)}
    points = {names.index(layer): found for layer, found in _points(plan).items() if len(found)}
    mapper = Mapper(ob, frames, points, names)
    return lambda layer, frame, points: mapper.at(names.index(layer), frame).to_pixels(points)


def _points(plan: tweening.Plan) -> dict[str, np.ndarray]:
    """By layer the points of its keys."""
    found: dict[str, list[np.ndarray]] = {}
    for call in plan.calls:
        for contents in call.sheet.contents.values():
            for name, content in zip(call.sheet.layers, contents):
                points = content.point["position"] if len(content.sizes) else np.zeros((0, 3))
                found.setdefault(name, []).append(points[np.isfinite(points).all(1)])
    return {name: np.concatenate(each) for name, each in found.items()}


def groups(plan: tweening.Plan, pixels: ToPixels | None) -> list[Group]:
    """The keys and in-betweens of a drawn plan."""
    found = []
    for call in plan.calls:
        group = Group()
        for frame, layer, content in _contents(call):
            points = content.point["position"]
            flat = _flat(call, layer, points) if pixels is None else pixels(layer, frame, points)
            group.lines.setdefault(frame, []).extend(_lines(content, flat))
        for span in call.spans:
            group.keys |= {call.sheet.frames[span], call.sheet.frames[span + 1]}
        found.append(group)
    return found


def _contents(call: tweening.Call) -> Iterator[tuple[int, str, st.Content]]:
    """Frame, layer and content of each drawing of a call: its lines, with all points finite."""
    sheet = call.sheet
    for key in sorted({key for span in call.spans for key in (span, span + 1)}):
        for layer, content in zip(sheet.layers, sheet.contents[key]):
            yield sheet.frames[key], layer, _as_lines(content)
    for block in between.blocks(sheet, call.laid, call.spans, call.drawn):
        for row, frame in enumerate(block.frames):
            content = block.content
            changed = {name: values[row] for name, values in block.changing.items() if name in content.point}
            point = {**content.point, **changed, "position": block.positions[row]}
            yield frame, block.layer, _as_lines(st.Content(content.sizes, content.types, point, content.curve))


def _as_lines(content: st.Content) -> st.Content:
    """The lines that Blender draws for strokes, as strokes of their points."""
    lines = [line for line in stroke_lines.lines(content) if len(line) and np.isfinite(line).all()]
    points = np.concatenate(lines) if lines else np.zeros((0, 3))
    return st.Content(np.array([len(line) for line in lines], np.int32), np.zeros(len(lines), np.int8), {"position": points})


def _flat(call: tweening.Call, layer: str, points: np.ndarray) -> np.ndarray:
    """Places on the plane of a sheet, in units of its layers."""
    sheet = call.sheet
    return sheet.plane.flat(points, sheet.layers.index(layer))[0] / sheet.plane.scale


def _lines(content: st.Content, flat: np.ndarray) -> list[Line]:
    # The line of a closed stroke ends where it begins.
    return [(line, False) for line in np.split(flat, np.cumsum(content.sizes)[:-1])] if len(content.sizes) else []


def suggested(
    groups: list[Group], pictures: Pictures | None, progress: tween.Progress, threads: int
) -> tween.Breakdown | None:
    """The best suggestion over all groups, in scene frames. Uses no Blender."""
    offset = 0 if pictures is None else pictures.offset
    found = []
    for k, group in enumerate(groups):

        def told(share: float, step: str, k: int = k) -> bool | None:
            return progress((k + share) / len(groups), step)

        given = (pictures.written, pictures.folder) if pictures is not None else (None, "")
        keys = [frame - offset for frame in group.keys]
        found.append(tween.suggest_breakdown(_drawings(group, offset), keys, *given, told, threads=threads))
    return max((each for each in found if each is not None), key=_worth, default=None)


def _worth(found: tween.Breakdown) -> tuple[bool, float]:
    return found.by == "picture", found.distance - (found.keys or 0.0)


def _drawings(group: Group, offset: int) -> tween.Drawings:
    frames = sorted(group.lines)
    lines = [line for frame in frames for line in group.lines[frame]]
    sizes = np.cumsum([0] + [len(points) for points, _ in lines])
    points = np.concatenate([points for points, _ in lines]) if lines else np.zeros((0, 2))
    bounds = np.cumsum([0] + [len(group.lines[frame]) for frame in frames])
    strokes = Strokes(
        sizes.astype(np.int32),
        np.ascontiguousarray(points, np.float64),
        np.array([closed for _, closed in lines], np.uint8),
    )
    return tween.Drawings(strokes, bounds.astype(np.int32), np.array([frame - offset for frame in frames], np.int32))


def sentence(found: tween.Breakdown, offset: int) -> str:
    """The suggestion for the artist."""
    first, last = found.first + offset, found.last + offset
    text = f"A breakdown helps most on frame {found.frame + offset}, between the keys {first} and {last}: "
    if found.by == "picture":
        return text + f"the in-between is {found.distance:.1f} px off the picture, the keys {found.keys:.1f} px"
    text += "it is the middle of the span that moves most"
    if found.foreign is not None:
        return text + f". The footage shows something else: the keys are {found.foreign:.1f} px off it"
    return text + ". No picture shows the movement"


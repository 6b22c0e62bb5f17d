"""What becomes of each drawing of an object. Changes nothing.

A drawing is the artist's if its frame is no generated one, if it has a stroke of the artist, or if the artist has changed it: a mark, a checksum, a
pin or a moved point says so. It goes to one frame, also if its picture was drawn again, since only the artist can say whether it still fits. On such
a frame, generated contours without a correction are left out, for Track makes them again. Of two drawings that meet on one frame, the one whose own
frame it is stays there. Contours of the other one join it if it has none of their part, as where one key was drawn on each of two frames with one
picture. The rest, and a drawing whose picture is gone, is left over. On layers without contours a drawing is held until the next one, so it goes to the
first picture on which it is held where its own is gone or has another drawing. An empty one, which ends the drawing before it, gives way to any other.

A generated drawing goes to all frames that show its picture as it was, or that of a frame on which it was held. Contours get a drawing on each of
them; on other layers neighbouring frames hold the first one. Where a new drawing follows, or one that was drawn again, an empty generated drawing
ends the result, for Blender would show it on. In-betweens go along with the frames of their two keys, because they are drawn from these.

Where the first or the last key of a part is left over, the nearest contour that was tracked becomes its key, so that the part does not end early.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from ..blender import grease_pencil as gp
from ..blender import holds, marks
from ..blender import strokes as st
from ..blender.errors import Changed
from ..capture import contours
from ..lines import moved as moved_lines
from ..lines import records as line_records
from ..paint import sheets
from ..tween import keys as tween_keys
from ..tween import moved_keys
from ..tween import records as tween_records
from . import layers
from .times import Times

FLAT = 1e-4
"""Share of a layer's extent up to which a point lies on the front plane. Where most points do, the others must not tilt the plane."""


@dataclass
class Drawing:
    """A drawing, and what becomes of it."""

    frame: int
    content: st.Content
    artists: bool
    """Whether it has something of the artist. Otherwise it is a result."""
    marked: bool = False
    """Whether it is as it was generated, by its mark."""
    targets: list[int] = field(default_factory=list)
    """The frames on which it will be; none if it is left out."""
    aside: int | None = None
    """The frame on the hidden layer, if it is left over."""
    results: list[int] = field(default_factory=list)
    """Its generated contours without a correction, as indices."""
    drop: bool = False
    """Whether these are left out."""
    keys: dict[int, list[int]] = field(default_factory=dict)
    """By target the strokes that become keys."""
    blank: bool = False
    """Whether there is nothing on it that could be lost."""
    joined: int | None = None
    """The frame on which some of its contours join another drawing."""
    joining: list[int] = field(default_factory=list)
    """These contours, as indices."""

    @property
    def places(self) -> list[int]:
        """All frames on which something of it will be."""
        return [*self.targets, *(frame for frame in (self.joined, self.aside) if frame is not None)]

    def own(self) -> list[int]:
        """The strokes of the artist on a drawing with contours, as indices."""
        return sorted(set(range(len(self.content.sizes))) - set(self.results))

    def where(self, stroke: int) -> list[int]:
        """The frames on which a contour will be a contour still."""
        return [self.joined] if stroke in self.joining else self.targets


@dataclass
class Layer:
    """A layer that goes along."""

    name: str
    drawings: list[Drawing]
    lines: line_records.Layer | None
    spans: dict[int, tuple[tuple[int, int], tween_records.Span]]
    """The recorded spans of in-betweens by their first frame, with their new frames. Spans that lost a key are left out."""
    next_track: int
    broken: list[tuple[int, int]]
    """Spans that lost a key, by their old frames."""
    held: set[int]
    """New frames that hold the drawing before them."""
    ends: list[int]
    """New frames with an empty generated drawing, where a result would be shown on."""
    again: list[int]
    """New frames on which results were left out, since the drawing was drawn again."""

    def points(self) -> np.ndarray:
        """The points that show the plane of the drawing: the artist's if there are any."""
        own = [drawing.content.point["position"] for drawing in self.drawings if drawing.artists]
        every = own or [drawing.content.point["position"] for drawing in self.drawings]
        points = np.concatenate(every) if every else np.zeros((0, 3))
        points = points[np.isfinite(points).all(1)]
        if not len(points):
            return points
        flat = np.abs(points[:, 1]) <= FLAT * np.abs(points - points.mean(0)).max()
        return points[flat] if flat.mean() >= 0.5 else points


@dataclass
class Plan:
    """What becomes of an object."""

    layers: list[Layer]
    replaced: list[tuple[str, int, int]] = field(default_factory=list)
    """Parts of which a key was left over, with its frame and that of the contour that takes its place."""
    parts: dict[tuple[str, int], list[str]] = field(default_factory=dict)
    """Names of the parts with a key on a drawing, by layer and old frame."""


def making(ob, times: Times) -> Iterator[float]:
    """Makes the plan, in steps between which Blender may draw. Returns the plan."""
    found = yield from contours.reading(ob)
    corrected = {place: drawing.corrected() for place, drawing in found.drawings.items()}
    index = {name: k for k, name in enumerate(found.layer_names)}
    lines = moved_lines.read(ob, [layer.name for layer in layers.ours(ob)])
    tween, plan = tween_records.read(ob.data), Plan([])
    for name in [layer.name for layer in layers.ours(ob)]:
        yield 0.0
        spans = Spans(gp.find_layer(ob, name), tween.get(name), times)
        drawings = yield from _reading(ob, name, spans)
        if name in index:
            for drawing in drawings:
                place = index[name], drawing.frame
                if place not in found.drawings:
                    raise Changed()
                _sort_contours(drawing, found.drawings[place], corrected[place])
        held = _place(ob, name, drawings, spans, times, name in index)
        ends, again = _ends(drawings, spans, times), _again(drawings, times)
        plan.layers.append(Layer(name, drawings, lines.get(name), spans.alive, spans.next_track, spans.broken, held, ends, again))
    _replace_keys(plan, found, index)
    names = {(found.layer_names[stroke.layer], frame): [] for part in found.parts for frame, stroke in part.keys.items()}
    for part in found.parts:
        for frame, stroke in part.keys.items():
            names[found.layer_names[stroke.layer], frame].append(part.name)
    plan.parts = names
    return plan


class Spans:
    """The spans of in-betweens on a layer."""

    def __init__(self, layer, record: tween_records.Layer | None, times: Times):
        self.alive: dict[int, tuple[tuple[int, int], tween_records.Span]] = {}
        self.broken: list[tuple[int, int]] = []
        self.next_track = 1 if record is None else record.next_track
        found = tween_keys.frames_of(layer, record or tween_records.Layer())
        self.made = set(found.made)
        if record is None:
            return
        record = moved_keys.followed(layer, record, found.keys).record
        following = dict(pairwise(sorted(gp.frame_numbers(layer))))
        for first, span in record.spans.items():
            # As in `_place`: a key whose own picture is gone is where it was held.
            ends = [next(iter(times.went_while(key, following.get(key))), None) for key in (first, span.last)]
            if ends[0] is None or ends[1] is None or ends[0] >= ends[1]:
                self.broken.append((first, span.last))
            else:
                self.alive[first] = (ends[0], ends[1]), span

    def target(self, frame: int, times: Times) -> int | None:
        """Where an in-between goes; `None` if it is left out."""
        if any(first < frame < last for first, last in self.broken):
            return None
        new = times.went(frame)
        around = [ends for first, (ends, span) in self.alive.items() if first < frame < span.last]
        return new if new is None or not around or any(a < new < b for a, b in around) else None


def _reading(ob, name: str, spans: Spans) -> Iterator[float]:
    """Reads the drawings of a layer, in steps as `contours.reading` does. Returns them in time order."""
    slots, painted, found = marks.Slots(ob.data), name == ob.rototoon.fills_layer, []
    waiting = sorted(gp.drawings(gp.find_layer(ob, name)))
    while waiting:
        until = time.perf_counter() + contours.SLICE
        with gp.copied(ob.data) as data:
            layer = gp.find_layer_of(data, name)
            drawings = {} if layer is None else gp.drawings(layer)
            while waiting and time.perf_counter() < until:
                frame = waiting.pop(0)
                if frame not in drawings:
                    raise Changed()
                handle, kind = drawings[frame]
                content = st.read(handle)
                same = marks.untouched(content, slots)
                made = kind == gp.GENERATED and (frame in spans.made or _is_result(content, same, slots if painted else None))
                found.append(Drawing(frame, content, not made, marked=same is True, blank=not len(content.sizes)))
        yield 0.0
    return found


def _is_result(content: st.Content, same: bool | None, painted: marks.Slots | None) -> bool:
    """Whether a drawing on a generated frame is as it was generated. Without a mark, as on contours, the strokes tell.
    `painted` are the material slots where it is paint."""
    if painted is not None:
        return bool(sheets.made_of(content, painted).all())
    made, tracked = content.strokes(gp.MADE) | content.strokes(gp.TWEENED), content.point.get(gp.TRACKED)
    moved = tracked is not None and same is not True and not np.array_equal(tracked, content.point["position"])
    return same is not False and bool(made.all()) and not moved


def _sort_contours(drawing: Drawing, read: contours.Drawing, corrected: np.ndarray) -> None:
    """Tells the artist's contours from results."""
    own = [stroke.index for stroke in read.strokes if not stroke.made or corrected[stroke.index]]
    drawing.results = [stroke.index for stroke in read.strokes if stroke.made and not corrected[stroke.index]]
    drawing.artists = bool(own) or read.kind != gp.GENERATED
    drawing.blank = not own if drawing.artists else not drawing.results


def _place(ob, name: str, drawings: list[Drawing], spans: Spans, times: Times, contoured: bool) -> set[int]:
    """Gives each drawing its frames. Returns new frames that hold the drawing before them."""
    noted, there = holds.read(ob.data, name), {drawing.frame for drawing in drawings}
    taken: set[int] = set()
    held: set[int] = set()
    numbers: dict[int, set[int]] = {}
    following = {one.frame: other.frame for one, other in pairwise(sorted(drawings, key=lambda each: each.frame))}
    for drawing in sorted(drawings, key=lambda each: (not each.artists, each.blank and not contoured, not times.has_own(each.frame), each.frame)):
        if layers.is_left_over(name):
            new = times.went(drawing.frame)
            wanted = [drawing.frame + times.shift if new is None else new]
        elif drawing.artists and not contoured:
            free = [new for new in times.went_while(drawing.frame, following.get(drawing.frame)) if new not in taken]
            wanted = free[:1]
        elif drawing.artists or drawing.frame in spans.made:
            new = times.went(drawing.frame) if drawing.artists else spans.target(drawing.frame, times)
            wanted = [] if new is None else [new]
        else:
            wanted = _shown(drawing.frame, noted - there, times)
        if not drawing.artists and not contoured:
            held |= {new for new in wanted if new - 1 in wanted}
            wanted = [new for new in wanted if new - 1 not in wanted]
        drawing.targets = [new for new in wanted if new not in taken]
        taken |= set(drawing.targets)
        drawing.drop = any(new in times.redrawn for new in drawing.targets)
        if contoured and drawing.artists:
            _join(drawing, wanted, numbers)
        if drawing.artists and not drawing.targets and not drawing.blank and len(drawing.joining) < len(drawing.own()):
            drawing.aside, drawing.drop = drawing.frame + times.shift, True
    return held - taken


def _join(drawing: Drawing, wanted: list[int], numbers: dict[int, set[int]]) -> None:
    """Lets contours of a drawing join the one that has its frame. `numbers` are those of the parts that are on each frame already."""
    parts = drawing.content.strokes(gp.PART)
    for new in drawing.targets:
        numbers[new] = {int(parts[stroke]) for stroke in drawing.own()}
    for new in wanted if not drawing.targets else ():
        joining = {int(parts[stroke]): stroke for stroke in reversed(drawing.own()) if parts[stroke] and int(parts[stroke]) not in numbers[new]}
        if joining:
            drawing.joined, drawing.joining = new, sorted(joining.values())
            numbers[new] |= joining.keys()


def _shown(frame: int, held: set[int], times: Times) -> list[int]:
    """The new frames that show a result, rising. `held` are old frames that hold the drawing before them."""
    found, last = set(times.shown(frame)), frame
    while last + 1 in held:
        last += 1
        found |= set(times.shown(last))
    new = times.went(frame)
    if not found and new is not None and new not in times.redrawn:
        # Another frame that shows the same drawing.
        found = {new}
    return sorted(found)


def _ends(drawings: list[Drawing], spans: Spans, times: Times) -> list[int]:
    """The frames on which a result must not be shown on."""
    at = {new: not drawing.artists and drawing.frame not in spans.made and not drawing.blank for drawing in drawings for new in drawing.targets}
    found = []
    for new in sorted(times.redrawn | set(times.new)):
        before = max((frame for frame in at if frame <= new), default=None)
        if before is not None and before < new and at[before]:
            at[new] = False
            found.append(new)
    return found


def _again(drawings: list[Drawing], times: Times) -> list[int]:
    """The frames that were drawn again, and had a result."""
    left = {times.went(drawing.frame) for drawing in drawings if not drawing.artists and not drawing.targets}
    return sorted(times.redrawn & (left | {new for drawing in drawings if drawing.drop and drawing.results for new in drawing.targets}))


def _replace_keys(plan: Plan, found: contours.Contours, index: dict[str, int]) -> None:
    """Makes tracked contours keys where the first or the last key of a part is left over."""
    at = {(index[layer.name], drawing.frame): drawing for layer in plan.layers if layer.name in index for drawing in layer.drawings}
    for part in found.parts:
        keys = {new for frame, stroke in part.keys.items() for new in at[stroke.layer, frame].where(stroke.index)}
        made = {}
        for frame, stroke in part.made.items():
            drawing = at[stroke.layer, frame]
            if not (drawing.drop and stroke.index in drawing.results):
                made |= {new: (drawing, stroke.index) for new in drawing.targets}
        for side, end in ((min, min(part.keys, default=None)), (max, max(part.keys, default=None))):
            if end is None or at[part.keys[end].layer, end].where(part.keys[end].index) or (len(part.keys) == 1 and keys):
                continue
            new = side(made, default=None)
            if new is not None and new not in keys:
                drawing, stroke = made[new]
                drawing.keys.setdefault(new, []).append(stroke)
                keys.add(new)
                plan.replaced.append((part.name, end, new))

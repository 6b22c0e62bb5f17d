"""Parts of strokes: newly drawn strokes are matched to parts, or become new parts.

On a frame without tracked contours the matcher finds the whole figure. On a tracked frame each stroke is judged by itself: see `likeness`.

`decide` works in memory. `write` stores the decisions in the file, after the work that needed them has succeeded.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..blender import grease_pencil as gp
from ..blender import hierarchy
from ..blender.errors import Problem
from ..blender.placement import Mapper
from . import closing, correspondence, likeness, part_names, sessions, stamps
from .contours import Contours, Part, Stroke

CLOSING_GAP = 0.05
"""A stroke also counts as closed if the distance of its ends is less than this share of its length."""


@dataclass
class Decisions:
    """Decisions that are not yet in the file."""

    strokes: list[tuple[Stroke, Part, np.ndarray]] = field(default_factory=list)
    """A stroke, its part, and the control numbers of its drawn points."""
    created: list[Part] = field(default_factory=list)
    taken: list[tuple[int, str]] = field(default_factory=list)
    """Frame and part of the strokes that were matched to existing parts."""
    on_tracked: set[int] = field(default_factory=set)
    """Frames of new strokes that have tracked contours too."""
    doubts: list[str] = field(default_factory=list)
    """What the artist should look at: strokes that could be something else."""

    @property
    def matched(self) -> int:
        """Number of strokes that were matched to existing parts."""
        return len(self.taken)


def decide(found: Contours, mapper: Mapper, next_number: int) -> Decisions:
    """Gives every stroke without a part a part, in memory."""
    decisions = Decisions()
    for part in found.parts:
        _recount(part, found, decisions)
    loose, found.loose = found.loose, []
    for frame in sorted({stroke.frame for stroke in loose}):
        drawn = [stroke for stroke in loose if stroke.frame == frame]
        like: dict[int, str] = {}
        if any(frame in part.made for part in found.parts):
            decisions.on_tracked.add(frame)
            left, like = _recognise_tracked(found, drawn, frame, mapper, decisions)
        else:
            left = _recognise(found, drawn, frame, mapper, decisions)
        for stroke in left:
            part = _new_part(found, stroke, mapper, next_number + len(decisions.created))
            _assign(stroke, part, correspondence.identity(part.count), decisions)
            decisions.created.append(part)
            if id(stroke) in like:
                decisions.doubts.append(
                    f'frame {frame}: the new stroke is the new part "{part.name}", though it looks like "{like[id(stroke)]}"; if it is '
                    f'that, undo, delete the tracked contour of "{like[id(stroke)]}" there too, and try again'
                )
    for part in found.parts:
        for stroke in part.keys.values():
            if part.count > 1 and len(stroke.points) == part.count and not stroke.control.any():
                decisions.strokes.append((stroke, part, correspondence.identity(part.count)))
    _check_names(found)
    return decisions


def _recount(part: Part, found: Contours, decisions: Decisions) -> None:
    """Sets the number of control points of a part with one key to the number of points that the artist drew there."""
    if len(part.keys) != 1:
        return
    stroke = next(iter(part.keys.values()))
    if len(stroke.points) != part.count:
        part.count = len(stroke.points)
        found.old += part.made.values()
        part.made.clear()
        stroke.where, stroke.control = np.arange(part.count, dtype=np.float64), correspondence.identity(part.count)
        decisions.strokes.append((stroke, part, stroke.control))


def _recognise(
    found: Contours, drawn: list[Stroke], frame: int, mapper: Mapper, decisions: Decisions
) -> list[Stroke]:
    """Matches drawn strokes to parts that have no key on this frame. Returns the strokes without a match."""
    candidates = [part for part in found.parts if frame not in part.keys and (part.keys or part.made)]
    if not candidates:
        return drawn
    references = [_reference(part, frame, mapper) for part in candidates]
    shapes = [mapper.at(stroke.layer, frame).to_pixels(stroke.points) for stroke in drawn]
    left = set(range(len(drawn)))
    labels = [_labels(found, stroke) for stroke in drawn]
    for which, who, points in match(
        [(part.closed, points, _labels(found, _nearest(part, frame))) for part, points in zip(candidates, references, strict=True)],
        [(candidate_closed(stroke, shape), shape, own) for stroke, shape, own in zip(drawn, shapes, labels, strict=True)],
    ):
        if _take(candidates[which], drawn[who], shapes[who], points, decisions):
            left.discard(who)
    return [drawn[i] for i in sorted(left)]


def _take(part: Part, stroke: Stroke, shape: np.ndarray, points: np.ndarray, decisions: Decisions) -> bool:
    """Makes a stroke the part's key, by the part's points on it. Returns whether that is possible."""
    where = correspondence.locate(shape, points, part.closed)
    control = correspondence.invert(where, len(stroke.points), part.closed)
    if control is None or correspondence.invert(control, part.count, part.closed) is None:
        return False
    _assign(stroke, part, control.astype(np.float32), decisions)
    decisions.taken.append((stroke.frame, part.name))
    return True


def _recognise_tracked(
    found: Contours, drawn: list[Stroke], frame: int, mapper: Mapper, decisions: Decisions
) -> tuple[list[Stroke], dict[int, str]]:
    """As `_recognise`, on a frame with tracked contours. Also returns the parts that strokes without a match look like, by `id`."""
    candidates = [part for part in found.parts if frame not in part.keys and (part.keys or part.made)]
    shapes = [mapper.at(stroke.layer, frame).to_pixels(stroke.points) for stroke in drawn]
    strokes = [
        likeness.Drawn(candidate_closed(stroke, shape), shape, tuple(_labels(found, stroke)))
        for stroke, shape in zip(drawn, shapes, strict=True)
    ]
    judged, like = likeness.judge([_known(found, part, frame, mapper) for part in candidates], strokes, _match_alone)
    left = set(range(len(drawn)))
    for each in judged:
        part = candidates[each.part]
        if not _take(part, drawn[each.stroke], shapes[each.stroke], each.points, decisions):
            continue
        left.discard(each.stroke)
        if each.doubt:
            decisions.doubts.append(
                f'frame {frame}: the new stroke is taken as a key of "{part.name}", but {each.doubt}; if it is another part, undo, give '
                "it a material or a layer of its own, and try again"
            )
    return [drawn[i] for i in sorted(left)], {id(drawn[i]): name for i, name in like.items() if i in left}


def _known(found: Contours, part: Part, frame: int, mapper: Mapper) -> likeness.Known:
    there = part.made.get(frame)
    strokes = part.keys | part.made
    stroke = there or strokes[min(strokes, key=lambda other: (abs(other - frame), other))]
    points = mapper.at(stroke.layer, stroke.frame).to_pixels(stroke.control_points(part.closed))
    labels = frozenset(tuple(_labels(found, each)) for each in (part.keys or part.made).values())
    lost = there is not None and _confidence(found, there) < likeness.LOST
    return likeness.Known(part.name, part.closed, points, labels, there is not None, lost)


def _confidence(found: Contours, stroke: Stroke) -> float:
    drawing = found.drawings[stroke.layer, stroke.frame]
    return float(drawing.value(gp.CONFIDENCE)[stroke.span].mean()) if drawing.has(gp.CONFIDENCE) else 1.0


def _match_alone(part: likeness.Known, stroke: likeness.Drawn) -> np.ndarray | None:
    # The stroke is moved onto the part, so that what is left to find is the order of its points.
    shift = likeness.outline(part.points, part.closed)[0] - likeness.outline(stroke.points, stroke.closed)[0]
    for _, _, points in match([(part.closed, part.points, [])], [(stroke.closed, stroke.points + shift, [])]):
        return points - shift
    return None


def _reference(part: Part, frame: int, mapper: Mapper) -> np.ndarray:
    """The part's contour in pixels: the tracked one on `frame` if there is one, otherwise that of the nearest key."""
    stroke = part.made[frame] if frame in part.made else _nearest(part, frame)
    return mapper.at(stroke.layer, stroke.frame).to_pixels(stroke.control_points(part.closed))


def _nearest(part: Part, frame: int) -> Stroke:
    """The part's stroke on the key nearest to a frame."""
    strokes = part.keys or part.made
    return strokes[min(strokes, key=lambda other: (abs(other - frame), other))]


def _labels(found: Contours, stroke: Stroke) -> list[str]:
    """What the artist says of a stroke: its layer and its material. They tell look-alikes apart."""
    material = found.drawings[stroke.layer, stroke.frame].value("material_index")[stroke.index]
    return [found.layer_names[stroke.layer], str(int(material))]


def match(
    references: list[tuple[bool, np.ndarray, list[str]]], drawn: list[tuple[bool, np.ndarray, list[str]]]
) -> list[tuple[int, int, np.ndarray]]:
    """Matches of drawn contours: (index of the reference, index of the drawn contour, the reference's points on the drawn
    line)."""

    def plain(contours):
        return [{"closed": bool(closed), "points": points.tolist(), "labels": labels} for closed, points, labels in contours]

    answer = _asked({"references": plain(references), "drawn": plain(drawn)})
    return [(m["reference"], m["drawn"], np.asarray(m["points"], np.float64)) for m in answer["matches"]]


_answers: list[tuple[object, dict, dict]] = []
KEPT = 256
"""Number of answers that are kept. A drawing is matched again whenever the contours are read, until its parts are written."""


def _asked(request: dict) -> dict:
    """The matcher's answer. The last answers are kept, so what a thread has asked costs the main thread nothing."""
    matcher = sessions.matcher
    for known, asked, answer in reversed(_answers):
        if known is matcher and asked == request:
            return answer
    answer = matcher(request)
    _answers.append((matcher, request, answer))
    del _answers[:-KEPT]
    return answer


def candidate_closed(stroke: Stroke, shape: np.ndarray) -> bool:
    """Whether a drawn stroke is a closed contour."""
    if stroke.cyclic or len(shape) < 3:
        return stroke.cyclic
    length = np.linalg.norm(np.diff(shape, axis=0), axis=1).sum()
    return bool(np.linalg.norm(shape[-1] - shape[0]) < CLOSING_GAP * length)


def _new_part(found: Contours, stroke: Stroke, mapper: Mapper, number: int) -> Part:
    shape = mapper.at(stroke.layer, stroke.frame).to_pixels(stroke.points)
    names = {part.name for part in found.parts}
    label = number
    while f"Part {label}" in names:
        label += 1
    closed = candidate_closed(stroke, shape)
    part = Part(number, f"Part {label}", closed, _depth(found, stroke.layer), len(stroke.points), layer=stroke.layer)
    found.parts.append(part)
    return part


def _depth(found: Contours, layer: int) -> float:
    """A depth nearer than all parts of the same and lower layers, and farther than the parts of higher layers."""
    below = [part.depth for part in found.parts if part.layer <= layer]
    above = [part.depth for part in found.parts if part.layer > layer]
    low = max(below, default=None)
    if low is None:
        return min(above) - 1 if above else 0.0
    return (low + min(above)) / 2 if above and min(above) <= low + 1 and min(above) > low else low + 1


def _assign(stroke: Stroke, part: Part, control: np.ndarray, decisions: Decisions) -> None:
    stroke.part, stroke.control = part.number, control
    stroke.where = correspondence.invert(control, part.count, part.closed)
    if stroke.where is None:
        stroke.where = np.arange(part.count, dtype=np.float64)
    part.keys[stroke.frame] = stroke
    part.layer = stroke.layer
    decisions.strokes.append((stroke, part, control))


def _check_names(found: Contours) -> None:
    seen = set()
    for part in found.parts:
        if part.name in seen:
            raise Problem(f'Two parts are called "{part.name}": give one of them another name in the list of parts')
        seen.add(part.name)


NAMED = 4
"""Largest number of strokes that a message names."""


def named(decisions: Decisions, frames: set[int] | None = None) -> tuple[str, str]:
    """The matched strokes and the new parts by name, as texts; with `frames`, only those there. Empty where there are none."""
    made = [(frame, part.name) for part in decisions.created for frame in sorted(part.keys)[:1]]
    return _listing(decisions.taken, frames), _listing(made, frames)


def _listing(entries: list[tuple[int, str]], frames: set[int] | None) -> str:
    said = [f'"{name}" on {frame}' for frame, name in entries if frames is None or frame in frames]
    if len(said) > NAMED:
        said[NAMED:] = [f"{len(said) - NAMED} more"]
    return ", ".join(said)


def write(ob, found: Contours, decisions: Decisions) -> None:
    """Writes decisions into strokes and the object's list of parts. Parts without a stroke stay in the list: see `drop_empty`.

    Locked layers are not written. The decisions on their strokes are made again at each reading.
    """
    _give_stamp(ob, found)
    touched: dict[tuple[int, int], list[tuple[Stroke, Part, np.ndarray]]] = {}
    for entry in decisions.strokes:
        touched.setdefault((entry[0].layer, entry[0].frame), []).append(entry)
    for part in found.parts:
        # This generated stroke became a key.
        for stroke in part.keys.values():
            if found.drawings[stroke.layer, stroke.frame].value(gp.MADE)[stroke.index]:
                touched.setdefault((stroke.layer, stroke.frame), [])
    touched = {place: entries for place, entries in touched.items() if place[0] not in found.closed}
    for place, entries in touched.items():
        _write_drawing(found, place, entries)
    for index, name in enumerate(found.layer_names):
        types = {frame: gp.KEYFRAME for (layer, frame) in touched if layer == index}
        if not types:
            continue
        layer = gp.find_layer(ob, name)
        kinds = {frame: kind for frame, (_, kind) in gp.drawings(layer).items()}
        gp.set_keyframe_type(layer, {f: k for f, k in types.items() if kinds.get(f) == gp.GENERATED})
    write_parts(ob, found)


def _give_stamp(ob, found: Contours) -> None:
    """Gives the object a stamp of its own."""
    before, found.stamp = found.stamp, stamps.settled(ob)
    if found.stamp != before:
        for drawing in found.drawings.values():
            drawing.names = gp.names(drawing.handle)
            drawing.take(drawing.handle, gp.OWNER)


def _write_drawing(found: Contours, place: tuple[int, int], entries: list) -> None:
    drawing = found.drawings[place]
    numbers, owners, made, control = (drawing.value(name).copy() for name in (gp.PART, gp.OWNER, gp.MADE, gp.CONTROL))
    for stroke in drawing.strokes:
        if not stroke.made:
            made[stroke.index] = False
    for stroke, part, values in entries:
        numbers[stroke.index], owners[stroke.index] = part.number, found.stamp
        control[stroke.span] = values
    gp.put(drawing.handle, gp.PART, numbers)
    gp.put(drawing.handle, gp.OWNER, owners)
    gp.put(drawing.handle, gp.MADE, made)
    if made.any() or drawing.has(gp.BESIDE):
        # The frame is the artist's from now on.
        gp.put(drawing.handle, gp.BESIDE, made)
    gp.put(drawing.handle, gp.CONTROL, control)


def write_parts(ob, found: Contours) -> None:
    """Adds the parts of `found` that have strokes to the object's list of parts, and stores their numbers of points."""
    settings = ob.rototoon
    drawn = [part for part in found.parts if part.keys or part.made]
    have = {entry.number: entry for entry in settings.parts}
    for part in drawn:
        entry = have.get(part.number)
        if entry is None:
            entry = settings.parts.add()
            entry.number, entry.name = part.number, part.name
            with closing.lines_kept():
                entry.closed = part.closed
            entry.depth, entry.extra = part.depth, part.extra
        entry.count = part.count
    settings.next_number = max([settings.next_number] + [part.number + 1 for part in drawn])


def drop_empty(ob, found: Contours) -> str:
    """Removes parts without a stroke from the object's list of parts, and limbs and marks with them. Returns what is to be told of it; empty if
    there are none.

    For buttons only, whose message names the parts. Parts of which another layer has strokes stay: it may be a layer of contours with
    a new name.
    """
    settings = ob.rototoon
    drawn = {part.number for part in found.parts if part.keys or part.made}
    if all(item.number in drawn for item in settings.parts):
        return ""
    drawn |= _drawn_elsewhere(ob, found)
    gone = [(item.number, item.name) for item in settings.parts if item.number not in drawn]
    active = settings.active_part
    chosen = settings.parts[active].number if active < len(settings.parts) else 0
    for number, _ in gone:
        settings.parts.remove(next(index for index, item in enumerate(settings.parts) if item.number == number))
    numbers = [item.number for item in settings.parts]
    settings.active_part = numbers.index(chosen) if chosen in numbers else min(active, max(len(numbers) - 1, 0))
    if not gone:
        return ""
    lost = part_names.drop(ob, {name for _, name in gone})
    told = "; without a contour, and so no longer in the list: " + ", ".join(f'"{name}"' for _, name in gone)
    return told + (f"; gone with {'it' if len(gone) == 1 else 'them'}: {lost}" if lost else "")


def _drawn_elsewhere(ob, found: Contours) -> set[int]:
    """Numbers of the parts that have strokes on other layers than those of the contours and of results."""
    numbers: set[int] = set()
    snapped = ob.rototoon.snapped_layer
    names = {layer.name for layer in gp.every_layer(ob)} - {*found.layer_names, snapped, snapped + hierarchy.ASIDE}
    with gp.copied(ob.data) as data:
        for name in names:
            for handle in gp.handles(gp.find_layer_of(data, name)):
                if gp.has(handle, gp.PART):
                    numbers.update(gp.value(handle, gp.PART, len(gp.offsets(handle)) - 1).tolist())
    return numbers

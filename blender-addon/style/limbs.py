"""Limbs of a character, from short lines that the artist draws across its contours.

Each line on the limb layer marks one key point. Its ends are near the two sides of a limb, and the key point is between them. A limb
connects a key point that has a line with the nearest ancestor that has one. A key point may be drawn on several frames; between
these, the ends of its line slide along the contour. Which parts a limb carries is seen between its lines (`carried`). Lines carry the number of their key point in a stroke attribute, so they may be
moved and copied.

The limbs are kept in the field `limbs` of the object's document.
"""

from __future__ import annotations

import json
from typing import Any

import numpy as np
from rototoon.style import BODIES, Skeleton

from ..blender import grease_pencil as gp
from ..blender import placement, selection
from ..blender.errors import Problem
from ..capture import document, part_names
from ..common import kept
from . import bodies, carried

LAYER = "Limbs"
"""Name of the layer with the lines."""


def name_lines(ob, frame: int, point: str) -> int:
    """Gives a key point to the selected line of the limb layer, otherwise to the last line without one. Returns the number
    of lines."""
    handle = _drawing(ob, frame)
    strokes = len(gp.offsets(handle)) - 1
    numbers = gp.value(handle, gp.KEY_POINT, strokes)
    chosen = np.flatnonzero(selection.selected_strokes(handle))
    if len(chosen) == 0:
        chosen = np.flatnonzero(numbers == 0)[-1:]
    if len(chosen) == 0:
        raise Problem(f'Draw a short line across the limb on the layer "{LAYER}" first, or select one')
    if len(chosen) > 1:
        raise Problem(f"{len(chosen)} lines are selected, but a key point has one line: select one of them")
    number = bodies.of(ob).points.index(point) + 1
    # The new line replaces an older line of the key point.
    numbers[numbers == number] = 0
    numbers[chosen] = number
    gp.put(handle, gp.KEY_POINT, numbers)
    return len(chosen)


def _drawing(ob, frame: int):
    layer = gp.find_layer(ob, LAYER)
    if layer is None:
        raise Problem(f'"{ob.name}" has no layer "{LAYER}": add one and draw a short line across the limb there')
    drawings = {number: handle for number, (handle, _) in gp.drawings(layer).items() if number <= frame}
    if not drawings:
        raise Problem(f'The layer "{LAYER}" has no drawing on frame {frame}')
    return drawings[max(drawings)]


def define(ob, reading: document.Reading) -> list[dict[str, Any]]:
    """Makes the object's limbs from the lines on the limb layer, stores them with its document, and returns them."""
    lines = _lines(ob)
    if not lines:
        raise Problem(f'No line on the layer "{LAYER}" has a key point yet: choose one in Define Limbs')
    body = bodies.of(ob)
    ends = {point: _end(body.points[point], drawn, reading.document) for point, drawn in lines.items()}
    pairs = [(_ancestor(body, child, ends), child) for child in range(1, len(body.points)) if child in ends]
    pairs = [(parent, child) for parent, child in pairs if parent is not None]
    joints, hanging, made = bodies.joints(body), bodies.hanging(body), []
    parents = {parent for parent, _ in pairs}
    ways = [_way(lines[a], lines[b], b not in parents and body.points[b] in hanging) for a, b in pairs]
    for (parent, child), carries in zip(pairs, carried.of(ways, reading.document["parts"])):
        limb = {"from": body.points[parent], "to": body.points[child], "start": ends[parent], "end": ends[child]}
        near = [ends[end]["points"][0]["part"] for end in (parent, child)]
        if body.points[child] in joints:
            limb["carries"] = carries or near[:1]
        elif carries and set(carries) != set(near):
            limb["carries"] = carries
        made.append(limb)
    keep(ob, made)
    return made


def _way(start: dict[int, np.ndarray], end: dict[int, np.ndarray], is_last: bool) -> carried.Way | None:
    """A limb between its lines on the first frame that has both; `None` without such a frame."""
    frame = min(set(start) & set(end), default=None)
    if frame is None:
        return None
    width = float(np.linalg.norm(end[frame][1] - end[frame][0]))
    return carried.Way(frame, start[frame].mean(0), end[frame].mean(0), width, is_last)


def _ancestor(body: Skeleton, child: int, ends) -> int | None:
    """The nearest ancestor of a key point that has a line; `None` if there is none."""
    while child:
        child = body.parents[child]
        if child in ends:
            return child
    return None


def change_body(ob, given: str | dict[str, Any]) -> list[str]:
    """Gives an object a body by its name or definition. Lines and limbs stay where both bodies have their key points.

    Returns the key points whose lines mark nothing any more.
    """
    before, after = bodies.of(ob), bodies.named(given)
    lost = _renumber(ob, before, after)
    extra = _extra(ob)
    extra["skeleton"] = given
    if given == bodies.HUMAN:
        del extra["skeleton"]
    if "limbs" in extra:
        extra["limbs"] = [limb for limb in defined(ob) if _fits(after, limb)]
    ob.rototoon.extra = json.dumps(extra)
    return lost


def _renumber(ob, before: Skeleton, after: Skeleton) -> list[str]:
    layer = gp.find_layer(ob, LAYER)
    if layer is None:
        return []
    number_of = {name: number for number, name in enumerate(after.points, 1)}
    table = np.array([0, *(number_of.get(name, 0) for name in before.points)])
    lost: set[str] = set()
    for handle, _ in gp.drawings(layer).values():
        numbers = np.clip(gp.value(handle, gp.KEY_POINT, len(gp.offsets(handle)) - 1), 0, len(before.points))
        lost |= {before.points[number - 1] for number in numbers if number and not table[number]}
        gp.put(handle, gp.KEY_POINT, table[numbers])
    return sorted(lost)


def _fits(body: Skeleton, limb: dict[str, Any]) -> bool:
    """Whether a body has both key points of a limb, the first above the second."""
    if limb["from"] not in body.points or limb["to"] not in body.points:
        return False
    above = body.points.index(limb["to"])
    while above and body.points[above] != limb["from"]:
        above = body.parents[above]
    return body.points[above] == limb["from"]


def count_lines(ob) -> int:
    """Number of key points with a line."""
    return len(_lines(ob))


def keep(ob, made: list[dict[str, Any]]) -> None:
    """Stores limbs in the object's document."""
    extra = _extra(ob)
    extra["limbs"] = made
    ob.rototoon.extra = json.dumps(extra)


def marks(ob) -> list[dict[str, Any]]:
    """The object's marks of what is in front of what."""
    return kept.rows(_extra(ob).get("depth_marks"), "front", "behind")


def add_mark(ob, mark: dict[str, Any]) -> None:
    """Adds a mark to the object's document. It replaces an opposite one on the same frames."""
    extra = _extra(ob)
    opposite = {**mark, "front": mark["behind"], "behind": mark["front"]}
    others = [known for known in marks(ob) if known not in (mark, opposite)]
    extra["depth_marks"] = [*others, mark]
    ob.rototoon.extra = json.dumps(extra)


def _extra(ob) -> dict[str, Any]:
    return kept.fields(ob.rototoon.extra)


def defined(ob) -> list[dict[str, Any]]:
    """The object's limbs."""
    return kept.rows(_extra(ob).get("limbs"), "from", "to")


def body_name(ob) -> str:
    """The name of the object's body, for a panel."""
    given = _extra(ob).get("skeleton", bodies.HUMAN)
    name = given if isinstance(given, str) else str(kept.fields(given).get("name", "?"))
    return name.title() if name in BODIES else name


def needed(ob, project: dict[str, Any]) -> str:
    """Raises a `Problem` if an object has no limbs, or one on a part that its document `project` has not. Returns what else names such a part."""
    if not defined(ob):
        raise Problem(f'"{ob.name}" has no limbs: draw lines across them on the layer "{LAYER}", then Define Limbs')
    _, lost = part_names.among(_extra(ob), {part["name"] for part in project["parts"]})
    if len(project.get("limbs", [])) < len(defined(ob)):
        raise Problem(f"{part_names.listed(lost)}: on a part without contours; press Define Limbs, which makes limbs from the lines on \"{LAYER}\"")
    return f"without effect, since a part has no contours: {part_names.listed(lost)}" if lost else ""


def _lines(ob) -> dict[int, dict[int, np.ndarray]]:
    """By key point and frame the two ends of its line in pixels."""
    layer = gp.find_layer(ob, LAYER)
    if layer is None:
        raise Problem(f'"{ob.name}" has no layer "{LAYER}": add one and draw short lines across the limbs there')
    drawings = gp.drawings(layer)
    drawn = [gp.positions(handle, int(gp.offsets(handle)[-1])) for handle, _ in drawings.values()]
    points = {0: np.concatenate(drawn)} if drawn else {}
    mapper = placement.Mapper(ob, drawings, points, [LAYER])
    lines: dict[int, dict[int, np.ndarray]] = {}
    known = len(bodies.of(ob).points)
    for frame, (handle, _) in sorted(drawings.items()):
        starts = gp.offsets(handle)
        numbers = gp.value(handle, gp.KEY_POINT, len(starts) - 1)
        numbers[numbers > known] = 0
        every = gp.positions(handle, int(starts[-1]))
        for number, a, b in zip(numbers, starts, starts[1:]):
            if number and b - a > 1:
                ends = every[[a, b - 1]]
                if np.isfinite(ends).all():
                    lines.setdefault(int(number) - 1, {})[frame - ob.rototoon.frame_offset] = mapper.at(0, frame).to_pixels(ends)
    return lines


def _end(point: str, drawn: dict[int, np.ndarray], project: dict[str, Any]) -> dict[str, Any]:
    """A limb's end in the form of documents."""
    part = _part_of(point, drawn, project)
    ends = ({str(frame): line[side].tolist() for frame, line in drawn.items()} for side in (0, 1))
    return {"points": [{"part": part, "drawn": points} for points in ends], "share": 0.5}


def _part_of(name: str, drawn: dict[int, np.ndarray], project: dict[str, Any]) -> str:
    """The part whose contour is nearest to the ends of the line, over all its frames."""
    best = (np.inf, "")
    for part in project["parts"]:
        contours = {int(f): np.asarray(p) for f, p in {**part.get("keys", {}), **part.get("tracks", {})}.items()}
        if not all(frame in contours for frame in drawn):
            continue
        away = sum(_distance(end, contours[frame], part["closed"]) for frame, line in drawn.items() for end in line)
        best = min(best, (away, part["name"]))
    if not best[1]:
        frames = ", ".join(str(frame) for frame in drawn)
        raise Problem(f"{name}: no contour on picture {frames}; draw the line on a frame that shows the part")
    return best[1]


def _distance(point: np.ndarray, contour: np.ndarray, closed: bool) -> float:
    following = np.roll(contour, -1, 0) if closed else contour[1:]
    starts = contour if closed else contour[:-1]
    along = following - starts
    share = ((point - starts) * along).sum(1) / np.maximum((along**2).sum(1), 1e-12)
    nearest = starts + np.clip(share, 0, 1)[:, None] * along
    return float(np.linalg.norm(nearest - point, axis=1).min())

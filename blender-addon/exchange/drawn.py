"""The drawings of a document as a layer of lines: `drawings` with `pairs`, `traced`, and `in_betweens` with `matches`.

What the artist drew is in `drawings`; it comes in as keys. `traced` and `in_betweens` are generated. If a frame has several of them, the
drawing wins, then the traced one. A document counts strokes from 0, a layer from 1.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from ..blender import guard
from ..lines import given, tracing
from . import spacings, stroke_fields
from .fields import wrong
from .further import Further

FIELDS = ("drawings", "pairs", "traced", "in_betweens", "matches")
"""The fields of a document that this module and `drawn_out` know."""
SAME = 1e-3
"""Pixels between points that are the same."""


def checked(project: dict[str, Any]) -> given.Film:
    """The drawings of a document by picture number. Raises a `Problem` that names the field that is wrong."""
    film = given.Film()
    film.traced = _numbered(project, "traced")
    film.between = _numbered(project, "in_betweens")
    numbers = _numbers_of_matches(project)
    for _, frame, _, strokes in stroke_fields.drawings_of(project, "drawings", numbered=False):
        film.keys[frame] = strokes
        if frame in film.traced:
            film.keys[frame] = _as_traced(strokes, film.traced.pop(frame))
            film.followed.add(frame)
        elif frame in numbers and len(numbers[frame]) == len(strokes):
            film.keys[frame] = [replace(stroke, number=number) for stroke, number in zip(strokes, numbers[frame])]
    for frame in film.keys.keys() | film.traced.keys():
        film.between.pop(frame, None)
    film.spans = _spans(project, film)
    film.pairs = _pairs(project, film)
    return film


def _numbered(project: dict[str, Any], name: str) -> dict[int, list[tracing.Placed]]:
    found = {}
    for place, frame, _, strokes in stroke_fields.drawings_of(project, name, numbered=True):
        if name == "traced" and len({stroke.number for stroke in strokes}) < len(strokes):
            raise wrong(f"{place}.strokes", sorted(stroke.number - 1 for stroke in strokes), "each track once on a frame")
        found[frame] = strokes
    return found


def _as_traced(strokes: list[tracing.Placed], traced: list[tracing.Placed]) -> list[tracing.Placed]:
    """Strokes of a drawing with the numbers of the traced strokes that are the same. Tracing may change their order."""
    left, found = list(traced), []
    for stroke in strokes:
        same = next((k for k, other in enumerate(left) if _equal(stroke.points, other.points)), None)
        found.append(stroke if same is None else replace(stroke, number=left.pop(same).number))
    return found


def _equal(one: np.ndarray, other: np.ndarray) -> bool:
    return one.shape == other.shape and bool((np.abs(one - other) <= SAME).all())


def _numbers_of_matches(project: dict[str, Any]) -> dict[int, list[int]]:
    """By picture of a drawing the numbers of its strokes. What is no list of different numbers is left out."""
    found: dict[int, list[int]] = {}
    matches = project.get("matches")
    for each in matches if isinstance(matches, list) else ():
        tracks = each.get("tracks") if isinstance(each, dict) else None
        if not isinstance(tracks, list):
            continue
        for name, own in zip(("frame", "next"), tracks):
            good = isinstance(own, list) and all(type(track) is int and track >= 0 for track in own) and len(set(own)) == len(own)
            if good and isinstance(each.get(name), int):
                found[each[name]] = [track + 1 for track in own]
    return found


def _spans(project: dict[str, Any], film: given.Film) -> dict[tuple[int, int], Any]:
    spacing = {drawing["frame"]: drawing.get("spacing", "smooth") for drawing in project.get("drawings", ())}
    frames, found = sorted(film.keys), {}
    for first, last in zip(frames, frames[1:]):
        inside = [frame for frame in sorted(film.between) if first < frame < last]
        found[first, last] = spacings.choices(spacing[first], first, last, inside)
    return found


def _pairs(project: dict[str, Any], film: given.Film) -> list[tuple[int, int, int]]:
    pairs, frames = project.get("pairs", []), sorted(film.keys)
    if not isinstance(pairs, list):
        raise wrong("pairs", pairs, "a list of pairs")
    following, found = dict(zip(frames, frames[1:])), []
    for k, pair in enumerate(pairs):
        fields = pair if isinstance(pair, dict) else {}
        frame, one, other = fields.get("frame"), fields.get("from"), fields.get("to")
        if type(frame) is not int or frame not in following:
            raise wrong(f"pairs[{k}].frame", frame, "the frame of a drawing that has a next one")
        for name, index, on in (("from", one, frame), ("to", other, following[frame])):
            count = len(film.keys[on])
            if not (name == "to" and index is None) and not (type(index) is int and 0 <= index < count):
                raise wrong(f"pairs[{k}].{name}", index, f"the index of one of the {count} strokes on frame {on}")
        found.append((frame, one, -1 if other is None else other))
    return found


def pegs(project: dict[str, Any]) -> set[str]:
    """The names of a document's pegs."""
    found = project.get("pegs")
    return {str(peg.get("name")) for peg in found if isinstance(peg, dict)} if isinstance(found, list) else set()


def need_open(ob, project: dict[str, Any]) -> None:
    """Raises a `Problem` if the document has drawings and the layer for them may not be written."""
    film = checked(project)
    if film.keys or film.traced or film.between:
        guard.need_apart(ob, [ob.rototoon.lines_layer])


def draw(ob, project: dict[str, Any]) -> given.Done:
    """Draws the drawings of a document. Generated drawings of the layer are replaced, the artist's stay."""
    film = checked(project)
    if not (film.keys or film.traced or film.between):
        return given.Done()
    further = Further(ob)
    _number_fields(project, film, further)
    offset = ob.rototoon.frame_offset
    done = given.draw(ob, ob.rototoon.lines_layer, _moved(film, offset))
    for drawing in project.get("drawings", ()):
        if drawing["frame"] + offset not in done.stayed:
            own = {name: value for name, value in drawing.items() if name not in ("frame", "strokes")}
            further.drawings[str(drawing["frame"])] = own
    further.store(ob)
    return done


def _number_fields(project: dict[str, Any], film: given.Film, further: Further) -> None:
    for name, drawings in (("drawings", film.keys), ("in_betweens", film.between)):
        for drawing in project.get(name, ()):
            for stroke, fields in zip(drawings.get(drawing["frame"], ()), drawing["strokes"]):
                stroke.fields = further.number({key: value for key, value in fields.items() if key not in stroke_fields.KNOWN})


def _moved(film: given.Film, offset: int) -> given.Film:
    """A film by scene frame."""
    keys, traced, between = ({n + offset: each for n, each in own.items()} for own in (film.keys, film.traced, film.between))
    followed = {frame + offset for frame in film.followed}
    spans = {(first + offset, last + offset): each for (first, last), each in film.spans.items()}
    return given.Film(keys, followed, traced, between, spans, [(frame + offset, i, j) for frame, i, j in film.pairs])

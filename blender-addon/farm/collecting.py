"""Takes the results of a batch into the objects that were sent.

What the artist changed meanwhile stays. A span of a part, from a key to the next, is taken only if both keys are as they were sent, no
key came between, and its corrections are the same. Of a part with a single key, the whole track is such a span. On all other frames
the contours stay as they are; Track makes them anew. Where the artist has said meanwhile that a part is hidden, it stays hidden.

Locked layers are not written, as with Track.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from rototoon.documents import by_frame

from ..blender import grease_pencil as gp
from ..blender import guard
from ..blender.errors import Problem
from ..capture import absence, contours, document, ends, exchanged, identity, sessions, snapping, tracking, unseen, writing
from ..capture.document import Reading
from ..exchange import files
from ..exchange.fields import wrong
from . import batch, same_parts

RECORD = "batch.json"
SAME = 0.01
"""Pixels. Points that differ by less are the same: an object's points have single precision."""
MOST_FILES = 3
"""Greatest number of files that a message names."""
_DOCUMENTS = {"track", "snap", "trace", "fill", "tween"}
"""The steps that write a document."""


@dataclass
class Result:
    """The result of a shot."""

    shot: str
    object: str
    document: dict[str, Any] | None
    failure: str = ""
    path: str = ""
    """The document's file."""
    lines: dict[str, Any] | None = None
    """How its lines were sent: `layers`, `home`, `new` and `hold`. `None` if no lines were sent."""
    numbers: dict[str, int] = field(default_factory=dict)
    """The numbers that its parts had, by name."""
    held: set[int] = field(default_factory=set)
    """The pictures that are the same as the one before, where lines hold their drawings."""


@dataclass
class Taken:
    """What was taken into an object."""

    contours: int = 0
    kept: dict[str, list[int]] = field(default_factory=dict)
    """By part the frames of results that were not taken, since the artist changed something."""
    hidden: dict[str, list[int]] = field(default_factory=dict)
    """By part the frames of results that were not taken, since the artist has said that the part is hidden there."""
    missing: list[str] = field(default_factory=list)
    """Parts of the results that the object has not."""
    new: list[str] = field(default_factory=list)
    """Parts that the results have not."""
    left: str = ""
    """Layers that were left as they were."""
    edited: list[int] = field(default_factory=list)
    """Frames of snapped drawings that the artist had changed: they stay, and are keys now."""


def results_of(folder: str, path: str) -> list[Result]:
    """The results of the shots of a Blender file. `folder` is the one that Send to Farm wrote to, or its results."""
    place = Path(folder)
    if not (place / batch.SENT).exists() and (place.parent / batch.SENT).exists():
        place = place.parent
    if not (place / batch.SENT).exists():
        raise Problem(f"No {batch.SENT} in {folder}: choose the folder that Send to Farm wrote to")
    found = []
    for index, entry in enumerate(batch.read_sent(place / batch.SENT)["shots"]):
        blend = entry.get("blend", "")
        # The farm may see the file under another path.
        if not path or not blend or os.path.basename(blend) == os.path.basename(path):
            listed = f"{place / batch.SENT}: shots[{index}]"
            lines, numbers = _lines_of(entry, f"{listed}.lines"), same_parts.numbers_of(entry, listed)
            found.append(replace(_result(place / batch.RESULTS / str(entry.get("shot")), entry), lines=lines, numbers=numbers))
    return found


def not_sent(folder: str, path: str) -> Problem:
    """The error for a file without a shot in a batch. It names the files that were sent."""
    place = Path(folder)
    place = place if (place / batch.SENT).exists() else place.parent
    sent = sorted({os.path.basename(entry["blend"]) for entry in batch.read_sent(place / batch.SENT)["shots"] if entry.get("blend")})
    if not sent:
        return Problem(f"{place / batch.SENT} has no shot: send the file to the farm again")
    names = " and ".join(f'"{name}"' for name in sent[:MOST_FILES]) + (f" and {len(sent) - MOST_FILES} more" if len(sent) > MOST_FILES else "")
    return Problem(
        f'The batch has no shot of "{os.path.basename(path)}"; {names} {"was" if len(sent) == 1 else "were"} sent. Open that file, or, if this is a '
        f'later version of it, give its name in Sent From: "{sent[0]}"'
    )


def _lines_of(entry: Mapping[str, Any], place: str) -> dict[str, Any] | None:
    lines = entry.get("lines")
    if lines is None:
        return None
    if not isinstance(lines, dict):
        raise wrong(place, lines, "an object with layers, home, new and hold")
    layers = lines.get("layers")
    if not isinstance(layers, list) or not layers or not all(isinstance(name, str) for name in layers):
        raise wrong(f"{place}.layers", layers, "names of layers")
    if lines.get("home") not in layers:
        raise wrong(f"{place}.home", lines.get("home"), "one of the layers")
    for name in ("new", "hold"):
        if not isinstance(lines.get(name), bool):
            raise wrong(f"{place}.{name}", lines.get(name), "true or false")
    return lines


def _result(folder: Path, entry: Mapping[str, Any]) -> Result:
    shot, name = str(entry.get("shot")), str(entry.get("object"))
    try:
        record = json.loads((folder / RECORD).read_text(encoding="utf-8"))
        written = [step["outputs"][0] for step in record["steps"] if step["step"] in _DOCUMENTS]
        failure = record.get("failure", "")
    except OSError:
        return Result(shot, name, None, "no result yet")
    except (ValueError, KeyError, IndexError, TypeError):
        return Result(shot, name, None, f"{folder / RECORD} is damaged: start the batch again")
    if failure or not written:
        return Result(shot, name, None, failure or "nothing was tracked")
    path = str(folder / written[-1])
    return Result(shot, name, files.load(path), path=path)


def collecting(ob: bpy.types.Object, result: Mapping[str, Any], numbers: Mapping[str, int]) -> Iterator[float]:
    """Takes a document's results into an object, in steps. `numbers` are those that its parts had. Returns what was `Taken`."""
    guard.need(ob)
    guard.need_some(tracking.contour_layers(ob), hidden=True)
    reading = document.read(ob)
    yield 0.0
    need_same_footage(ob, reading.document["footage"], result["footage"])
    now = {entry["name"]: entry for entry in reading.document["parts"]}
    known = {part.name: part.number for part in reading.found.parts}
    matched = same_parts.match(result.get("parts", []), numbers, now, known, same_spans)
    sent, taken = matched.entries, Taken(missing=matched.left, new=matched.without)
    frames: dict[int, set[int]] = {}
    tracks: dict[int, writing.Track] = {}
    for part in reading.found.parts:
        if not part.keys:
            continue
        # A locked layer is left as it is, and named at the end.
        entry = {} if part.layer in reading.found.closed else sent.get(part.name, {})
        spans = same_spans(entry, now[part.name])
        offset = ob.rototoon.frame_offset
        results = {int(frame) + offset for frame in entry.get("tracks", {})} - part.keys.keys()
        same = {frame for frame in results if any(a <= frame - offset <= b for a, b in spans)}
        frames[part.number] = same - _hidden(ob, part.number, same)
        if same - frames[part.number]:
            taken.hidden[part.name] = sorted(same - frames[part.number])
        kept = sorted(results - same)
        if kept:
            taken.kept[part.name] = kept
        track = _merged(part, entry, frames[part.number], reading, offset)
        if track is not None:
            tracks[part.number] = track
        yield 0.0
    identity.write(ob, reading.found, reading.decisions)
    taken.contours = sum(map(len, frames.values()))
    yield from _write(ob, reading, tracks, frames)
    _note_ends(ob, sent, now)
    # They were found in contours that are gone.
    exchanged.put(ob, [row for row in exchanged.rows_of(ob) if not any(frames.get(number) for number in row[:2])])
    hidden = {matched.names.get(name): pictures for name, pictures in unseen.of_document(result).items()}
    for item in ob.rototoon.parts:
        taken_here = frames.get(item.number)
        if taken_here:
            unseen.put(item, [picture for picture in hidden.get(item.name, []) if picture + ob.rototoon.frame_offset in taken_here])
    left = tracking.contour_layers(ob)
    snapped = _write_curves(ob, reading, sent, frames, taken)
    taken.left = "; ".join(filter(None, (guard.left_out(left, hidden=True), snapped)))
    sessions.drop(ob)
    ob.data.update_tag()
    return taken


def _hidden(ob, number: int, frames: Iterable[int]) -> set[int]:
    """The frames on which the artist says that a part is hidden."""
    item = next((item for item in ob.rototoon.parts if item.number == number), None)
    offset = ob.rototoon.frame_offset
    return {frame for frame in frames if item is not None and absence.is_hidden(item, frame - offset)}


def need_same_footage(ob, now: Mapping[str, Any], sent: Mapping[str, Any], names: Sequence[str] = ("width", "height")) -> None:
    """Raises a `Problem` if the result is of pictures of another size. `names` are the fields of the footage that must be the same."""
    for name in names:
        if now[name] != sent[name]:
            raise Problem(f'"{ob.name}" has other footage than what was sent ({name} {now[name]}, not {sent[name]}): send it again')


def same_spans(sent: Mapping[str, Any], now: Mapping[str, Any]) -> list[tuple[float, float]]:
    """First and last picture of each span that is in `now` as it was sent. Both are parts of documents."""
    if sent.get("closed", False) != now.get("closed", False):
        return []
    old, new = by_frame(sent.get("keys")), by_frame(now.get("keys"))
    before, after = sorted(old), sorted(new)
    if len(before) == 1:
        if after != before or not _alike(old[before[0]], new[before[0]]):
            return []
        return [(-np.inf, np.inf)] if _same_corrections(sent, now, -np.inf, np.inf) else []
    follows = dict(zip(after, after[1:], strict=False))
    return [
        (a, b)
        for a, b in zip(before, before[1:], strict=False)
        if follows.get(a) == b
        and _alike(old[a], new[a])
        and _alike(old[b], new[b])
        and _same_corrections(sent, now, a, b)
    ]


def _same_corrections(sent: Mapping[str, Any], now: Mapping[str, Any], first: float, last: float) -> bool:
    for name in ("pins", "centers"):
        one, other = ({f: v for f, v in by_frame(each.get(name)).items() if first < f < last} for each in (sent, now))
        if one.keys() != other.keys():
            return False
        for frame, value in one.items():
            if name == "centers":
                if not _alike([value], [other[frame]]):
                    return False
            elif value.keys() != other[frame].keys() or not _alike(
                [value[index] for index in sorted(value)], [other[frame][index] for index in sorted(value)]
            ):
                return False
    return True


def _alike(one: Any, other: Any) -> bool:
    a, b = np.asarray(one, np.float64), np.asarray(other, np.float64)
    return a.shape == b.shape and bool((np.abs(a - b) <= SAME).all())


def _merged(part: contours.Part, entry: Mapping[str, Any], taken: set[int], reading: Reading, offset: int) -> writing.Track | None:
    """A part's contours after the results were taken: keys, results on the frames `taken`, and generated contours elsewhere."""
    points, sure = by_frame(entry.get("tracks")), by_frame(entry.get("confidence"))
    frames = sorted(taken | part.made.keys() | part.keys.keys())
    rows, confidence = [], []
    for frame in frames:
        stroke = part.keys.get(frame) or part.made.get(frame)
        if frame in taken:
            rows.append(np.asarray(points[frame - offset], np.float64))
            confidence.append(np.asarray(sure.get(frame - offset, np.ones(part.count)), np.float64))
            continue
        rows.append(reading.mapper.at(stroke.layer, frame).to_pixels(stroke.control_points(part.closed)))
        confidence.append(_confidence(reading.found, stroke, part))
    if any(len(row) != part.count for row in rows) or not frames:
        return None
    return writing.Track(np.array(frames), np.stack(rows), np.stack(confidence))


def _confidence(found: contours.Contours, stroke: contours.Stroke, part: contours.Part) -> np.ndarray:
    drawing = found.drawings[stroke.layer, stroke.frame]
    if not stroke.made or not drawing.has(gp.CONFIDENCE):
        return np.ones(part.count)
    with_it = contours.read_drawing(drawing.handle, drawing.kind, stroke.layer, stroke.frame, (gp.CONFIDENCE,))
    return with_it.value(gp.CONFIDENCE)[stroke.span].astype(np.float64)


def _write(ob, reading: Reading, tracks: Mapping[int, writing.Track], taken: Mapping[int, set[int]]) -> Iterator[float]:
    found = reading.found
    for index, name in enumerate(found.layer_names):
        if index in found.closed:
            continue
        block = yield from writing.laying_out(index, found.parts, dict(tracks), found, reading.mapper, reading.corrections)
        writing.limit(block, ob, index, found)
        _hold(block, [part for part in found.parts if part.number in tracks and part.layer == index], taken)
        layer = gp.find_layer(ob, name)
        yield from writing.write_steps(layer, block, list(gp.drawings(layer)))


def _hold(block: writing.Block, parts: list[contours.Part], taken: Mapping[int, set[int]]) -> None:
    """Puts contours that were not taken exactly where they are. The way through pixels would move them by a rounding error."""
    row_of = {int(frame): row for row, frame in enumerate(block.frames)}
    for part, columns in zip(sorted(parts, key=lambda part: part.depth), block.columns, strict=True):
        for frame, stroke in part.made.items():
            if frame not in taken[part.number]:
                block.point["position"][row_of[frame], columns] = stroke.points


def _note_ends(ob, sent: Mapping[str, Any], now: Mapping[str, Any]) -> None:
    for item in ob.rototoon.parts:
        entry = sent.get(item.name)
        if entry is not None and item.name in now and len(entry.get("keys", {})) == 1 and same_spans(entry, now[item.name]):
            ends.put(item, [(int(frame), ends.LOST) for frame in entry.get("wants_key", [])])


def _write_curves(ob, reading: Reading, sent: Mapping[str, Any], taken: Mapping[int, set[int]], done: Taken) -> str:
    """Writes snapped lines of contours that were taken. Returns why none were."""
    offset = ob.rototoon.frame_offset
    curves = {}
    for part in reading.found.parts:
        allowed = taken.get(part.number, set()) | (part.keys.keys() if taken.get(part.number) else set())
        for frame, segments in by_frame(sent.get(part.name, {}).get("curves")).items():
            if frame + offset in allowed and snapping.complete(segments, part.count, part.closed):
                curves[part.number, frame + offset] = [np.asarray(path, np.float64) for path in segments]
    if not curves:
        return ""
    layer = gp.find_layer(ob, ob.rototoon.snapped_layer)
    if layer is not None and guard.closed(layer):
        return guard.left_out([layer])
    why = guard.as_contours(ob, ob.rototoon.snapped_layer)
    if why:
        return why
    done.edited = snapping.keep_edited(ob)
    snapping.write(ob, snapping.read(ob) | curves, reading.found, reading.mapper)
    hidden, left = snapping.clear_aside(ob)
    done.edited = sorted({*done.edited, *hidden})
    return left

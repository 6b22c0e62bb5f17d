"""One run of tracking: it reads an object, tracks in a thread, and writes the result into strokes.

The button Track and live tracking both use it. Nothing in the file changes before `finish`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from rototoon import outcomes

from ..blender import grease_pencil as gp
from ..blender import guard, preferences
from ..blender.errors import Problem
from ..common import jobs
from ..common.wording import counted, listed
from . import corrections, document, ends, exchanged, identity, sessions, unseen, writing

OUTWARD = "rototoon"
"""The method that tracks a part with one key outward from that key."""


@dataclass
class Run:
    """A running track. It has no references to Blender's data, so it survives undo and deleted objects."""

    uid: int
    """The object's `session_uid`."""
    inputs: dict[str, Any]
    """The document that it tracks."""
    preset: str
    """The method in the panel at the beginning."""
    closed: tuple[str, ...]
    """Names of the locked layers at the beginning."""
    moved: dict[str, list[int]]
    """By part the scene frames on which the artist moved every point since the last run, and all of them hold."""
    sought: dict[str, list[int]]
    """By part the scene frames on which the artist moved the whole line since the last run, and its centre alone is corrected."""
    entry: sessions.Entry
    worker: jobs.Worker
    taken: str = ""
    """What became of new strokes on tracked frames, for the message."""
    doubts: tuple[str, ...] = ()
    """New strokes that could be something else, and corrections that are lost."""
    dropped: str = ""
    """Parts that left the list, for the message."""


def contour_layers(ob) -> list:
    """The layers that Track writes, if they are not locked. Hidden ones too: a hidden part is tracked with the others."""
    return gp.layers(ob, ob.rototoon.contours_layer)


def can_track(reading: document.Reading, preset: str) -> bool:
    """Whether any part has enough keys: two, or one if the method tracks outward from a single key."""
    least = 1 if preset == OUTWARD else 2
    return any(len(part.keys) >= least for part in reading.found.parts)


def begin(ob, reading: document.Reading, preset: str) -> Run:
    """Makes a run. The caller starts its worker. Raises a `Problem` if no contour layer may be written."""
    guard.need_some(contour_layers(ob), hidden=True)
    document.need_pictures(ob, reading)
    entry = sessions.get(ob, reading.document, reading.folder)
    entry.inputs = None
    threads = preferences.threads()
    worker = jobs.Worker(lambda progress: entry.session.track(preset, progress, threads=threads))
    fixed = {part.name: reading.corrections[part.number] for part in reading.found.parts}
    moved = {name: own.whole for name, own in fixed.items() if own.whole}
    sought = {name: own.sought for name, own in fixed.items() if own.sought}
    taken = _of_new(reading.decisions)
    doubts = (*reading.decisions.doubts, *corrections.lost(reading.found, preset == OUTWARD))
    return Run(ob.session_uid, reading.document, ob.rototoon.preset, reading.found.closed_names, moved, sought, entry, worker, taken, doubts)


def _of_new(decisions: identity.Decisions) -> str:
    taken, created = identity.named(decisions, decisions.on_tracked)
    said = f"; new strokes are keys of {taken}" if taken else ""
    return said + (f"; new parts: {created}" if created else "")


def finish(ob, run: Run) -> int | None:
    """Writes the result of a run. Returns the number of strokes; `None` if the object no longer fits (`finishing`)."""
    return jobs.drained(finishing(ob, run))


def finishing(ob, run: Run, drop_empty: bool = False) -> Iterator[float]:
    """Writes the result of a run in steps, and yields the finished share. Returns the number of strokes.

    With `drop_empty`, parts without a stroke leave the list. If the object's document has changed since the run began, it writes nothing
    and returns `None`.
    """
    guard.need(ob)
    reading = yield from document.reading(ob)
    if reading.document != run.inputs:
        return None
    yield 0.0
    identity.write(ob, reading.found, reading.decisions)
    run.dropped = identity.drop_empty(ob, reading.found) if drop_empty else ""
    strokes = yield from writing_tracks(ob, reading, run.entry.session)
    note_ends(ob, reading, run.worker.result.ends)
    exchanged.note(ob, run.worker.result.exchanges)
    unseen.note(ob, run.worker.result.unseen)
    run.entry.inputs, run.entry.preset = reading.document, run.preset
    run.entry.closed = reading.found.closed_names
    ob.data.update_tag()
    return strokes


def writing_tracks(ob, reading: document.Reading, session) -> Iterator[float]:
    """Writes a session's tracks into the object's contour layers that are not locked, in steps. Returns the number of strokes."""
    offset = ob.rototoon.frame_offset
    tracks = {}
    for part in reading.found.parts:
        if not part.keys:
            continue
        track = session.tracks(part.name)
        frames = np.asarray(track.frames)
        if len(frames):
            confidence = np.asarray(session.confidence(part.name))
            tracks[part.number] = writing.Track(frames + offset, np.asarray(track.points), confidence)
        yield 0.0
    found, blocks = reading.found, {}
    for index, name in enumerate(found.layer_names):
        if index not in found.closed:
            laid = writing.laying_out(index, found.parts, tracks, found, reading.mapper, reading.corrections)
            blocks[name] = yield from laid
            writing.limit(blocks[name], ob, index, found)
    written = 0
    for name, block in blocks.items():
        layer = gp.find_layer(ob, name)
        index = found.layer_names.index(name)
        read = {frame: drawing.points for (of, frame), drawing in found.drawings.items() if of == index}
        written += yield from writing.write_steps(layer, block, list(gp.drawings(layer)), read)
    return written


def note_ends(ob, reading: document.Reading, found) -> None:
    """Stores the ends of tracks with the parts, for the panel."""
    numbers = {part.name: part.number for part in reading.found.parts}
    by_number: dict[int, list[tuple[int, str]]] = {}
    for end in found:
        by_number.setdefault(numbers[end.part], []).append((end.frame, end.reason))
    for item in ob.rototoon.parts:
        ends.put(item, by_number.get(item.number, []))


NAMED = 3
"""Largest number of parts of which a message says more than the name."""


def told(run: Run, strokes: int, reset: bool = False) -> str:
    """What a run has done. `reset` is whether it set looks back."""
    frames: set[int] = set()
    for part in run.inputs["parts"]:
        drawn = np.asarray(run.entry.session.tracks(part["name"]).frames).astype(int)
        frames.update(set(drawn.tolist()) - {int(frame) for frame in part["keys"]})
    text = f"{counted(strokes, 'contour')} drawn on {counted(len(frames), 'frame')}"
    if run.worker.result.footage_changed:
        return text + "; the pictures have changed and were read again"
    return text if run.worker.result.solved or not strokes or reset else "Nothing to track again: " + text


def of_moved_lines(run: Run) -> str:
    """What became of lines that the artist moved as a whole; empty if there are none."""
    return _of_moved("kept as you moved it", run.moved) + _of_moved("looked for where you moved it", run.sought)


def _of_moved(what: str, moved: dict[str, list[int]]) -> str:
    said = [f'"{name}" on {listed(sorted(frames))}' for name, frames in moved.items()]
    if not said:
        return ""
    if len(said) > NAMED:
        said[NAMED:] = [counted(len(said) - NAMED, "more part")]
    return f"; {what}: " + ", ".join(said)


def goes_on(ob, run: Run) -> str:
    """What an artist wonders about who set the last key before the end of the footage; empty if nobody did."""
    ends_of = [max(map(int, part["keys"])) for part in run.inputs["parts"] if len(part["keys"]) > 1]
    last, offset = run.inputs["footage"]["last"], ob.rototoon.frame_offset
    if not ends_of or max(ends_of) >= last:
        return ""
    return f"; nothing after your last key on frame {max(ends_of) + offset}: the footage goes on to frame {last + offset}"


def where_to_look(ob, run: Run) -> str:
    """All parts that were lost or are most likely off, of the first ones also where; empty if there are none."""
    offset, session = ob.rototoon.frame_offset, run.entry.session
    lost: dict[str, list[int]] = {}
    for end in run.worker.result.ends:
        if end.reason == ends.LOST:
            lost.setdefault(end.part, []).append(end.frame + offset)
    said = {name: f'"{name}" needs a key on {listed(frames)}' for name, frames in lost.items()}
    asked = []
    for part in run.inputs["parts"]:
        drawn = np.asarray(session.tracks(part["name"]).frames).astype(int).tolist()
        means = np.asarray(session.confidence(part["name"])).mean(1).tolist() if drawn else []
        asked.append({"keys": list(part["keys"]), "confidence": dict(zip(drawn, means, strict=True))})
    for part, outcome in zip(run.inputs["parts"], outcomes(asked).parts, strict=True):
        if outcome.lost and part["name"] not in lost:
            off = listed([frame + offset for frame in outcome.lost])
            said[part["name"]] = f'"{part["name"]}" is most likely off on {off}'
    more = ", ".join(f'"{name}"' for name in list(said)[NAMED:])
    return "; ".join([*list(said.values())[:NAMED], *([f"look at {more} too"] if more else [])])


def nothing_to_track() -> Problem:
    """The error for an object that `can_track` refuses."""
    return Problem("Nothing to track: go to another frame, press New Key Here and fit the contours there")

"""Drawings that a document gives, as a layer of lines: the artist's, traced ones and in-betweens.

Drawings of the artist become keys. Traced drawings and in-betweens are generated, as Trace Drawing and In-between write them, so that a
change by the artist is noticed. What the artist has on the layer already stays. Traced drawings are replaced. In-betweens are replaced where the
document draws: on its frames, and between two of its drawings that come in. The others lie between drawings that stay, and stay with them.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, fields, replace

import numpy as np

from ..blender import grease_pencil as gp
from ..blender import guard, line_materials, marks, stroke_rows
from ..blender import strokes as st
from ..blender.placement import Mapper
from ..common import jobs
from ..tween import keys as ks
from ..tween import moved_keys, pairs, tweening
from ..tween import records as tween_records
from ..tween.charts import Choices
from . import drawings as dr
from . import looks, moved, plane, records, tracing

Strokes = Mapping[int, list[tracing.Placed]]
"""By scene frame, from back to front."""
Ink = tuple[np.ndarray, np.ndarray | None]
"""The colour of a material, and that of its fill if it has both."""
Inks = Mapping[tuple[int, bool], Ink]
"""By number, and whether it is a shape."""


@dataclass
class Film:
    """The drawings of a document, by scene frame."""

    keys: dict[int, list[tracing.Placed]] = field(default_factory=dict)
    """The artist's. A stroke without a number has 0."""
    followed: set[int] = field(default_factory=set)
    """The keys whose numbers are those of traced strokes."""
    traced: dict[int, list[tracing.Placed]] = field(default_factory=dict)
    between: dict[int, list[tracing.Placed]] = field(default_factory=dict)
    spans: dict[tuple[int, int], Choices] = field(default_factory=dict)
    """The choices from which the in-betweens of neighbouring keys were drawn."""
    pairs: list[tuple[int, int, int]] = field(default_factory=list)
    """Pairs that the artist made: the frame of the earlier key, the index of its stroke, and that of the next key's stroke, -1 for
    none."""


@dataclass
class Done:
    """What was drawn."""

    keys: int = 0
    strokes: int = 0
    """Number of different traced strokes."""
    between: int = 0
    stayed: set[int] = field(default_factory=set)
    """Frames with a drawing of the artist's own, which was not replaced by that of the document."""
    left: int = 0
    """Number of in-betweens that do not lie between two keys of the document."""
    kept: set[int] = field(default_factory=set)
    """Frames of the document's in-betweens on which in-betweens of the layer stay."""
    beside: set[int] = field(default_factory=set)
    """Frames of in-betweens that are left out, because a drawing of the artist's own stays beside them."""
    pairs: int = 0
    """Number of pairs that are left out for the same reason."""


def draw(ob, name: str, film: Film) -> Done:
    """Draws a film on the layer `name`, in the place of generated drawings there."""
    guard.need_apart(ob, [name])
    target = gp.layer(ob, name)
    shown = {0: plane.points(ob, name)}
    own = _cleared(ob, name, target, film)
    keys = {frame: strokes for frame, strokes in sorted(film.keys.items()) if frame not in own}
    traced = {frame: strokes for frame, strokes in sorted(film.traced.items()) if frame not in own | film.keys.keys()}
    done = Done(keys=len(keys), stayed=own & film.keys.keys())
    mapper = Mapper(ob, {*keys, *traced, *film.between}, shown, [name])
    known = _known(ob, traced)
    if mapper.still:
        traced = dict(traced) | dict.fromkeys(_held(keys, traced))
    kept = moved.read(ob, [name])
    record = kept.setdefault(name, records.Layer())
    _write_keys(ob, target, mapper, keys, film.followed, record)
    written = tracing.Done()
    (layer,) = dr.read(ob, [name])
    jobs.drained(tracing.write(ob, layer, mapper, 0, traced, looks.Looks(), record, written, known))
    records.write(ob.data, kept)
    done.strokes = len(written.numbers)
    done.pairs = _pair(target, keys.keys(), film)
    _draw_between(ob, target, mapper, film, keys.keys(), done)
    return done


def _held(keys: Strokes, traced: Strokes) -> list[int]:
    """The traced drawings that equal the one on the frame before in all that a document says of them: the library found that the pictures show the
    same drawing."""
    shown = {**traced, **keys}
    return [frame for frame, strokes in traced.items() if frame - 1 in shown and _same(shown[frame - 1], strokes)]


def _same(one: list[tracing.Placed], other: list[tracing.Placed]) -> bool:
    # The further fields of a drawing of the artist are not those of a traced one.
    names = [each.name for each in fields(tracing.Placed) if each.name != "fields"]
    values = ((getattr(a, name), getattr(b, name)) for a, b in zip(one, other) for name in names)
    return len(one) == len(other) and all(_equal(a, b) for a, b in values)


def _equal(one, other) -> bool:
    if one is None or other is None:
        return one is other
    return np.array_equal(one, other, equal_nan=True)


def _cleared(ob, name: str, target, film: Film) -> set[int]:
    """Removes the generated drawings of a layer that a film replaces, and returns the frames of the artist's.

    In-betweens without a checksum, as on a renamed layer, stay: the artist may have changed them.
    """
    kept = tween_records.read(ob.data)
    record = kept.get(name, tween_records.Layer())
    found = ks.frames_of(target, record)
    tweening.adopt(target, found, found.edited)
    (layer,) = dr.read(ob, [name])
    dr.keep(ob, layer)
    record = _followed(target, record, found.keys, layer.other)
    between = {frame for span in record.spans.values() for frame in span.sums if frame in layer.other}
    own = set(layer.kept - between)
    replaced = {frame for frame in between if _is_replaced(frame, film, own)}
    gp.remove_frames(target, sorted(layer.made.keys() | replaced))
    if name in kept:
        kept[name] = record
        _forget(record, replaced)
        tween_records.write(ob.data, kept)
    return own


def _followed(target, record: tween_records.Layer, keys: list[int], between: Iterable[int]) -> tween_records.Layer:
    """The record of a layer with the frames that its keys and its in-betweens have now. An in-between that lies as it was drawn on another frame was
    moved there."""
    now = moved_keys.sums_of(target, between)
    record = moved_keys.followed(target, record, keys).record
    for first, span in record.spans.items():
        drawn = set(span.sums.values())
        span.sums = {frame: total for frame, total in now.items() if first < frame < span.last and total in drawn} or span.sums
    return record


def _is_replaced(frame: int, film: Film, own: set[int]) -> bool:
    """Whether a film draws in the place of an in-between of the layer."""
    if frame in film.keys or frame in film.traced:
        return True
    return any(first < frame < last and not any(first <= mine <= last for mine in own) for first, last in film.spans)


def _forget(record: tween_records.Layer, frames: set[int]) -> None:
    """Forgets in-betweens that are gone. What is left of their spans is drawn again at the next update."""
    for first, span in list(record.spans.items()):
        left = {frame: total for frame, total in span.sums.items() if frame not in frames}
        if not left:
            del record.spans[first]
        elif len(left) < len(span.sums):
            span.sums, span.digest = left, ""


def _known(ob, drawn: Strokes) -> dict[tuple[int, bool], int]:
    """The materials of strokes whose colour is just that of a material of the object, by number."""
    colours: dict[tuple[int, bool], list[np.ndarray]] = {}
    for stroke in (stroke for strokes in drawn.values() for stroke in strokes):
        colours.setdefault((stroke.number, stroke.fill), []).append(stroke.colour)
    filled: set[int] = set()
    places = {key: looks.exact_material(ob, np.mean(each, axis=0), key[1], make=False) for key, each in colours.items()}
    found = {key: place for key, place in places.items() if place is not None}
    for stroke in (stroke for strokes in drawn.values() for stroke in strokes if stroke.fill_colour is not None):
        # One material for a stroke on all frames. It is the first frame's.
        if stroke.number not in filled:
            filled.add(stroke.number)
            found[stroke.number, stroke.fill] = _material(ob, stroke.colour, stroke.fill_colour, stroke.fill)
    return found


def _write_keys(ob, target, mapper: Mapper, keys: Strokes, followed: set[int], record: records.Layer) -> None:
    gp.make_frames(target, keys, gp.KEYFRAME)
    handles = gp.drawings(target)
    for frame, strokes in keys.items():
        rows = _rows(ob, frame, strokes, mapper, {})
        rows.values[gp.MADE] = np.zeros(len(strokes), bool)
        if frame in followed:
            record.numbers[frame] = [stroke.number for stroke in strokes if stroke.number]
        else:
            rows.values[gp.LINE] = np.zeros(int(rows.sizes.sum()), np.int32)
        stroke_rows.append(handles[frame][0], rows)


def _rows(ob, frame: int, strokes: list[tracing.Placed], mapper: Mapper, inks: Inks) -> stroke_rows.Rows:
    """Strokes of a frame, each with a material of just its colour, or of that in `inks` and tinted."""
    numbers = np.array([stroke.number for stroke in strokes], np.int32)
    # Materials and fills go by numbers. Strokes without a number have colours of their own, so all get others meanwhile.
    own = [replace(stroke, number=i) for i, stroke in enumerate(strokes, 1)]
    shown = [_ink(stroke, inks) for stroke in strokes]
    places: dict[tuple, int] = {}
    materials = {}
    for (colour, fill_colour), each in zip(shown, own):
        key = tuple(colour), each.fill, None if fill_colour is None else tuple(fill_colour)
        if key not in places:
            places[key] = _material(ob, colour, fill_colour, each.fill)
        materials[each.number, each.fill] = places[key]
    rows = tracing.rows_of(frame, own, looks.Looks(), [], materials, mapper.at(0, frame))
    _tint(rows, strokes, shown)
    rows.values[gp.TRACK] = numbers
    rows.values[gp.LINE] = np.repeat(numbers, rows.sizes)
    tracing.note_looks(rows, ob.data)
    if any(stroke.fields for stroke in strokes):
        rows.values[gp.FIELDS] = np.array([stroke.fields for stroke in strokes], np.int32)
    return rows


def _ink(stroke: tracing.Placed, inks: Inks) -> Ink:
    """The colours of a stroke's material."""
    colour, fill_colour = inks.get((stroke.number, stroke.fill), (stroke.colour, None))
    # A piece of a stroke with a fill may have none.
    return colour, stroke.fill_colour if fill_colour is None or stroke.fill_colour is None else fill_colour


def _material(ob, colour: np.ndarray, fill_colour: np.ndarray | None, fill: bool) -> int:
    if fill_colour is not None:
        return looks.filled_material(ob, colour, fill_colour)
    return looks.exact_material(ob, colour, fill)


def _tint(rows: stroke_rows.Rows, strokes: list[tracing.Placed], shown: list[Ink]) -> None:
    """Colours the lines and fills whose colour is not that of their material."""
    lines, fills = (np.zeros((len(strokes), 4), np.float32) for _ in range(2))
    for line, fill, stroke, (ink, fill_ink) in zip(lines, fills, strokes, shown):
        for tint, wanted, given in ((fill if stroke.fill else line, stroke.colour, ink), (fill, stroke.fill_colour, fill_ink)):
            if wanted is not None and np.abs(wanted - given).max() > looks.EXACT:
                tint[:] = *line_materials.to_linear(wanted), 1.0
    if lines.any():
        rows.values["vertex_color"] = np.repeat(lines, rows.sizes, axis=0)
    if fills.any():
        rows.values["fill_color"] = fills


def _pair(target, written, film: Film) -> int:
    """Stores the pairs that the artist made on the strokes of neighbouring keys. Returns how many are left out, because a drawing of the
    artist's own is in the place of one of the two."""
    left, number = 0, pairs.free_number(target)
    drawings, frames = gp.drawings(target), sorted(film.keys)
    following = dict(zip(frames, frames[1:]))
    for frame, i, j in film.pairs:
        after = following.get(frame)
        if frame not in written or after not in written:
            there = pairs.between(*(st.read(drawings[each][0]) for each in (frame, after)))
            left += (i, j) not in there
            continue
        hand = pairs.Hand(drawings[frame][0], drawings[after][0])
        if j < 0:
            hand.alone(0, i, number)
        else:
            hand.pair(i, j, number)
        number += 1
    return left


def _draw_between(ob, target, mapper: Mapper, film: Film, keys, done: Done) -> None:
    """Draws the in-betweens of neighbouring keys of the film, and notes from what they were drawn."""
    kept = tween_records.read(ob.data)
    record = kept.setdefault(target.name, tween_records.Layer())
    there = ks.frames_of(target, record)
    spans = [span for span in zip(there.keys, there.keys[1:]) if span in film.spans and not there.blank & set(span) and keys >= set(span)]
    drawn: dict[tuple[int, int], dict[int, int]] = {}
    for first, last in spans:
        inside = {frame: strokes for frame, strokes in sorted(film.between.items()) if first < frame < last and strokes}
        if inside:
            # On its way a stroke has the material of its keys: another one for each frame would be too many.
            ends = [stroke for key in (last, first) for stroke in film.keys[key]]
            inks = {(stroke.number, stroke.fill): (stroke.colour, stroke.fill_colour) for stroke in ends if stroke.number}
            gp.make_frames(target, inside, gp.KEYFRAME)
            gp.set_keyframe_type(target, dict.fromkeys(inside, gp.GENERATED))
            drawn[first, last] = {frame: _write_between(ob, target, mapper, frame, strokes, inks) for frame, strokes in inside.items()}
            marks.note(ob.data, target.name, inside)
    done.between = sum(map(len, drawn.values()))
    rest = film.between.keys() - set(there.keys) - {frame for sums in drawn.values() for frame in sums}
    done.kept = rest & set(there.made)
    done.beside = {frame for frame in rest - done.kept if any(first < frame < last for first, last in film.spans)}
    done.left = len(rest - done.kept - done.beside)
    if drawn:
        _note(ob, target, record, {span: film.spans[span] for span in drawn}, drawn)
        tween_records.write(ob.data, kept)


def _write_between(ob, target, mapper: Mapper, frame: int, strokes: list[tracing.Placed], inks: Inks) -> int:
    """Draws one in-between. Returns its checksum."""
    rows, count = _rows(ob, frame, strokes, mapper, inks), len(strokes)
    rows.values[gp.MADE], rows.values[gp.TWEENED] = np.zeros(count, bool), np.ones(count, bool)
    rows.values[gp.LINE] = np.zeros(int(rows.sizes.sum()), np.int32)
    opacities = np.array([stroke.opacity for stroke in strokes], np.float32)
    if (opacities < 1).any():
        rows.values["opacity"] = np.repeat(opacities, rows.sizes)
        rows.values["fill_opacity"] = opacities
    stroke_rows.append(gp.drawings(target)[frame][0], rows)
    return tween_records.checksum(rows.values["position"])


def _note(ob, target, record: tween_records.Layer, spans: dict[tuple[int, int], Choices], drawn) -> None:
    """Records in-betweens as if they had been drawn here: they are up to date until something changes."""
    plan = tweening.plan(ob, [target], lambda *_: spans, again=True)
    for call in plan.calls:
        for k in call.spans:
            span = call.sheet.frames[k], call.sheet.frames[k + 1]
            record.spans[span[0]] = tween_records.Span(span[1], call.sheet.digests[k], spans[span], drawn[span], marked=True)
    moved_keys.note(target, record)
    numbers = [gp.value(handle, gp.TRACK, len(gp.offsets(handle)) - 1) for handle, _ in gp.drawings(target).values()]
    record.next_track = max(int(each.max(initial=0)) for each in numbers) + 1

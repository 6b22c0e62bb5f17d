"""Tracked contours as strokes on generated frames beside the artist's keys.

All frames of a layer are laid out in a few large arrays. Then each drawing gets all its strokes with one call, and each attribute
with one more. Radius, opacity, colours, material, fill and the artist's own attributes come from the key strokes, blended in time.
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np

from ..blender import grease_pencil as gp
from ..blender import own_attributes, stroke_rows
from ..blender.errors import Changed
from ..blender.placement import Mapper
from ..common import jobs
from . import absence, correspondence, generated, weights
from .contours import CURVE_STYLE, POINT_STYLE, Contours, Drawing, Part, Stroke
from .corrections import Corrections

SLICE = 0.03
"""Seconds for which drawings are compared with their result before those that differ are written."""
AT_ONCE = 24
"""Largest number of drawings that are written in one step. One of 300 strokes with 100 points takes 0.001 s."""


@dataclass
class Track:
    """A part's tracked contour."""

    frames: np.ndarray
    """Scene frames (F,)."""
    points: np.ndarray
    """Pixels (F, N, 2)."""
    confidence: np.ndarray
    """(F, N)."""


@dataclass
class Block:
    """The generated strokes of a layer on all its frames. Part `p` has the columns `columns[p]`."""

    frames: np.ndarray
    sizes: np.ndarray
    present: np.ndarray
    """(F, P): whether the part has a generated stroke on the frame."""
    columns: list[slice]
    point: dict[str, np.ndarray] = field(default_factory=dict)
    """By attribute: (F, points) or (F, points, k)."""
    curve: dict[str, np.ndarray] = field(default_factory=dict)
    """By attribute: (F, P) or (F, P, k)."""
    own: dict[str, own_attributes.Kind] = field(default_factory=dict)
    """The artist's own attributes among them."""
    order: np.ndarray | None = None
    """(F, P): the parts from back to front on each frame; `None` if they are in that order."""
    last: int | None = None
    """The last scene frame with a picture. Up to it, the generated strokes of a frame do not show on the next one."""
    hidden: frozenset[int] = frozenset()
    """Scene frames on which a part of the layer is hidden: a key does not show there."""


def styles(
    part: Part, found: Contours, own: Mapping[str, own_attributes.Kind]
) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray], list[int]]:
    """Point styles (K, N[, k]) and curve styles (K[, k]) of a part's K keys, and the frames of the keys.

    Only attributes that a key drawing has, or that have a default. `own` are the artist's own ones.
    """
    frames = sorted(part.keys)
    point, curve = {}, {}
    drawings = [found.drawings[part.keys[f].layer, f] for f in frames]
    for name in POINT_STYLE:
        if any(d.has(name) for d in drawings) or name in gp.DEFAULTS:
            point[name] = np.stack([_point_style(part, part.keys[f], d, name) for f, d in zip(frames, drawings)])
    for name in CURVE_STYLE:
        if any(d.has(name) for d in drawings) or name == "cyclic":
            curve[name] = np.stack([d.value(name)[part.keys[f].index] for f, d in zip(frames, drawings)])
    if "fill_id" in curve:
        curve["fill_id"] = np.where(curve["fill_id"] != 0, gp.FILL_BASE + part.number, 0)
    curve["cyclic"] = curve["cyclic"] | part.closed
    for name, kind in own.items():
        if any(d.own.get(name) == kind for d in drawings):
            into = point if kind[1] == "POINT" else curve
            into[name] = np.stack([_own_style(part, part.keys[f], d, name, kind) for f, d in zip(frames, drawings)])
    return point, curve, frames


def _point_style(part: Part, stroke: Stroke, drawing: Drawing, name: str) -> np.ndarray:
    values = drawing.value(name)[stroke.span]
    if own_attributes.is_blended(values):
        return correspondence.sample(values, stroke.where, part.closed)
    nearest = np.rint(stroke.where).astype(int)
    return values[nearest % len(values) if part.closed else np.minimum(nearest, len(values) - 1)]


def _own_style(part: Part, stroke: Stroke, drawing: Drawing, name: str, kind: own_attributes.Kind) -> np.ndarray:
    points = kind[1] == "POINT"
    if drawing.own.get(name) != kind:
        values = gp.blank(name, part.count if points else 1, kind[0])
        return values if points else values[0]
    return _point_style(part, stroke, drawing, name) if points else drawing.value(name)[stroke.index]


def blend(values: np.ndarray, frames: list[int], wanted: np.ndarray) -> np.ndarray:
    """Styles (K, …) of key frames, blended linearly on the frames `wanted`."""
    if (values == values[0]).all():
        return np.broadcast_to(values[0], (len(wanted), *values.shape[1:]))
    after = np.clip(np.searchsorted(frames, wanted, side="right"), 1, max(len(frames) - 1, 1))
    after = np.minimum(after, len(frames) - 1)
    before = np.maximum(after - 1, 0)
    known = np.asarray(frames, np.float64)
    share = np.clip((wanted - known[before]) / np.maximum(known[after] - known[before], 1), 0, 1)
    share = share.reshape((-1,) + (1,) * (values.ndim - 1))
    return values[before] * (1 - share) + values[after] * share


def held(values: np.ndarray, frames: list[int], wanted: np.ndarray) -> np.ndarray:
    """Styles (K, …) of the key at or before each of the frames `wanted`."""
    return values[np.clip(np.searchsorted(frames, wanted, side="right") - 1, 0, len(frames) - 1)]


def mixed(name: str, values: np.ndarray, frames: list[int], wanted: np.ndarray) -> np.ndarray:
    """Styles (K, …) of key frames on the frames `wanted`: blended if they can be, but Blender's styles of whole strokes are held."""
    blended = own_attributes.is_blended(values) and (name in POINT_STYLE or own_attributes.is_own(name))
    return blend(values, frames, wanted) if blended else held(values, frames, wanted)


def lay_out(
    layer: int, parts: list[Part], tracks: dict[int, Track], found: Contours, mapper: Mapper, fixed: dict
) -> Block:
    """The block of a layer. `fixed` are `Corrections` by part number."""
    return jobs.drained(laying_out(layer, parts, tracks, found, mapper, fixed))


def laying_out(
    layer: int, parts: list[Part], tracks: dict[int, Track], found: Contours, mapper: Mapper, fixed: dict
) -> Iterator[float]:
    """As `lay_out`, with a step for each part."""
    parts = sorted((p for p in parts if p.number in tracks and p.layer == layer), key=lambda p: p.depth)
    frames = np.unique(np.concatenate([tracks[p.number].frames for p in parts] or [np.zeros(0, int)]))
    # A part with one key is tracked beyond all drawings.
    mapper.extend(frames.tolist())
    sizes = np.array([p.count for p in parts], np.int32)
    ends = np.concatenate([[0], np.cumsum(sizes)]).astype(int)
    columns = [slice(ends[i], ends[i + 1]) for i in range(len(parts))]
    block = Block(frames, sizes, np.zeros((len(frames), len(parts)), bool), columns)
    count, total = len(frames), int(ends[-1])
    for name in (gp.PIN, gp.CONFIDENCE, gp.CONTROL):
        block.point[name] = _blanks(name, count, total)
        yield 0.0
    block.own = found.own()
    # What tracking wrote is where the points are.
    block.point["position"] = block.point[gp.TRACKED] = np.zeros((count, total, 3), np.float32)
    for name in (gp.PART, gp.MADE, gp.CENTER):
        block.curve[name] = _blanks(name, count, len(parts))
    block.curve[gp.OWNER] = np.full((count, len(parts)), found.stamp, np.int32)
    block.curve[gp.POINTS] = np.repeat(sizes[None], count, 0)
    for index, part in enumerate(parts):
        _fill_part(block, index, part, tracks[part.number], mapper, fixed.get(part.number, Corrections()))
        _fill_style(block, index, part, found)
        yield 0.0
    if any(part.depths for part in parts):
        depths = [[part.depth_at(int(frame)) for part in parts] for frame in frames]
        block.order = np.argsort(np.array(depths).reshape(len(frames), len(parts)), axis=1, kind="stable")
    return block


def limit(block: Block, ob, layer: int, found: Contours) -> None:
    """Tells the block of a layer where its strokes end: with the footage, and where parts are hidden."""
    settings = ob.rototoon
    first, block.last = settings.first + settings.frame_offset, settings.last + settings.frame_offset
    hide(block, ob, layer, found, (first, block.last))


def hide(block: Block, ob, layer: int, found: Contours, within: tuple[int, int] | None = None) -> None:
    """Tells the block of a layer where parts are hidden, from a first to a last scene frame. Without them, on the block's own frames."""
    if within is None:
        within = (int(block.frames[0]), int(block.frames[-1])) if len(block.frames) else (0, -1)
    (first, last), offset = within, ob.rototoon.frame_offset
    own = {part.number for part in found.parts if part.layer == layer}
    times = [time for item in ob.rototoon.parts if item.number in own for time in absence.of(item)]
    hidden = (range(max(low + offset, first), min(high + offset, last) + 1) for low, high in times)
    block.hidden = frozenset(frame for span in hidden for frame in span)


def _blanks(name: str, frames: int, count: int, own: own_attributes.Kind | None = None) -> np.ndarray:
    """(frames, count[, k]): an attribute's default values. `own` is the kind of one of the artist's own."""
    like = gp.blank(name, count, own[0] if own else None)
    if not like.any():
        # The system gives zeros for nothing.
        return np.zeros((frames, *like.shape), like.dtype)
    return np.repeat(like[None], frames, 0)


def _fill_part(block: Block, index: int, part: Part, track: Track, mapper: Mapper, fixed: Corrections) -> None:
    rows = np.searchsorted(block.frames, track.frames)
    columns = block.columns[index]
    if mapper.still:
        points = mapper.at(part.layer, 0).to_layer(track.points).astype(np.float32)
    else:
        each = [mapper.at(part.layer, int(f)).to_layer(p) for f, p in zip(track.frames, track.points, strict=True)]
        points = np.stack(each).astype(np.float32)
    pins = block.point[gp.PIN]
    row_of = {int(frame): row for row, frame in enumerate(track.frames)}
    # A method that does not track beyond a single key makes no stroke for corrections there.
    for frame, pinned in fixed.pins.items():
        if frame not in row_of:
            continue
        which = list(pinned)
        points[row_of[frame], which] = fixed.held[frame][which]
        pins[rows[row_of[frame]], columns.start + np.array(which)] = True
    for frame, center in fixed.centers.items():
        if frame not in row_of:
            continue
        block.curve[gp.CENTER][rows[row_of[frame]], index] = (center[0], center[1], 1.0)
    block.point["position"][rows, columns] = points
    block.point[gp.CONFIDENCE][rows, columns] = track.confidence
    block.point[gp.CONTROL][:, columns] = correspondence.identity(part.count)
    block.curve[gp.PART][:, index] = part.number
    block.curve[gp.MADE][:, index] = True
    block.present[rows, index] = [int(frame) not in part.keys for frame in track.frames]


def _fill_style(block: Block, index: int, part: Part, found: Contours) -> None:
    point, curve, frames = styles(part, found, block.own)
    for into, given, count, place in (
        (block.point, point, int(block.sizes.sum()), block.columns[index]),
        (block.curve, curve, len(block.sizes), index),
    ):
        for name, values in given.items():
            if name not in into:
                into[name] = _blanks(name, len(block.frames), count, block.own.get(name))
            into[name][:, place] = mixed(name, values, frames, block.frames)


def write(layer, block: Block, before: Iterable[int]) -> int:
    """Writes a block into a layer, and removes generated strokes from the other frames of `before`.

    Drawings that hold their strokes already are not touched. Blender shows a drawing until the next one: where the strokes of a frame
    end, an empty generated drawing follows. Returns the number of strokes of the block.
    """
    return jobs.drained(write_steps(layer, block, before))


def write_steps(layer, block: Block, before: Iterable[int], read: Mapping[int, np.ndarray] | None = None) -> Iterator[float]:
    """As `write`, in steps of about `SLICE` seconds; yields the finished share.

    `read` has by frame the points that were read for this result. Raises `Changed` where a drawing has others by now: then it is not
    written, and the artist's change stays.
    """
    data, name = layer.id_data, layer.name
    generated.give_back(layer)
    wanted = {int(frame): row for row, frame in enumerate(block.frames) if block.present[row].any()}
    old = wanted.keys() & set(gp.frame_numbers(layer))
    keys = weights.Keys(layer)
    gp.make_frames(layer, wanted, gp.GENERATED)
    own = {frame for frame, (_, kind) in gp.drawings(layer).items() if kind != gp.GENERATED}
    beside = np.array([frame in own for frame in block.frames.tolist()], bool)
    block.curve[gp.BESIDE] = np.repeat(beside[:, None], len(block.sizes), 1)
    yield 0.0
    left = list(wanted.items())
    while left:
        due = _due(data, name, block, left, old, read or {})
        for frame, row in due:
            if frame not in old:
                keys.begin(_layer(data, name), frame, rows_of(block, row))
        drawings = gp.drawings(_layer(data, name))
        for frame, row in due:
            stroke_rows.replace_made(drawings[frame][0], rows_of(block, row))
        yield 1 - len(left) / len(wanted)
    _end(_layer(data, name), block, wanted, [frame for frame in before if frame not in wanted])
    return int(block.present.sum())


def _end(layer, block: Block, wanted: Iterable[int], others: list[int]) -> None:
    """Removes generated strokes from the frames `others`, and ends the strokes of the other frames."""
    drawings = gp.drawings(layer)
    # The artist may have removed some meanwhile.
    there = {frame: drawings[frame] for frame in others if frame in drawings}
    empty = {frame for frame, (handle, kind) in there.items() if kind == gp.GENERATED and len(gp.offsets(handle)) == 1}
    clear(layer, [frame for frame in others if frame not in empty])
    drawn = set(gp.frame_numbers(layer)) - empty
    ends = ends_of(wanted, drawn, block.last) | {frame for frame in block.hidden if frame - 1 in drawn and frame not in drawn}
    gp.remove_frames(layer, sorted(empty - ends))
    gp.make_frames(layer, sorted(ends), gp.GENERATED)


def ends_of(frames: Iterable[int], drawn: set[int], last: int | None) -> set[int]:
    """The frames after some frames, up to `last`, that have no drawing."""
    return set() if last is None else {f + 1 for f in frames if f + 1 not in drawn and f < last}


def _layer(data, name: str):
    layer = data.layers.get(name)
    if layer is None:
        raise Changed()
    return layer


def _due(data, name: str, block: Block, left: list[tuple[int, int]], old: set[int], read: Mapping[int, np.ndarray]) -> list:
    """Takes some frames with their rows from the front of `left`. Returns those whose generated strokes are not those of the block."""
    due, until, taken = [], time.perf_counter() + SLICE, 0
    with gp.copied(data) as copy:
        drawings = gp.drawings(_layer(copy, name))
        for frame, row in left:
            if frame not in drawings:
                raise Changed()
            handle = drawings[frame][0]
            if frame in old and frame in read and not np.array_equal(gp.positions(handle, len(read[frame])), read[frame]):
                raise Changed()
            if frame not in old or not stroke_rows.has_made(handle, rows_of(block, row)):
                due.append((frame, row))
            taken += 1
            if time.perf_counter() > until or len(due) == AT_ONCE:
                break
    del left[:taken]
    return due


def rows_of(block: Block, row: int) -> stroke_rows.Rows:
    """The strokes of one row of a block, which is a frame."""
    present = block.present[row]
    if block.order is not None:
        return _ordered(block, row)
    rows = stroke_rows.Rows(block.sizes[present], own=block.own)
    if present.all():
        rows.values = {name: values[row] for name, values in block.point.items()}
        rows.values |= {name: values[row] for name, values in block.curve.items()}
        return rows
    points = np.repeat(present, block.sizes)
    rows.values = {name: values[row][points] for name, values in block.point.items()}
    rows.values |= {name: values[row][present] for name, values in block.curve.items()}
    return rows


def _ordered(block: Block, row: int) -> stroke_rows.Rows:
    strokes = block.order[row][block.present[row][block.order[row]]]
    points = np.concatenate([np.arange(block.columns[i].start, block.columns[i].stop) for i in strokes])
    rows = stroke_rows.Rows(block.sizes[strokes], own=block.own)
    rows.values = {name: values[row][points] for name, values in block.point.items()}
    rows.values |= {name: values[row][strokes] for name, values in block.curve.items()}
    return rows


def clear(layer, frames: Iterable[int], keep_corrected: bool = False) -> int:
    """Removes generated strokes from frames, and generated frames that are empty then.

    With `keep_corrected`, drawings with corrections stay. Returns the number of cleared drawings.
    """
    drawings = gp.drawings(layer)
    gone, cleared = [], 0
    for frame in frames:
        if frame not in drawings:
            continue
        handle, kind = drawings[frame]
        made = generated.of(handle, kind)
        if keep_corrected and is_corrected(handle):
            continue
        if made.any():
            cleared += 1
            gp.remove_strokes(handle, np.flatnonzero(made).tolist())
        if made.all() and (kind == gp.GENERATED or len(made)):
            gone.append(frame)
    gp.remove_frames(layer, gone)
    return cleared


def is_corrected(handle) -> bool:
    """Whether a drawing's generated strokes have a pin, a corrected centre, or moved points."""
    starts = gp.offsets(handle)
    total, strokes = int(starts[-1]), len(starts) - 1
    made = gp.value(handle, gp.MADE, strokes)
    tracked = gp.get(handle, gp.TRACKED, total)
    moved = np.zeros(total, bool) if tracked is None else (tracked != gp.positions(handle, total)).any(1)
    touched = (moved | gp.value(handle, gp.PIN, total)) & np.repeat(made, np.diff(starts))
    return bool(touched.any() or (gp.value(handle, gp.CENTER, strokes)[:, 2] != 0)[made].any())

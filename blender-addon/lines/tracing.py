"""One run of tracing: it reads layers, traces in a thread, and writes strokes on generated frames.

Trace Drawing, Carry Strokes and the scripts' functions use it. Nothing in the file changes before `finishing`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

import numpy as np
from rototoon import Session
from rototoon.lines import Traced

from ..blender import grease_pencil as gp
from ..blender import guard, holds, marks, own_attributes, stroke_rows
from ..blender import strokes as st
from ..blender.errors import Problem
from ..common import jobs
from . import drawings as dr
from . import aside, explained, looks, moved, numbers, off_ink, records
from . import plan as pl

make: Callable[[dict[str, Any], str], Any] = Session.from_document
"""Makes a session from a document and its folder. Tests replace it."""


@dataclass(frozen=True)
class Options:
    """What the artist chose."""

    style: str = "auto"
    sensitivity: float = 1.0
    threads: int = 0
    leave_out: tuple[tuple[float, ...], ...] = ()
    """Colours of pencils whose lines are left out."""


@dataclass
class Done:
    """What a run has written."""

    strokes: int = 0
    frames: set[int] = field(default_factory=set)
    numbers: set[numbers.Key] = field(default_factory=set)
    kept: int = 0
    """Number of drawings of the artist that were changed traced drawings before."""
    breaks: set[int] = field(default_factory=set)
    """Frames on which many strokes end or begin: identity may be lost there."""
    confidence: dict[numbers.Key, dict[int, float]] = field(default_factory=dict)
    """Of each stroke, by scene frame."""
    bare: set[int] = field(default_factory=set)
    """Scene frames on which lines were looked for, and none or hardly any were found."""

    off: set[int] = field(default_factory=set)
    """Scene frames of drawings of the artist with many strokes that lie on no line of their picture."""


Materials = Mapping[tuple[int, bool], int]
"""By number, and whether it is a shape: the index of a material."""
_NONE: Materials = MappingProxyType({})
Own = Mapping[str, own_attributes.Kind]
_NO_OWN: Own = MappingProxyType({})

BREAK = 0.3
"""Share of the length of lines that belongs to strokes that end or begin, from which a frame is said."""


def worker(plan: pl.Plan, options: Options, afterwards: Callable[[], None] = lambda: None) -> jobs.Worker:
    """The work of a plan, for a thread. Its result is a `Traced` for each group. `afterwards` is called at the end, failed or not."""

    def run(progress) -> list[Traced]:
        try:
            return traced(progress)
        finally:
            afterwards()

    def traced(progress) -> list[Traced]:
        found = []
        pl.find_held(plan)
        for k, group in enumerate(plan.groups):
            share, begun = 1 / len(plan.groups), k / len(plan.groups)
            within = lambda done, step, begun=begun, share=share: progress(begun + share * done, step)  # noqa: E731 - bound to this group
            more = {"leave_out": options.leave_out, "keep_first": group.keep_first}
            found.append(_traced(group.document, group.folder, group.pictures, options, within, **more))
        off_ink.find(plan, lambda document, folder, pictures: _traced(document, folder, pictures, options, lambda _, step: progress(1.0, step)))
        return found

    return jobs.Worker(run)


def _traced(document: dict[str, Any], folder: str, pictures: tuple[int, int], options: Options, progress, **more) -> Traced:
    session = make(document, folder)
    try:
        return session.trace(options.style, options.sensitivity, pictures, progress, threads=options.threads, **more)
    finally:
        session.close()


@dataclass
class Placed:
    """A traced stroke on one frame."""

    number: int
    points: np.ndarray
    closed: bool
    widths: np.ndarray
    colour: np.ndarray
    confidence: float = 1.0
    """The probability that it is the stroke of its number."""
    fill: bool = False
    """Whether it is the outline of a solid shape, which is filled and has no line."""
    opacity: float = 1.0
    """Below 1 while it fades."""
    fields: int = 0
    """The number of its further fields in a document; 0 for none."""
    fill_colour: np.ndarray | None = None
    """The colour of the fill of a stroke that has a line too."""

    @property
    def place(self) -> tuple[bool, float, int]:
        """Its place from back to front: shapes are behind lines, and a larger one is behind a smaller one, such as its hole."""
        x, y = self.points[:, 0], self.points[:, 1]
        area = abs(float(np.dot(x, np.roll(y, 1)) - np.dot(y, np.roll(x, 1)))) if self.fill else 0.0
        return not self.fill, -area, self.number


def finishing(ob, plan: pl.Plan, found: list[Traced], home: str, beside: Sequence[tuple[pl.Group, Traced]] = ()) -> Iterator[float]:
    """Writes the result of a plan in steps, and yields the finished share. Returns a `Done`. `beside` are groups that another run writes.

    New strokes go to the layer `home`, which must be one of the plan's. Raises a `Problem` if the artist's drawings have changed.
    """
    guard.need(ob)
    layers = [layer for group in plan.groups for layer in group.layers]
    names = [layer.name for layer in layers]
    _need_unchanged(ob, names, plan)
    if gp.find_layer(ob, home) is None:
        # What was traced is edited next, and carried from the active layer.
        gp.activate(ob, gp.layer(ob, home))
    yield 0.0
    done, kept = Done(), moved.read(ob, names)
    counter = numbers.Counter({layer.name: layer.next_track(plan.first, plan.last) for layer in layers})
    results = [_result(*each, plan.offset, counter, home) for each in (*zip(plan.groups, found, strict=True), *beside)]
    for own in results[: len(found)]:
        group, traced, keyed = own.group, own.traced, own.keyed
        if group.new:
            found_bare = bare(traced, group.document["footage"]["height"])
            # What the artist has drawn there was not looked for.
            done.bare |= {number + plan.offset for number in found_bare} & set(range(plan.first, plan.last + 1)) - group.seeds.keys()
        left_out = yield from _left_out(ob, own, [each for each in results if each is not own], plan.offset, home)
        for k, layer in enumerate(group.layers):
            record = kept.setdefault(layer.name, records.Layer())
            _mark_keys(ob, layer, group, k, keyed, record, done)
            yield from _mark_off(ob, layer, group, k, plan, done)
            placed = _placed(group, layer, k, traced, keyed, plan, left_out)
            yield from write(ob, layer, group.mapper, k, placed, _looks_of(group, k, keyed), record, done)
            aside.clear(ob, layer.name, placed)
    records.write(ob.data, kept)
    ob.data.update_tag()
    return done


def _result(group: pl.Group, traced: Traced, offset: int, counter, home: str) -> explained.Result:
    own = [layer.name for layer in group.layers]
    return explained.Result(group, traced, _keyed(group, traced, offset, counter, home if home in own else own[-1]))


def _left_out(ob, own: explained.Result, others: list[explained.Result], offset: int, home: str) -> Iterator[float]:
    """Returns the strokes of a group that are not drawn. In steps: to compare all lines of a film takes seconds."""
    if not own.group.new:
        return {key for each in own.keyed.values() for key in each} - own.followed()
    if home == ob.rototoon.lines_layer and not own.group.seeds:
        # Trace Drawing draws all lines there, and so does this.
        return set()
    return (yield from explained.strokes(own, others, offset))


def _need_unchanged(ob, names: list[str], plan: pl.Plan) -> None:
    missing = [name for name in names if plan.sums[name] and gp.find_layer(ob, name) is None]
    if missing:
        raise Problem(f'The layer "{missing[0]}" was removed during the work, so the result was dropped')
    guard.need_apart(ob, names)
    if {layer.name: layer.sums() for layer in dr.read(ob, names)} != {name: plan.sums[name] for name in names}:
        raise Problem("The drawings changed while they were traced, so the result was dropped: try again")


def _keyed(group: pl.Group, traced: Traced, offset: int, counter, home: str) -> dict[int, list[numbers.Key]]:
    starts, tracks = traced.stroke_offsets, traced.tracks.tolist()
    by_frame = {
        frame + offset: tracks[starts[k] : starts[k + 1]] for k, frame in enumerate(traced.frames.tolist())
    }
    drawn = {frame: seed.keys for frame, seed in group.seeds.items()}
    return numbers.keyed(by_frame, drawn, counter, home)


def _mark_keys(ob, layer: dr.Layer, group: pl.Group, k: int, keyed, record: records.Layer, done: Done) -> None:
    """Gives the strokes of the artist's drawings their numbers, and makes changed traced drawings the artist's."""
    target = gp.find_layer(ob, layer.name)
    gp.make_own(target, layer.keys.keys() & group.seeds.keys())
    handles, slots = gp.drawings(target), marks.Slots(ob.data)
    for frame, seed in group.seeds.items():
        if frame not in layer.keys:
            continue
        content = layer.keys[frame]
        numbered = content.strokes(gp.TRACK).copy()
        for (_, number), (which, index) in zip(keyed[frame], seed.sources, strict=True):
            if which == k:
                numbered[index] = number
        content.set_strokes(gp.TRACK, numbered)
        dr.mark(content, slots)
        record.numbers[frame] = numbered.tolist()
        for name, values in ((gp.TRACK, numbered), (gp.LOOK, content.strokes(gp.LOOK))):
            gp.put(handles[frame][0], name, values)
        for name in (gp.TRACKED, gp.LINE, gp.ALONG):
            gp.put(handles[frame][0], name, content.point[name])
    marks.remember(ob.data)
    dr.keep(ob, layer)
    done.kept += len(layer.edited)


def _mark_off(ob, layer: dr.Layer, group: pl.Group, k: int, plan: pl.Plan, done: Done) -> Iterator[float]:
    """Marks the strokes of the artist's drawings that lie on no line of their picture, in steps of a drawing."""
    size = group.document["footage"]["width"], group.document["footage"]["height"]
    frames = plan.inks.keys() & layer.keys.keys() if group.new else set()
    handles = gp.drawings(gp.find_layer(ob, layer.name)) if frames else {}
    for frame in sorted(frames):
        off = off_ink.strokes_off(layer.keys[frame], group.mapper.at(k, frame), plan.inks[frame], size)
        off_ink.mark(handles[frame][0], off)
        if off.any():
            done.off.add(frame)
        yield 0.0


def _looks_of(group: pl.Group, k: int, keyed) -> looks.Looks:
    """The artist's strokes on a layer, by number. Of traced drawings only the numbers serve."""
    layer, found = group.layers[k], looks.Looks()
    for frame, seed in group.seeds.items():
        if frame not in layer.keys:
            continue
        for (_, number), (which, index) in zip(keyed[frame], seed.sources, strict=True):
            if which == k:
                found.add(number, frame, layer.keys[frame], index)
    return found


def _placed(group, layer: dr.Layer, k: int, traced: Traced, keyed, plan: pl.Plan, left_out: set[numbers.Key]) -> dict[int, list[Placed] | None]:
    """The strokes of a layer on the frames that are written, by number, but for those `left_out`; `None` for a frame that holds the drawing before."""
    points, widths = np.asarray(traced.points).reshape(-1, 2), np.asarray(traced.widths)
    colours, ends, sure = np.asarray(traced.colours).reshape(-1, 3), traced.point_offsets, traced.confidence
    closed, fills = traced.closed, traced.fills
    result: dict[int, list[Placed]] = {}
    for place, number in enumerate(traced.frames.tolist()):
        frame = number + plan.offset
        if not plan.first <= frame <= plan.last or frame in layer.kept:
            continue
        first = traced.stroke_offsets[place]
        strokes = []
        for i, key in enumerate(keyed[frame], first):
            if key[0] != layer.name or key in left_out:
                continue
            span = slice(ends[i], ends[i + 1])
            own = key[1], points[span], bool(closed[i]), widths[span], colours[i], float(sure[i]), bool(fills[i])
            strokes.append(Placed(*own))
        result[frame] = sorted(strokes, key=lambda stroke: stroke.place)
    if group.mapper.still:
        # A held picture shows the drawing before it, also one of the artist.
        held = plan.held | ({number + plan.offset for number in repeats(traced)} if plan.hold else set())
        for frame in sorted(held & result.keys()):
            if frame - 1 in result or frame - 1 in layer.keys or frame - 1 in held:
                result[frame] = None
    return result


SHORT, FEW = 0.3, 0.1
"""Length of hardly any lines, in heights of the picture and as a share of the film's median. The command line has the same bounds."""


def bare(traced: Traced, height: float) -> set[int]:
    """The pictures without a line, or with hardly any."""
    points, ends = np.asarray(traced.points).reshape(-1, 2), np.asarray(traced.point_offsets)
    own = [points[a:b] for a, b in zip(ends, ends[1:])]
    own = [np.concatenate([line, line[:1]]) if shut else line for line, shut in zip(own, np.asarray(traced.closed), strict=True)]
    lengths = [float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum()) for line in own]
    bounds = np.asarray(traced.stroke_offsets).tolist()
    by_frame = [sum(lengths[a:b]) for a, b in zip(bounds, bounds[1:])]
    least = max(SHORT * height, FEW * sorted(by_frame)[len(by_frame) // 2]) if by_frame else 0.0
    return {number for number, length in zip(traced.frames.tolist(), by_frame, strict=True) if length < least}


def repeats(traced: Traced) -> set[int]:
    """The pictures that have the strokes of the picture before, to the last digit: the library found that they show the same drawing."""
    numbers, bounds, ends = traced.frames.tolist(), traced.stroke_offsets.tolist(), np.asarray(traced.point_offsets)
    by_stroke = [np.asarray(each) for each in (traced.tracks, traced.closed, traced.fills, traced.colours)]
    by_point = [np.asarray(each) for each in (traced.points, traced.widths)]

    def content(place: int) -> list[np.ndarray]:
        low, high = bounds[place], bounds[place + 1]
        strokes = [each[low:high] for each in [*by_stroke, np.diff(ends)]]
        return strokes + [each[ends[low] : ends[high]] for each in by_point]

    def same(a: int, b: int) -> bool:
        return all(np.array_equal(p, q, equal_nan=True) for p, q in zip(content(a), content(b), strict=True))

    return {number for k, number in enumerate(numbers) if k and numbers[k - 1] == number - 1 and same(k - 1, k)}


def write(ob, layer: dr.Layer, mapper, k: int, placed, shown: looks.Looks, record, done: Done, known: Materials = _NONE) -> Iterator[float]:
    """Writes the strokes of one layer, with a step for each frame. `known` are materials that are given."""
    target = gp.find_layer(ob, layer.name)
    held = {frame for frame, strokes in placed.items() if strokes is None}
    placed = {frame: strokes for frame, strokes in placed.items() if strokes is not None}
    gp.remove_frames(target, sorted(held & layer.made.keys()))
    gp.make_frames(target, placed, gp.GENERATED)
    handles, names, own, materials = gp.drawings(target), shown.names(), shown.own(), materials_of(ob, placed, shown, known)
    for count, (frame, strokes) in enumerate(placed.items(), 1):
        rows = rows_of(frame, strokes, shown, names, materials, mapper.at(k, frame), own)
        note_looks(rows, ob.data)
        stroke_rows.replace_made(handles[frame][0], rows)
        if gp.drawings(target)[frame][1] != gp.GENERATED:
            gp.set_keyframe_type(target, {frame: gp.GENERATED})
        record.sums[frame] = records.checksum(rows.values["position"], rows.values[gp.TRACK], rows.sizes)
        record.numbers[frame] = rows.values[gp.TRACK].tolist()
        done.strokes += len(strokes)
        done.frames.add(frame)
        done.numbers.update((layer.name, stroke.number) for stroke in strokes)
        for stroke in strokes:
            done.confidence.setdefault((layer.name, stroke.number), {})[frame] = stroke.confidence
        yield count / len(placed)
    marks.note(ob.data, layer.name, placed)
    holds.note(ob.data, layer.name, held, placed)
    record.marked |= placed.keys()
    done.breaks |= _breaks(placed)
    for frame in [frame for frame in record.sums if frame in layer.kept or frame not in handles]:
        del record.sums[frame]
    record.marked &= record.sums.keys()
    for frame in [frame for frame in record.numbers if frame not in handles]:
        del record.numbers[frame]


def _breaks(placed: dict[int, list[Placed]]) -> set[int]:
    """The frames on which many strokes end or begin, against the drawing before."""
    found, before = set(), None
    for frame, strokes in placed.items():
        now = {stroke.number: _length(stroke.points) for stroke in strokes}
        if before is not None and frame - before[0] <= 2:
            other = before[1]
            gone = sum(each for number, each in other.items() if number not in now)
            new = sum(each for number, each in now.items() if number not in other)
            if gone + new > BREAK * (sum(other.values()) + sum(now.values())) > 0:
                found.add(frame)
        before = frame, now
    return found


def _length(points: np.ndarray) -> float:
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


def materials_of(ob, placed, shown: looks.Looks, known: Materials = _NONE) -> Materials:
    """The material of each number that no stroke of the artist has, as a line and as a shape: one for each ink. Those of `known` stay."""
    strokes = [each for strokes in placed.values() for each in strokes if each.number not in shown.sources]
    strokes = [each for each in strokes if (each.number, each.fill) not in known]
    found: dict[tuple[int, bool], int] = dict(known)
    for fill in (False, True):
        colours: dict[int, list[np.ndarray]] = {}
        lengths: dict[int, float] = {}
        for stroke in (stroke for stroke in strokes if stroke.fill == fill):
            colours.setdefault(stroke.number, []).append(stroke.colour)
            lengths[stroke.number] = lengths.get(stroke.number, 0.0) + len(stroke.points)
        if not colours:
            continue
        every = list(colours)
        means = np.nan_to_num(np.array([np.mean(colours[number], axis=0) for number in every]))
        which, inks = looks.inks(means, np.array([lengths[number] for number in every]))
        places = [looks.material(ob, colour, fill) for colour in inks]
        found.update({(number, fill): places[ink] for number, ink in zip(every, which)})
    return found


def rows_of(
    frame: int, strokes: list[Placed], shown: looks.Looks, names: list[str], materials: Materials, mapping, own: Own = _NO_OWN
) -> stroke_rows.Rows:
    """The strokes of a frame as attributes. `names` and `own` are those of their looks."""
    rows = stroke_rows.Rows(np.array([len(stroke.points) for stroke in strokes], np.int32), own=dict(own))
    points = np.concatenate([stroke.points for stroke in strokes]) if strokes else np.zeros((0, 2))
    total, count = len(points), len(strokes)
    places = mapping.to_layer(points) if total else np.zeros((0, 3))
    for name in dict.fromkeys(("radius", "opacity", *names)):
        rows.values[name] = gp.blank(name, total if gp.TYPES[name][1] == "POINT" else count)
    for name, (kind, domain) in own.items():
        rows.values[name] = gp.blank(name, total if domain == "POINT" else count, kind)
    rows.values["position"] = places.astype(np.float32)
    rows.values["material_index"] = gp.blank("material_index", count)
    rows.values["cyclic"] = np.array([stroke.closed for stroke in strokes], bool)
    rows.values[gp.TRACK] = np.array([stroke.number for stroke in strokes], np.int32)
    rows.values[gp.MADE] = np.ones(count, bool)
    rows.values[gp.TRACKED] = rows.values["position"]
    rows.values[gp.LINE] = np.repeat(rows.values[gp.TRACK], rows.sizes)
    rows.values[gp.ALONG] = gp.blank(gp.ALONG, total)
    rows.values[gp.LOOK] = gp.blank(gp.LOOK, count)
    sure = np.array([stroke.confidence for stroke in strokes], np.float32)
    if (sure < 1).any():
        # Without values every stroke is beyond doubt.
        rows.values[gp.CONFIDENCE] = np.repeat(sure, rows.sizes)
    if gp.FILL_BY_ID and any(stroke.fill or stroke.fill_colour is not None for stroke in strokes):
        for name in ("fill_id", "hide_stroke"):
            rows.values.setdefault(name, gp.blank(name, count))
    if not count:
        return rows
    rows.values["radius"][:] = _radii(points, np.concatenate([stroke.widths for stroke in strokes]), mapping)
    _dress(rows, frame, strokes, shown, names, materials)
    return rows


def note_looks(rows: stroke_rows.Rows, data) -> None:
    """Notes the looks of strokes of Grease Pencil data, so that a change of the artist shows."""
    if len(rows.sizes):
        rows.values[gp.LOOK] = marks.stroke_looks(st.of_rows(rows), marks.Slots(data).now)
        marks.remember(data)


def _dress(rows: stroke_rows.Rows, frame: int, strokes: list[Placed], shown: looks.Looks, names: list[str], materials) -> None:
    """Gives strokes the look of the drawings around the frame, and those that have none a material of their ink."""
    starts = np.concatenate([[0], np.cumsum(rows.sizes)])
    for i, stroke in enumerate(strokes):
        where = rows.values[gp.ALONG][starts[i] : starts[i + 1]] = dr.shares(stroke.points)
        found = shown.around(stroke.number, frame)
        if found is None:
            rows.values["material_index"][i] = materials[stroke.number, stroke.fill]
            if gp.FILL_BY_ID and (stroke.fill or stroke.fill_colour is not None):
                rows.values["fill_id"][i], rows.values["hide_stroke"][i] = gp.FILL_BASE + stroke.number, stroke.fill
            continue
        for name in names:
            if gp.TYPES[name][1] == "POINT":
                rows.values[name][starts[i] : starts[i + 1]] = looks.of_points(found, name, where)
            elif name != "cyclic":
                rows.values[name][i] = looks.of_stroke(found[0], name)
        for name, kind in rows.own.items():
            span = slice(starts[i], starts[i + 1]) if kind[1] == "POINT" else slice(i, i + 1)
            rows.values[name][span] = looks.of_own(found, name, kind, where)


def _radii(points: np.ndarray, widths: np.ndarray, mapping) -> np.ndarray:
    """Radius of lines of a width in pixels."""
    if not np.isfinite(widths).any():
        return gp.blank("radius", len(points))
    return mapping.radii(points, np.nan_to_num(widths, nan=2.0) / 2)

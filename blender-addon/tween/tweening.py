"""In-betweens of an object, drawn where something has changed.

`plan` reads, `draw` works without Blender in a thread, `finish` writes. A span is left alone if its keys, pairs and choices are
those from which it was drawn.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field

import numpy as np
from rototoon import tween

from ..blender import camera, guard, hierarchy
from ..blender import grease_pencil as gp
from ..blender.errors import Problem
from ..blender.seen import Seen, changed
from ..common.wording import are, listed
from . import between, breakdowns, captured, layer_pegs, moved_keys, records, sheets, surroundings
from . import keys as ks
from . import numbers as tween_numbers
from .charts import Choices

Choose = Callable[[str, ks.Frames, records.Layer], dict[tuple[int, int], Choices]]
"""Chooses the spans of a layer to draw, between neighbouring keys, and their choices."""


@dataclass
class Call:
    """One call of the library."""

    sheet: sheets.Sheet
    laid: sheets.Laid
    spans: list[int]
    drawn: tween.InBetweens | None = None
    matches: tween.Matches | None = None


@dataclass
class Plan:
    """Everything that will be drawn."""

    seen: Seen
    """The keys, as they were read."""
    calls: list[Call] = field(default_factory=list)
    records: dict[str, records.Layer] = field(default_factory=dict)
    frames: dict[str, ks.Frames] = field(default_factory=dict)
    current: int = 0
    """Number of spans that are up to date."""
    blank: int = 0
    """Number of chosen spans with a blank key."""
    blank_frames: set[int] = field(default_factory=set)
    """The blank keys at which they end."""
    again: bool = False
    """Whether spans that are up to date are drawn too."""
    stepped: set[tuple[int, int, int]] = field(default_factory=set)
    """Chosen spans that have frames between their keys, but none by their step: first and last frame, and the step."""
    marks: dict[str, dict[int, breakdowns.Marks]] = field(default_factory=dict)
    """By layer and frame the marks of in-betweens that are keys now, and of the keys around them."""
    strays: dict[str, set[int]] = field(default_factory=dict)
    """By layer the frames of in-betweens that a moved key has left behind, outside of all spans that are drawn."""


def plan(ob, layers: Iterable, choose: Choose, again: bool = False) -> Plan:
    """The plan for some layers. With `again`, spans that are up to date are drawn too."""
    result = Plan(Seen(ob), records=records.read(ob.data), again=again)
    groups: dict[tuple, list[str]] = {}
    spans: dict[str, dict[tuple[int, int], Choices]] = {}
    for layer in layers:
        name = layer.name
        before = result.records.get(name, records.Layer())
        found = result.frames[name] = ks.frames_of(layer, before)
        result.marks[name] = breakdowns.passed_on(layer, found.keys, found.edited)
        followed = moved_keys.followed(layer, before, found.keys)
        record = result.records[name] = followed.record
        spans[name] = choose(name, found, record)
        result.strays[name] = followed.strays(found, spans[name])
        # Layers with another carrier get another sheet, in the space of their carrier.
        carrier = hierarchy.carrier(ob, layer)
        wanted = tuple(sorted((span, choices) for span, choices in spans[name].items()) if spans[name] else ())
        key = (tuple(found.keys), tuple(sorted(found.blank)), tuple(map(repr, wanted)), carrier)
        groups.setdefault(key, []).append(name)
    follow = any(choices.follow for wanted in spans.values() for choices in wanted.values())
    parts = captured.read(ob) if follow else []
    for names in groups.values():
        _plan_group(ob, names, spans[names[0]], parts, result)
    return result


def _drawn(ob, names: list[str], run: list[int], to_sheet: list[np.ndarray]) -> Iterator[np.ndarray]:
    """The points of keys in the space of their sheet, drawing by drawing, the first layer's first drawing first."""
    for name, to in zip(names, to_sheet):
        drawings = gp.drawings(gp.find_layer(ob, name))
        for frame in run:
            handle = drawings[frame][0]
            points = gp.positions(handle, int(gp.offsets(handle)[-1]))
            yield points @ to[:3, :3].T + to[:3, 3]


def _plan_group(
    ob, names: list[str], wanted: dict[tuple[int, int], Choices], parts: list[captured.Part], result: Plan
) -> None:
    found, record = result.frames[names[0]], result.records[names[0]]
    for run in _runs(found):
        number = {(run[k], run[k + 1]): k for k in range(len(run) - 1)}
        mine = {number[span]: choices for span, choices in wanted.items() if span in number}
        result.stepped |= {(run[k], run[k + 1], c.step) for k, c in mine.items() if run[k + 1] - run[k] > 1 and not c.frames(run[k], run[k + 1])}
        mine = {k: choices for k, choices in mine.items() if choices.frames(run[k], run[k + 1])}
        if not mine:
            continue
        usual = next(iter(mine.values()))
        choices = [mine.get(k) or record.choices(run[k], run[k + 1]) or usual for k in range(len(run) - 1)]
        matrices = [camera.need_size(ob, hierarchy.in_carrier(gp.find_layer(ob, name))) for name in names]
        to_sheet = [np.linalg.inv(matrices[0]) @ matrix for matrix in matrices]
        plane = sheets.Plane.of(_drawn(ob, names, run, to_sheet), to_sheet)
        sheet = sheets.Sheet(names, run, plane, mine, choices)
        surroundings.prepare(ob, sheet, next(_drawn(ob, names, run, to_sheet)))
        captured.put_on(ob, sheet, parts)
        sheet.read(ob, result.marks, result.seen)
        for k in [k for k in mine if not result.again and _is_current(sheet, k, result)]:
            del sheet.wanted[k]
            result.current += 1
        _add_calls(ob, sheet, result)
    blank = found.blank - found.ends
    result.blank += sum(span[0] in blank or span[1] in blank for span in wanted)
    result.blank_frames |= {frame for span in wanted for frame in span if frame in blank}


def _runs(found: ks.Frames) -> list[list[int]]:
    """Runs of consecutive keys without a blank key."""
    runs: list[list[int]] = [[]]
    for frame in found.keys:
        if frame in found.blank:
            runs.append([])
        else:
            runs[-1].append(frame)
    return [run for run in runs if len(run) > 1]


def _is_current(sheet: sheets.Sheet, k: int, result: Plan) -> bool:
    """Whether a span is up to date on all layers."""
    frames = set(sheet.wanted[k].frames(sheet.frames[k], sheet.frames[k + 1]))
    for name in sheet.layers:
        span = result.records[name].spans.get(sheet.frames[k])
        if span is None or span.last != sheet.frames[k + 1] or span.digest != sheet.digests[k]:
            return False
        if not frames <= set(result.frames[name].made):
            return False
    return True


def _add_calls(ob, sheet: sheets.Sheet, result: Plan) -> None:
    by_choices: dict[tuple[str, int], list[int]] = {}
    for k in sorted(sheet.wanted):
        # Pegs of layers are at rest on the first key of their span, so these spans are drawn one by one.
        alone = k if any(sheet.pegs_of(k)) else -1
        by_choices.setdefault((repr(sheet.wanted[k].shared()), alone), []).append(k)
    if by_choices:
        needed = {key for k in sheet.wanted for key in sheet.around(k)}
        sheet.contents = {key: each for key, each in sheet.contents.items() if key in needed}
        laid = sheets.lay_out(ob, sheet)
        result.calls += [Call(sheet, laid, spans) for spans in by_choices.values()]


def draw(plan: Plan, progress: tween.Progress, threads: int = 0) -> None:
    """Draws everything of a plan. It does not use Blender, so it may run in a thread."""
    for number, call in enumerate(plan.calls):
        sheet = call.sheet

        def told(fraction: float, step: str, number: int = number) -> bool | None:
            return progress((number + fraction) / len(plan.calls), step)

        spans = [(k, sheet.wanted[k].frames(sheet.frames[k], sheet.frames[k + 1])) for k in call.spans]
        needed = {key for k in call.spans for key in sheet.around(k)[:-1]}
        spacing = [sheet.spacing(k) if k in needed else "smooth" for k in range(len(sheet.frames) - 1)]
        first = call.spans[0]
        options = {**sheet.wanted[first].shared(), "leaving": sheet.leaving(first)}
        # Contours are given span by span, since another span may not follow them.
        options["captured"] = [each.written() for k in call.spans for each in sheet.captured.get(k, ())]
        if any(sheet.pegs_of(first)):
            options |= layer_pegs.options(sheet, call.laid, first, None, threads)
        call.drawn, call.matches = tween.draw_in_betweens(
            call.laid.drawings, spans, told, spacing=spacing, threads=threads, **options
        )


@dataclass
class Done:
    """What `finish` has written."""

    spans: int = 0
    drawings: int = 0
    keys: int = 0
    """Number of in-betweens that became keys."""
    key_frames: set[int] = field(default_factory=set)
    """Their frames."""
    held: set[tuple[int, int]] = field(default_factory=set)
    """Keys between which the earlier one is held, because no movement between the two can be believed."""
    exchanged: dict[tuple[int, int], int] = field(default_factory=dict)
    """The number of strokes that give way to others half way between two keys."""


def finish(ob, plan: Plan) -> Done:
    """Writes a drawn plan. Raises a `Problem` if one of its layers is closed by now, or was changed where the plan writes."""
    guard.need(ob)
    guard.need_open(gp.find_layer(ob, name) for name in plan.frames)
    _need_unchanged(ob, plan)
    done = Done()
    for name, found in plan.frames.items():
        done.keys += len(found.edited)
        done.key_frames |= set(found.edited)
        adopt(gp.find_layer(ob, name), found, found.edited)
    pairs: dict[str, dict[int, list[tuple[int, int]]]] = {}
    for call in plan.calls:
        collect_pairs(call, pairs)
    numbers = {name: number_keys(ob, name, plan, pairs.get(name, {})) for name in plan.frames if name in pairs}
    for call in plan.calls:
        done.spans += len(call.spans)
        held = [k for k, held in zip(call.spans, call.drawn.held) if held]
        done.held |= {(call.sheet.frames[k], call.sheet.frames[k + 1]) for k in held}
        exchanged: dict[tuple[int, int], np.ndarray] = {}
        for block in between.blocks(call.sheet, call.laid, call.spans, call.drawn):
            keys = block.first, block.last
            exchanged[keys] = exchanged.get(keys, np.zeros(2, int)) + block.exchanged
            span = call.sheet.frames.index(block.first)
            sums = between.write(ob, block, _tracks(block, numbers[block.layer]))
            done.drawings += len(sums)
            _note(plan.records[block.layer], block, call.sheet, span, sums)
        for keys, counts in exchanged.items():
            if counts.any():
                done.exchanged[keys] = done.exchanged.get(keys, 0) + int(counts.max())
    for name, frames in plan.strays.items():
        gp.remove_frames(gp.find_layer(ob, name), sorted(frames))
        moved_keys.note(gp.find_layer(ob, name), plan.records[name])
    records.write(ob.data, plan.records)
    ob.data.update_tag()
    return done


def _need_unchanged(ob, plan: Plan) -> None:
    kept = records.read(ob.data)
    for name, found in plan.frames.items():
        layer = gp.find_layer(ob, name)
        if layer is None:
            raise changed(name)
        keys = set(ks.frames_of(layer, kept.get(name, records.Layer())).keys)
        spans = [(call.sheet.frames[k], call.sheet.frames[k + 1]) for call in plan.calls if name in call.sheet.layers for k in call.spans]
        fresh = {f for f in keys - set(found.keys) if f in plan.strays[name] or any(first < f < last for first, last in spans)}
        for frame in sorted(fresh or set(found.keys) - keys):
            raise changed(name, frame)
    drawn = [call.sheet for call in plan.calls]
    plan.seen.need((name, sheet.frames[key]) for sheet in drawn for key in sheet.contents for name in sheet.layers)


def adopt(layer, found: ks.Frames, frames: Iterable[int]) -> None:
    """Makes in-betweens the artist's keys, as breakdowns. Their strokes stay paired with those of the keys around."""
    breakdowns.write(layer, breakdowns.passed_on(layer, found.keys, frames))
    drawings = gp.drawings(layer)
    for frame in frames:
        handle = drawings[frame][0]
        gp.put(handle, gp.TWEENED, np.zeros(len(gp.offsets(handle)) - 1, bool))
    gp.set_keyframe_type(layer, dict.fromkeys(frames, "BREAKDOWN"))


def _note(record: records.Layer, block: between.Block, sheet: sheets.Sheet, span: int, sums: dict[int, int]) -> None:
    for first in [f for f, known in record.spans.items() if f < block.last and block.first < known.last]:
        known = record.spans[first]
        kept = {frame: total for frame, total in known.sums.items() if not block.first < frame < block.last}
        if first == block.first or not kept:
            del record.spans[first]
        else:
            # A key now divides this span. The rest of the span is drawn again at the next update.
            known.sums = kept
            known.digest = ""
    record.spans[block.first] = records.Span(block.last, sheet.digests[span], sheet.wanted[span], sums, marked=True)


def collect_pairs(call: Call, into: dict[str, dict[int, list[tuple[int, int]]]]) -> None:
    """Adds the pairs of strokes by index, by layer and frame of the earlier key."""
    sheet, first = call.sheet, call.laid.first_stroke
    offsets, rows = np.asarray(call.matches.offsets), np.asarray(call.matches.rows).reshape(-1, 4)
    for name in sheet.layers:
        into.setdefault(name, {})
    for span in call.spans:
        found = rows[offsets[span] : offsets[span + 1]]
        for layer, name in enumerate(sheet.layers):
            starts = first[span, layer], first[span + 1, layer]
            count = len(sheet.contents[span][layer].sizes)
            mine = found[(found[:, 0] == tween.PAIR) & (found[:, 1] >= starts[0]) & (found[:, 1] < starts[0] + count)]
            into[name][sheet.frames[span]] = [(int(r[1] - starts[0]), int(r[2] - starts[1])) for r in mine]


def number_keys(ob, name: str, plan: Plan, pairs: dict[int, list[tuple[int, int]]]) -> dict[int, np.ndarray]:
    """Numbers the strokes of all keys, and of in-betweens whose keys get other numbers. Returns the keys' numbers by frame."""
    layer = gp.find_layer(ob, name)
    record, found = plan.records[name], plan.frames[name]
    gp.make_own(layer, found.keys)
    drawings = gp.drawings(layer)
    handles = [drawings[frame][0] for frame in found.keys]
    known = [gp.value(handle, gp.TRACK, len(gp.offsets(handle)) - 1) for handle in handles]
    matched = {k: pairs[frame] for k, frame in enumerate(found.keys) if frame in pairs}
    numbers, record.next_track = tween_numbers.numbered(known, matched, record.next_track)
    for k, frame in enumerate(found.keys):
        if not np.array_equal(numbers[k], known[k]):
            gp.put(handles[k], gp.TRACK, numbers[k])
    for k, (first, last) in enumerate(zip(found.keys, found.keys[1:])):
        same = all(np.array_equal(numbers[e], known[e]) for e in (k, k + 1))
        if k not in matched and not same:
            renamed = dict(zip(known[k + 1].tolist(), numbers[k + 1].tolist()))
            renamed |= dict(zip(known[k].tolist(), numbers[k].tolist()))
            for frame in (f for f in found.made if first < f < last):
                _rename(drawings[frame][0], renamed)
    return dict(zip(found.keys, numbers))


def _rename(handle, renamed: dict[int, int]) -> None:
    values = gp.value(handle, gp.TRACK, len(gp.offsets(handle)) - 1)
    gp.put(handle, gp.TRACK, np.array([renamed.get(each, each) for each in values.tolist()], np.int32))


def _tracks(block: between.Block, numbers: dict[int, np.ndarray]) -> np.ndarray:
    """The numbers of a block's strokes: those of the earlier key. Pieces have the numbers of the later key."""
    earlier, later = numbers[block.first], numbers[block.last]
    from_later = (block.stands[:, 0] < 0) | (block.parts & (block.stands[:, 1] >= 0))
    stroke = np.where(from_later, block.stands[:, 1], block.stands[:, 0])
    return np.array([(later if own else earlier)[i] for own, i in zip(from_later, stroke)], np.int32)


@dataclass
class Cleared:
    """What `clear` has done."""

    removed: int = 0
    """Number of in-betweens that were removed."""
    kept: set[int] = field(default_factory=set)
    """Frames of in-betweens that the artist had changed: they are keys now."""


def clear(ob, layers: Iterable, around: int | None = None) -> Cleared:
    """Removes in-betweens and their records: all, or those between the two keys around the frame `around`. What the artist changed stays."""
    kept, done = records.read(ob.data), Cleared()
    for layer in layers:
        record = kept.get(layer.name, records.Layer())
        found = ks.frames_of(layer, record)
        span = (-np.inf, np.inf) if around is None else ks.around(found.keys, around)
        if span is None:
            continue
        inside = [number for number in found.made if span[0] <= number <= span[1]]
        edited = [number for number in found.edited if span[0] <= number <= span[1]]
        known = moved_keys.drawn_now(layer, record, found)
        adopt(layer, found, edited)
        gp.remove_frames(layer, inside)
        done.removed += len(inside)
        done.kept |= set(edited)
        if around is None:
            record.spans.clear()
        _forget(record, known if record.spans else [], found.keys, span)
        moved_keys.note(layer, record)
    records.write(ob.data, kept)
    ob.data.update_tag()
    return done


def _forget(record: records.Layer, spans: list[tuple[int, int, records.Span]], keys: list[int], cleared: tuple[float, float]) -> None:
    """Removes the records of in-betweens from one frame to another. `spans` are the recorded ones as they lie now (see `moved_keys.drawn_now`). What is
    left of a span is drawn again at the next update."""
    first, last = cleared
    whole, pieces = {}, {}
    for recorded, start, known in spans:
        left = {frame: total for frame, total in known.sums.items() if not first <= frame <= last}
        apart = not known.sums and (last <= start or known.last <= first)
        if (len(left) == len(known.sums) and left) or apart:
            whole[start] = known
            continue
        del record.spans[recorded]
        for a, b in zip(keys, keys[1:]):
            own = {frame: total for frame, total in left.items() if a < frame < b}
            if own:
                pieces[a] = records.Span(b, "", known.choices.divided(start, known.last, (a, b)), own, known.marked)
    if pieces:
        # Keys have one place, so what was moved is recorded where it lies now, too.
        record.spans = whole | pieces


def nothing_to_draw(result: Plan) -> Problem:
    """The error for a plan without spans."""
    if result.blank:
        frames = sorted(result.blank_frames)
        return Problem(f"The drawing{'' if len(frames) == 1 else 's'} on {listed(frames)} {are(frames)} blank, so there is nothing to draw between")
    if result.stepped:
        first, last, step = max(result.stepped, key=lambda span: (span[1] - span[0], -span[0]))
        return Problem(
            f"Frames Each is {step}, so no drawing lies between the keys on {first} and {last}: choose {last - first - 1} or less"
        )
    return Problem("No frames between two keys here: go between two keys that lie apart, or choose other frames or layers")

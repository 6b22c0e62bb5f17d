"""One run of painting: it reads the layer, paints in a thread, and writes generated strokes.

Fill Drawings and Paint Bucket use it. Nothing in the file changes before `finishing`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from rototoon import Session
from rototoon.fills import Filled

from ..blender import grease_pencil as gp
from ..blender import guard, holds, stroke_rows
from ..blender import strokes as st
from ..blender.errors import Problem
from ..common import jobs, polygons
from ..lines import plan as lines_plan
from . import clicks, doubts, painted, sheets
from . import plan as pl

make: Callable[[dict[str, Any], str], Any] = Session.from_document
"""Makes a session from a document and its folder. Tests replace it."""


@dataclass(frozen=True)
class Options:
    """What the artist chose."""

    sensitivity: float = 1.0
    confidence: float = 0.0
    """Regions whose colour is less sure stay unpainted."""
    threads: int = 0
    leave_out: tuple[tuple[float, ...], ...] = ()
    """Colours of pencils whose lines are left out."""


@dataclass
class Done:
    """What a run has written."""

    regions: int = 0
    frames: set[int] = field(default_factory=set)
    doubtful: dict[int, int] = field(default_factory=dict)
    """The number of regions in doubt by scene frame."""
    missed: set[int] = field(default_factory=set)
    """Scene frames with a shape of the artist that lies on a line."""
    unrelated: set[int] = field(default_factory=set)
    """Scene frames that no painted drawing resembles: they stay unpainted."""
    overruled: set[int] = field(default_factory=set)
    """Scene frames with a shape of the artist whose region a later shape fills."""
    bare: set[int] = field(default_factory=set)
    """Scene frames with hardly any regions: their lines were probably not found."""
    leaking: set[int] = field(default_factory=set)
    """Scene frames with a shape of the artist whose region goes through a gap to the edge of the picture."""


def worker(plan: pl.Plan, options: Options) -> jobs.Worker:
    """The work of a plan, for a thread. Its result is a `Filled`."""

    def run(progress) -> Filled:
        if plan.hold:
            plan.held = lines_plan.held_pictures(plan.document["footage"], plan.first, plan.last, plan.offset)
        session = make(plan.document, plan.folder)
        try:
            chosen = {"confidence": options.confidence, "threads": options.threads, "leave_out": options.leave_out}
            return session.fill(None, options.sensitivity, plan.pictures, progress, **chosen)
        finally:
            session.close()

    return jobs.Worker(run)


def finishing(ob, plan: pl.Plan, found: Filled) -> Iterator[float]:
    """Writes the result of a plan in steps, and yields the finished share. Returns a `Done`.

    Raises a `Problem` if the artist's shapes have changed meanwhile.
    """
    guard.need(ob)
    guard.need_apart(ob, [plan.layer])
    drawn = sheets.read(ob, plan.layer)
    if {frame: sheet.sum() for frame, sheet in drawn.items() if len(sheet.own)} != plan.sums:
        raise Problem("The paint changed while the drawings were filled, so the result was dropped: try again")
    layer = layer_of(ob, plan.layer)
    yield 0.0
    done = _done(plan, found)
    wanted = _by_frame(plan, found, drawn, done)
    _hold(layer, plan, wanted, drawn, repeats(found) if plan.hold else set())
    gp.make_frames(layer, sorted(wanted), gp.GENERATED)
    handles = gp.drawings(layer)
    for count, (frame, regions) in enumerate(sorted(wanted.items()), 1):
        _write(ob, handles[frame][0], plan, frame, regions, drawn.get(frame))
        done.frames.add(frame)
        done.regions += len(regions)
        unsure = sum(doubts.is_doubtful(region.confidence) for region in regions)
        if unsure:
            done.doubtful[frame] = unsure
        yield count / len(wanted)
    gp.set_keyframe_type(layer, {frame: _kind(drawn.get(frame)) for frame in wanted})
    ob.data.update_tag()
    return done


def layer_of(ob, name: str):
    """The layer with paint. A new one is below all others: lines are drawn over paint."""
    return gp.find_layer(ob, name) or st.bottom_layer(ob, name)


def _done(plan: pl.Plan, found: Filled) -> Done:
    vain: dict[int, set[int]] = {}
    for frame, index in [*found.missed, *found.overruled]:
        vain.setdefault(frame + plan.offset, set()).add(index)
    overruled = {(frame + plan.offset, index) for frame, index in found.overruled}
    leaking = {leak.frame + plan.offset for leak in found.leaking if not leak.parted}
    done = Done(leaking=leaking, unrelated={frame + plan.offset for frame in found.unrelated}, bare={frame + plan.offset for frame in found.bare})
    for frame, indices in vain.items():
        # A shape with several clicks counts as soon as one of them paints.
        hit = {click.stroke for k, click in enumerate(plan.clicks[frame]) if k not in indices}
        lost = {k for k in indices if plan.clicks[frame][k].stroke not in hit}
        if any((frame, k) in overruled for k in lost):
            done.overruled.add(frame)
        if any((frame, k) not in overruled for k in lost):
            done.missed.add(frame)
    return done


def regions_on(found: Filled, frame: int) -> list[painted.Region]:
    """The regions of a picture."""
    regions = []
    for each in found.on(frame):
        holes = [np.asarray(hole) for hole in each.holes]
        outline, colour = np.asarray(each.outline), np.array(each.colour)
        regions.append(painted.Region(each.track + 1, outline, holes, colour, each.confidence, each.name))
    return regions


def _by_frame(plan: pl.Plan, found: Filled, drawn, done: Done) -> dict[int, list[painted.Region]]:
    """The regions by scene frame. Empty drawings of the artist stay empty; frames that are not painted get empty ones."""
    blank = {frame for frame, sheet in drawn.items() if sheet.blank}
    wanted: dict[int, list[painted.Region]] = {}
    for number in found.frames.tolist():
        frame = number + plan.offset
        if plan.first <= frame <= plan.last and frame not in blank:
            wanted[frame] = regions_on(found, number)
    for frame in done.unrelated - blank:
        wanted[frame] = []
    return wanted


def repeats(found: Filled) -> set[int]:
    """The pictures that have the regions of the picture before, to the last digit: the library found that they show the same drawing."""

    def regions(number: int) -> list[tuple]:
        return [(each.track, each.colour, each.name, *(loop.tobytes() for loop in (each.outline, *each.holes))) for each in found.on(number)]

    numbers = found.frames.tolist()
    return {now for before, now in zip(numbers, numbers[1:]) if now == before + 1 and regions(before) == regions(now)}


def _hold(layer, plan: pl.Plan, wanted: dict[int, list[painted.Region]], drawn, repeated: set[int]) -> None:
    """Takes frames out that hold the drawing before them, since the picture or the drawing in it is the same."""
    held: set[int] = set()
    if plan.mapper.still:
        held = _held(plan, wanted, drawn, repeated)
    gp.remove_frames(layer, sorted(held & drawn.keys()))
    for frame in held:
        del wanted[frame]
    holds.note(layer.id_data, layer.name, held, wanted)


def _held(plan: pl.Plan, wanted: dict[int, list[painted.Region]], drawn, repeated: set[int]) -> set[int]:
    own = {frame for frame, sheet in drawn.items() if len(sheet.own)}
    held = plan.held | {number + plan.offset for number in repeated}
    return {frame for frame in held & wanted.keys() if frame not in own | plan.edges}


def _kind(sheet: sheets.Sheet | None) -> str:
    """The keyframe type of a drawing that is written. One with shapes of the artist is no generated one."""
    if sheet is None or not len(sheet.own):
        return gp.GENERATED
    return gp.KEYFRAME if sheet.kind == gp.GENERATED else sheet.kind


def _write(ob, handle, plan: pl.Plan, frame: int, regions: list[painted.Region], sheet: sheets.Sheet | None) -> None:
    """Writes the generated strokes of a drawing, below the artist's."""
    mapping = plan.mapper.at(0, frame)
    if sheet is None or not len(sheet.own):
        stroke_rows.replace_made(handle, painted.rows(ob, regions, mapping, plan.palette))
        return
    own = st.chosen(sheet.content, sheet.own)
    shapes_ = sheets.shapes_of(ob, own, mapping, range(len(own.sizes)))
    _mark(own, sheet, regions, plan.clicks.get(frame, []))
    new = [region for region in regions if not region.covered(shapes_)]
    rows = painted.rows(ob, new, mapping, plan.palette, own.strokes("fill_id").tolist())
    st.write(handle, st.joined(st.of_rows(rows), own))


def _mark(own: st.Content, sheet: sheets.Sheet, regions: list[painted.Region], made_of: list[clicks.Click]) -> None:
    """Gives the artist's strokes the numbers of the regions in which they click. They are not generated, and beyond doubt."""
    own.set_strokes(gp.MADE, np.zeros(len(own.sizes), bool))
    if gp.CONFIDENCE in own.point:
        own.point[gp.CONFIDENCE] = np.ones(len(own.point["position"]), np.float32)
    places, numbers = {int(i): k for k, i in enumerate(sheet.own)}, own.strokes(gp.TRACK).copy()
    for click in reversed(made_of):
        place = np.array([click.at])
        for region in regions:
            if polygons.inside(region.loops, place)[0]:
                numbers[places[click.stroke]] = region.number
    own.set_strokes(gp.TRACK, numbers)

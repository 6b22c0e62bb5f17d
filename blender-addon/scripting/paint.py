"""Paint as functions: Paint Bucket and Fill Drawings with their results as data, and the regions of the layer with paint in pixels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import bpy
import numpy as np
from rototoon.types import Progress

from ..blender import colours, fill_materials, guard, materials, preferences
from ..blender import grease_pencil as gp
from ..blender.errors import Problem
from ..common import jobs
from ..common.operators import OnDrawing
from ..lines import plan as lines_plan
from ..lines import properties
from ..lines.doubts import of_strokes
from ..lines.operators.tracing_base import OnFootage
from ..paint import bucket, filling, sheets
from ..paint import recolours as changing
from ..paint import plan as plans
from .refusing import need, told


@dataclass(frozen=True)
class Region:
    """A filled region on one frame."""

    number: int
    """Its number, the same on all frames; 0 for a shape of the artist that Fill Drawings has not seen yet."""
    outline: np.ndarray
    """Footage pixels, float64 (N, 2)."""
    holes: tuple[np.ndarray, ...]
    """The outlines of its holes, in the same form."""
    colour: tuple[float, float, float]
    """sRGB from 0 to 1."""
    generated: bool
    """Whether Fill Drawings painted it, and nobody has changed it since."""
    confidence: float
    """The probability, 0 to 1, that the colour is right. It is 1 for shapes of the artist."""


@dataclass(frozen=True)
class Painted:
    """Result of `fill_drawings`."""

    regions: int
    """Number of regions on all painted frames together."""
    frames: tuple[int, ...]
    """Scene frames that were painted, rising."""
    doubtful: dict[int, int]
    """By scene frame the number of regions whose colour is probably wrong."""
    missed: tuple[int, ...]
    """Scene frames on which a shape of the artist lies on a line, rising."""
    unrelated: tuple[int, ...]
    """Scene frames that no painted drawing resembles, rising. They stay unpainted."""
    overruled: tuple[int, ...] = ()
    """Scene frames with a shape of the artist whose region another shape fills, rising: no line was found between the two."""
    bare: tuple[int, ...] = ()
    """Scene frames with hardly any regions, rising: their lines were probably not found."""


@told
def fill_region(
    ob: bpy.types.Object, frame: int, place: Sequence[float], colour: Sequence[float] | None, *, sensitivity: float | None = None
) -> int:
    """Fills the region of the picture at a place (footage pixels) with a colour (sRGB, 0 to 1), as Paint Bucket. The colour `None` says that
    it stays without paint.

    Returns the scene frame of the drawing that was painted: an earlier one, if the frame holds its picture. `sensitivity` is 0.1 to 10;
    by default it is that of the panel.
    """
    need(ob, OnFootage)
    x, y = place
    if colour is not None and not (len(colour) == 3 and all(0 <= channel <= 1 for channel in colour)):
        raise Problem(f"colour: found {tuple(colour)}, expected three numbers from 0 to 1, or None for no paint")
    jobs.clear_the_way()
    chosen = ob.rototoon.line_sensitivity if sensitivity is None else sensitivity
    paint = None if colour is None else tuple(float(channel) for channel in colour)
    return bucket.paint(ob, frame, (float(x), float(y)), paint, chosen).frame


@told
def fill_drawings(
    ob: bpy.types.Object,
    frames: tuple[int, int] | None = None,
    *,
    sensitivity: float | None = None,
    confidence: float | None = None,
    progress: Progress | None = None,
) -> Painted:
    """Paints the regions of all drawings with the colours of the artist's shapes, as the operator Fill Drawings.

    `frames` are the first and last scene frame; by default all of the footage. `sensitivity` is 0.1 to 10, and regions whose colour has
    less than `confidence` stay unpainted; by default both are those of the panel. `progress(fraction, step)` is called on this thread; it
    returns ``False`` to cancel, which raises `RuntimeError` and changes nothing.
    """
    need(ob, OnFootage)
    settings = ob.rototoon
    jobs.clear_the_way()
    plan = plans.make(ob, plans.layer_name(ob), *(frames or lines_plan.film(ob)))
    options = filling.Options(
        settings.line_sensitivity if sensitivity is None else sensitivity,
        settings.fill_confidence if confidence is None else confidence,
        preferences.threads(),
        properties.left_out(settings),
    )
    worker = filling.worker(plan, options)
    worker.run_here(progress)
    done = jobs.drained(filling.finishing(ob, plan, worker.result))
    named = done.frames, done.missed, done.unrelated, done.overruled, done.bare
    painted, *others = (tuple(sorted(each)) for each in named)
    return Painted(done.regions, painted, dict(sorted(done.doubtful.items())), *others)


@dataclass(frozen=True)
class Recoloured:
    """Result of `recolour`."""

    regions: int
    """Number of painted regions that have the new colour now."""
    frames: tuple[int, ...]
    """Their scene frames, rising."""
    kept: tuple[int, ...]
    """Scene frames on which shapes of the artist keep the old colour, rising."""
    waiting: tuple[int, ...]
    """Scene frames on which a drawing of the artist is held: `fill_drawings` changes the colour there."""


@told
def recolour(ob: bpy.types.Object, old: str, new: str, first: int | None = None, last: int | None = None) -> Recoloured:
    """Makes one material of the paint another one from scene frame `first` to `last`, on all regions that have it, as the operator Recolour.

    Without `first` it holds on all frames up to `last`, and without `last` on all from `first` on. Both are names of materials; `old` is one
    of the object's. The artist's shapes stay as they are, and `fill_drawings` keeps the change.
    """
    need(ob, OnDrawing)
    found = bpy.data.materials.get(new)
    before = next((own for own in materials.of(ob) if own is not None and own.name == old), None)
    if before is None:
        raise Problem(f'"{ob.name}" has no material "{old}"')
    if found is None:
        raise Problem(f'There is no material "{new}"')
    jobs.clear_the_way()
    entry = changing.Entry(before, found, first, last)
    done = changing.add(ob, entry)
    kept = changing.unchanged([entry], changing.names_of_own(ob))
    frames, own, waiting = (tuple(sorted(each)) for each in (done.frames, kept, done.waiting))
    return Recoloured(done.regions, frames, own, waiting)


@told
def recolours(ob: bpy.types.Object) -> list[tuple[str, str, int | None, int | None]]:
    """The materials that become others, in their order: the names of the old and the new one, and the first and the last scene frame.
    Changes nothing."""
    need(ob, OnDrawing, guard.NOTHING)
    return [(own.old.name, own.new.name, own.first, own.last) for own in changing.entries(ob).values()]


@told
def remove_recolour(ob: bpy.types.Object, place: int) -> None:
    """Removes the entry at a place of `recolours`. `fill_drawings` paints the old colour again."""
    need(ob, OnDrawing, guard.SETTINGS)
    places = list(changing.entries(ob))
    if not 0 <= place < len(places):
        raise Problem(f"place: found {place}, expected one of the {len(places)} entries")
    jobs.clear_the_way()
    changing.remove(ob, places[place])


@told
def regions(ob: bpy.types.Object) -> dict[int, list[Region]]:
    """The filled regions of the layer with paint by scene frame, from back to front. Changes nothing."""
    need(ob, OnDrawing, guard.NOTHING)
    name = ob.rototoon.fills_layer
    if gp.find_layer(ob, name) is None:
        raise Problem(f'"{ob.name}" has no layer "{name}"')
    drawn = sheets.read(ob, name)
    mapper = plans.mapper_of(ob, name, drawn, drawn)
    return {frame: _regions(ob, drawn[frame], mapper.at(0, frame)) for frame in sorted(drawn)}


def _regions(ob: bpy.types.Object, sheet: sheets.Sheet, mapping) -> list[Region]:
    content, found = sheet.content, []
    numbers, seen = content.strokes(gp.TRACK), colours.of_strokes(ob, content, colours.palette(ob)).clip(0, 1)
    sure = np.where(sheet.made, of_strokes(content.point.get(gp.CONFIDENCE), content.starts), 1.0)
    for shape in sheets.shapes_of(ob, content, mapping, np.flatnonzero(~fill_materials.are_bare(ob, content)).tolist()):
        first = shape.strokes[0]
        outline, *holes = sheets.loops_of(shape)
        colour = tuple(seen[first].tolist())
        found.append(Region(int(numbers[first]), outline, tuple(holes), colour, bool(sheet.made[first]), float(sure[first])))
    return found

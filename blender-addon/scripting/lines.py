"""Lines as functions: Trace Drawing and Carry Strokes with their results as data, and the strokes of a layer in pixels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import bpy
import numpy as np
from rototoon.types import Progress

from ..blender import grease_pencil as gp
from ..blender import guard, placement, stroke_lines
from ..blender import strokes as st
from ..blender.errors import Problem
from ..common import jobs
from ..common.operators import OnDrawing
from ..lines import accepting, choosing, doubts, drawings, run, tracing
from ..lines import plan as plans
from ..lines.operators.tracing_base import OnFootage
from .refusing import need, told


@dataclass(frozen=True)
class Line:
    """A stroke on one frame."""

    number: int
    """Its number on the layer, the same on all frames; 0 for a stroke of the artist that was not followed yet."""
    pixels: np.ndarray
    """Footage pixels, float64 (N, 2)."""
    closed: bool
    traced: bool
    """Whether tracing wrote the drawing, and nobody has changed it since."""
    confidence: float
    """The probability, 0 to 1, that it is the stroke of its number. It is 1 if that is beyond doubt, as on the artist's drawings."""
    fill: bool
    """Whether it is the outline of a solid shape, filled and without a line."""


@dataclass(frozen=True)
class Drawn:
    """Result of `trace_drawing` and `carry_strokes`."""

    strokes: int
    """Number of different strokes that were drawn."""
    frames: tuple[int, ...]
    """Scene frames that were drawn, rising."""
    kept: int
    """Number of traced drawings that the artist had changed; they are keys now."""
    breaks: tuple[int, ...]
    """Scene frames on which many strokes end or begin: identity may be lost there."""
    bare: tuple[int, ...] = ()
    """Scene frames on which no line or hardly any was found, rising."""
    off: tuple[int, ...] = ()
    """Scene frames with a drawing of the artist that does not lie on the lines of its picture, rising."""
    warnings: tuple[str, ...] = ()
    """What the operator would report as a warning."""


@told
def trace_drawing(
    ob: bpy.types.Object,
    frames: tuple[int, int] | None = None,
    *,
    style: str = "",
    sensitivity: float | None = None,
    hold: bool = True,
    progress: Progress | None = None,
) -> Drawn:
    """Traces the lines of the footage on the object's layer of lines, as the operator Trace Drawing.

    `frames` are the first and last scene frame; by default all of the footage. `style` is ``auto``, ``clean`` or ``rough``;
    `sensitivity` is 0.1 to 10. By default both are those of the panel. With `hold`, a frame that shows the same drawing as the one before
    holds it. `progress(fraction, step)` is called on this thread; it returns ``False`` to cancel, which raises `RuntimeError` and changes nothing.
    """
    need(ob, OnFootage)
    return _run(ob, choosing.to_trace(ob), frames, _choices(style, sensitivity, hold), progress)


@told
def carry_strokes(
    ob: bpy.types.Object,
    layers: Sequence[str],
    frames: tuple[int, int] | None = None,
    *,
    new_lines: bool = False,
    style: str = "",
    sensitivity: float | None = None,
    hold: bool = True,
    progress: Progress | None = None,
) -> Drawn:
    """Carries the artist's strokes on some layers to the other frames, as the operator Carry Strokes.

    With `new_lines`, lines of the footage that no stroke explains become strokes on the last of the layers. If the layer of Trace Drawing is
    among them, they become strokes there, also without it. Layers that are locked or hidden are refused. The other arguments are those of
    `trace_drawing`.
    """
    need(ob, OnFootage)
    return _run(ob, choosing.to_carry_named(ob, layers, new_lines), frames, _choices(style, sensitivity, hold), progress)


def _choices(style: str, sensitivity: float | None, hold: bool) -> run.Choices:
    if sensitivity is not None and not run.LEAST <= sensitivity <= run.MOST:
        raise Problem(f"sensitivity: found {sensitivity}, expected a number from {run.LEAST} to {run.MOST:g}")
    return run.Choices(style, sensitivity or 0.0, hold)


def _run(ob, chosen: choosing.Chosen, frames, choices: run.Choices, progress) -> Drawn:
    jobs.clear_the_way()
    begun = run.begin(ob, chosen, frames or plans.film(ob), choices)
    begun.worker.run_here(progress)
    done = jobs.drained(tracing.finishing(ob, begun.plan, begun.worker.result, begun.home))
    drawn, breaks, bare, off = (tuple(sorted(each)) for each in (done.frames, done.breaks, done.bare, done.off))
    return Drawn(len(done.numbers), drawn, done.kept, breaks, bare, off, tuple(run.warnings(done)))


@told
def lines(ob: bpy.types.Object, layer: str = "") -> dict[int, list[Line]]:
    """The strokes of a layer by scene frame, in drawing order. By default the layer is that of Trace Drawing. Changes nothing."""
    need(ob, OnDrawing, guard.NOTHING)
    name = layer or ob.rototoon.lines_layer
    if gp.find_layer(ob, name) is None:
        raise Problem(f'"{ob.name}" has no layer "{name}"')
    (found,) = drawings.read(ob, [name], None)
    contents = {**found.keys, **found.made}
    mapper = placement.Mapper(ob, contents, {}, [name])
    return {frame: _lines(ob, contents[frame], mapper.at(0, frame), frame in found.made) for frame in sorted(contents)}


@told
def doubtful_lines(ob: bpy.types.Object) -> list[doubts.Doubt]:
    """The traced strokes of all layers that are in doubt on some frame, by layer and number. Changes nothing."""
    need(ob, OnDrawing, guard.NOTHING)
    return doubts.summed(doubts.places(ob))


@told
def accept_lines(ob: bpy.types.Object, frame: int, numbers: Sequence[int] | None = None, *, layer: str = "") -> tuple[int, ...]:
    """Says that strokes in doubt are right on the drawing that a scene frame shows, as Accept Stroke. Returns their numbers, rising.

    By default the layer is that of Trace Drawing, and all strokes that are in doubt on the drawing are accepted. A number that is not in doubt
    there is refused.
    """
    need(ob, OnDrawing)
    name = layer or ob.rototoon.lines_layer
    if gp.find_layer(ob, name) is None:
        raise Problem(f'"{ob.name}" has no layer "{name}"')
    found = [place for place in accepting.shown(ob, frame) if place.layer == name]
    wanted = {place.number for place in found} if numbers is None else set(numbers)
    missing = wanted - {place.number for place in found}
    if missing:
        raise Problem(f'numbers: stroke {min(missing)} is not in doubt on frame {frame} of the layer "{name}"')
    accepting.accept(ob, [place for place in found if place.number in wanted])
    return tuple(sorted(wanted))


def _lines(ob: bpy.types.Object, content: st.Content, mapping, traced: bool) -> list[Line]:
    numbers, closed = content.strokes(gp.TRACK), content.strokes("cyclic")
    fills = st.solid(ob, content)
    sure = doubts.of_strokes(content.point.get(gp.CONFIDENCE) if traced else None, content.starts)
    return [
        Line(int(numbers[i]), mapping.to_pixels(line), bool(closed[i]), traced, float(sure[i]), bool(fills[i]))
        for i, line in enumerate(stroke_lines.lines(content))
        if len(line)
    ]

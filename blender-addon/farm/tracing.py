"""Traced lines in a batch: what is sent of them, and their results.

The artist's drawings are sent as Trace Drawing and Carry Strokes read them. The results are taken as these operators write them, if the drawings are
as they were sent. A change on one drawing may change the numbers on all others, so the lines of a shot are taken as a whole.

A document has one set of drawings. So layers whose drawings are on other frames are sent as a shot of their own. New strokes are drawn in one of them.

Limits: a new stroke on a line that a stroke of another of these shots follows is left out only if that shot has a result, too.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import numpy as np
from rototoon import RototoonError, Session
from rototoon.lines import Traced

from ..blender import grease_pencil as gp
from ..blender import footage, guard
from ..blender.errors import Problem
from ..common.wording import counted
from ..lines import choosing, properties, tracing
from ..lines import drawings as dr
from ..lines import plan as lines_plan
from ..lines.run import plan_of
from . import collecting

SAME = 0.01
"""Pixels between points that are the same, and the largest difference of equal colours."""


@dataclass(frozen=True)
class Wanted:
    """Which lines are sent."""

    which: str = "DRAWN"
    """``DRAWN``, ``TRACE``, ``CARRY`` or ``NONE``: see the operator Send to Farm."""
    new: bool = False
    """With ``CARRY``: whether ink that no stroke explains makes new strokes."""
    hold: bool = True
    """Whether a frame with the same picture as the one before holds its drawing."""


def sent(ob, wanted: Wanted) -> tuple[list[dict[str, Any]], str]:
    """What is sent of an object's lines, for each shot, and which layers are left out. Raises a `Problem` if the lines cannot be traced. Changes
    nothing.

    A shot has `document`, the artist's drawings alone, `trace`, the options of the step `trace`, and `lines`, which the results need: `layers`,
    `home`, `new` and `hold`.
    """
    chosen = _chosen(ob, wanted)
    if chosen is None:
        return [], ""
    # Lines that cannot be taken in are of no use.
    guard.need(ob)
    _need_lines(ob, chosen.layers)
    plan = plan_of(ob, chosen.layers, *lines_plan.film(ob), chosen.home if chosen.new else "")
    settings = ob.rototoon
    step = {"style": settings.line_style.lower(), "sensitivity": settings.line_sensitivity, **properties.left_out_step(properties.left_out_of_lines(settings))}
    shots = []
    for group in plan.groups:
        own = [layer.name for layer in group.layers]
        home = chosen.home if chosen.home in own else own[-1]
        lines = {"layers": own, "home": home, "new": group.new, "hold": wanted.hold}
        shots.append({"document": group.document, "trace": {**step, "keep_first": True} if group.keep_first else step, "lines": lines})
    return shots, chosen.left


def _chosen(ob, wanted: Wanted) -> choosing.Chosen | None:
    """The layers that are sent; `None` if there is nothing to trace."""
    if wanted.which == "TRACE" or (wanted.which == "DRAWN" and _drawn(ob, [ob.rototoon.lines_layer])):
        return choosing.to_trace(ob)
    if wanted.which == "CARRY" and _drawn(ob, [layer.name for layer in dr.layers(ob)]):
        return choosing.to_carry(ob, False, wanted.new)
    return None


def _drawn(ob, names: list[str]) -> bool:
    """Whether the artist has drawn strokes on any of the layers."""
    return any(layer.keys for layer in dr.read(ob, names))


def _need_lines(ob, names: list[str]) -> None:
    """Raises a `Problem` if a layer is there, and for something else."""
    for name in names:
        layer = gp.find_layer(ob, name)
        if layer is not None and len(layer.frames) and name not in {each.name for each in dr.layers(ob)}:
            raise Problem(f'The layer "{name}" has contours, snapped lines or paint: give lines a layer of their own, in the panel Lines')


def find_held(results: Sequence[collecting.Result], patterns: Mapping[str, str], progress: Callable[[float, str], bool]) -> None:
    """Finds the pictures of results that are the same file as the one before. `patterns` are those of the objects' footage. Uses no Blender."""
    for k, result in enumerate(results):
        if not progress(k / len(results), result.object):
            return
        if result.lines and result.lines["hold"] and result.document is not None and result.object in patterns:
            shown = result.document["footage"]
            result.held = lines_plan.held_pictures({**shown, "pattern": patterns[result.object]}, shown["first"], shown["last"], 0)


def taking(ob, result: collecting.Result, results: Sequence[collecting.Result]) -> Iterator[float]:
    """Takes the traced strokes of a result into an object, in steps. Returns a `tracing.Done`. Raises a `Problem` if the artist's drawings are
    others than those that were sent. `results` are those of all shots."""
    guard.need(ob)
    plan, traced = _sent_plan(ob, result), _traced(result)
    beside = []
    for other in results if plan.groups[0].new else ():
        if other is not result and other.object == result.object and other.lines and other.document is not None:
            with suppress(Problem):
                beside.append((_sent_plan(ob, other).groups[0], _traced(other)))
    return (yield from tracing.finishing(ob, plan, [traced], result.lines["home"], beside))


def _sent_plan(ob, result: collecting.Result) -> lines_plan.Plan:
    """The plan that a result was made from. Raises a `Problem` if it is another one now."""
    lines, document = result.lines, result.document
    if not document.get("traced"):
        raise Problem("its lines have no result yet: start the batch again")
    collecting.need_same_footage(ob, footage.fields(ob, ""), document["footage"], ("width", "height", "first", "last"))
    _need_lines(ob, lines["layers"])
    # A layer from which the artist has deleted all drawings differs from what was sent. Without new strokes it would be refused as empty.
    plan = plan_of(ob, lines["layers"], *lines_plan.film(ob), lines["home"])
    now, before = [group.document["drawings"] for group in plan.groups], document.get("drawings", [])
    if len(now) != 1 or not _same(now[0], before):
        button = "Trace Drawing" if ob.rototoon.lines_layer in lines["layers"] else "Carry Strokes"
        raise Problem(f"its drawings on {_named(lines['layers'])} were changed since they were sent, so its lines stay as they are; press {button}")
    plan.hold = bool(lines["hold"])
    plan.groups[0].new = bool(lines["new"])
    plan.held = {picture + plan.offset for picture in result.held}
    return plan


def _named(layers: Sequence[str]) -> str:
    names = [f'"{name}"' for name in layers]
    return f"the layer {names[0]}" if len(names) == 1 else f"the layers {', '.join(names[:-1])} and {names[-1]}"


def _traced(result: collecting.Result) -> Traced:
    """The traced strokes of a result. Raises a `Problem` if they are damaged."""
    own = {name: result.document[name] for name in ("rototoon", "footage", "traced")}
    try:
        # The pictures are not read, and only these fields are looked at.
        with Session.from_document({**own, "parts": []}, ".") as session:
            traced = session.traced()
    except RototoonError as error:
        raise Problem(f"{result.path}: {error}") from error
    counts = dict(zip(traced.frames.tolist(), np.diff(traced.stroke_offsets).tolist()))
    for drawing in result.document.get("drawings", []):
        frame, expected = drawing["frame"], len(drawing["strokes"])
        if counts.get(frame) != expected:
            found = counted(counts[frame], "stroke") if frame in counts else "no drawing"
            wanted = f"expected the {counted(expected, 'stroke')} of the drawing that was sent: start the batch again"
            raise Problem(f"{result.path}: traced: found {found} on picture {frame}, {wanted}")
    return traced


def _same(now: Sequence[Mapping[str, Any]], before: Sequence[Mapping[str, Any]]) -> bool:
    """Whether two fields `drawings` have the same strokes."""
    if [(each["frame"], len(each["strokes"])) for each in now] != [(each["frame"], len(each["strokes"])) for each in before]:
        return False
    pairs = zip(now, before)
    return all(_alike(*strokes) for one, other in pairs for strokes in zip(one["strokes"], other["strokes"]))


def _alike(one: Mapping[str, Any], other: Mapping[str, Any]) -> bool:
    if (one["closed"], one.get("fill", False)) != (other["closed"], other.get("fill", False)):
        return False
    rows = [[np.asarray(stroke[name], np.float64) for name in ("points", "colour")] for stroke in (one, other)]
    return all(a.shape == b.shape and bool((np.abs(a - b) <= SAME).all()) for a, b in zip(*rows))

"""Paint in a batch: what is sent of it, and its results.

The artist's shapes are sent as clicks, as Fill Drawings reads them. The results are taken as Fill Drawings writes them, if the shapes are as they
were sent.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from rototoon import RototoonError, Session
from rototoon.fills import Filled

from ..blender import footage, guard
from ..blender.errors import Problem
from ..lines import plan as lines_plan
from ..lines import properties
from ..paint import filling, sheets
from ..paint import plan as pl
from . import collecting

SAME = 0.01
"""Pixels between places of clicks that are the same, and the largest difference of equal colours."""


def sent(ob) -> tuple[dict[str, Any], dict[str, Any]] | None:
    """The document of an object's paint, with the clicks alone, and the options of the step `fill`. `None` if the artist has painted
    nothing. Raises a `Problem` if the paint can't be carried. Changes nothing."""
    name = ob.rototoon.fills_layer
    if name in pl.taken_names(ob) or not any(len(sheet.own) for sheet in sheets.read(ob, name).values()):
        return None
    plan = pl.make(ob, name, *lines_plan.film(ob))
    settings = ob.rototoon
    step = {"sensitivity": round(settings.line_sensitivity, 4), "confidence": round(settings.fill_confidence, 4)}
    return plan.document, {**step, **properties.left_out_step(properties.left_out(settings))}


def taking(ob, result: Mapping[str, Any]) -> Iterator[float]:
    """Takes the painted regions of a document into an object, in steps. Returns a `filling.Done`. Raises a `Problem` if the artist's shapes are
    others than those that were sent."""
    guard.need(ob)
    collecting.need_same_footage(ob, footage.fields(ob, ""), result["footage"])
    plan = pl.make(ob, pl.layer_name(ob), *lines_plan.film(ob))
    if not _same(plan.document["fills"], result.get("fills", ())):
        raise Problem("its shapes were changed since they were sent, so its paint stays as it is; press Fill Drawings")
    if plan.document.get("recolours", []) != result.get("recolours", []):
        raise Problem("its recolours were changed since they were sent, so its paint stays as it is; press Fill Drawings")
    found = _filled(result)
    numbers = found.frames.tolist()
    missing = set(range(plan.pictures[0], plan.pictures[1] + 1)).difference(numbers)
    return (yield from filling.finishing(ob, plan, replace(found, unrelated=sorted(missing))))


def _filled(result: Mapping[str, Any]) -> Filled:
    own = {name: result[name] for name in ("rototoon", "footage", "palette", "fills", "filled") if name in result}
    try:
        # The pictures are not read, and only these fields are looked at.
        with Session.from_document({**own, "parts": []}, ".") as session:
            return session.filled()
    except RototoonError as error:
        raise Problem(str(error)) from error


def _same(now: Sequence[Mapping[str, Any]], before: Sequence[Mapping[str, Any]]) -> bool:
    """Whether two fields `fills` have the same clicks."""
    if [each["frame"] for each in now] != [each["frame"] for each in before]:
        return False
    return all(_alike(one["regions"], other["regions"]) for one, other in zip(now, before))


def _alike(one: Sequence[Mapping[str, Any]], other: Sequence[Mapping[str, Any]]) -> bool:
    def row(click: Mapping[str, Any]) -> list[float]:
        # No paint is no colour.
        return [*click["at"], *(click["colour"] or [-1.0] * 3)]

    if [click.get("name") for click in one] != [click.get("name") for click in other]:
        return False
    rows = [np.array([row(click) for click in clicks], np.float64) for clicks in (one, other)]
    return rows[0].shape == rows[1].shape and bool((np.abs(rows[0] - rows[1]) <= SAME).all())

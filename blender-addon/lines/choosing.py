"""The layers of a run of tracing, and the layer on which new strokes are drawn. Changes nothing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ..blender import grease_pencil as gp
from ..blender import guard
from ..blender.errors import Problem
from . import aside
from . import drawings as dr


@dataclass(frozen=True)
class Chosen:
    """What a run takes."""

    layers: list[str]
    """Their names. One that does not exist is made."""
    home: str
    """The layer of new strokes. It is one of `layers`."""
    new: bool
    """Whether ink that no stroke explains makes new strokes."""
    left: str = ""
    """The layers that are left out, and why; empty if there are none."""


def to_trace(ob) -> Chosen:
    """What Trace Drawing takes."""
    name = ob.rototoon.lines_layer
    return Chosen([name], name, True)


def to_carry(ob, active: bool, new: bool) -> Chosen:
    """What Carry Strokes takes: the active layer, or all. On the layer of Trace Drawing new strokes are always drawn. Raises a `Problem` if
    there is no layer, or all of them are closed."""
    # Hidden lines of another layer are carried with it.
    wanted = [layer for layer in dr.layers(ob, active) if not aside.is_aside(ob, layer)]
    if not wanted:
        what = "The active layer has contours, snapped or hidden lines, or paint: make" if active else "There are no drawings to carry: draw on"
        raise Problem(f"{what} another layer active" if active else f"{what} a layer of your own")
    guard.need_some(wanted)
    names = [layer.name for layer in guard.open_layers(wanted)]
    home = gp.active_layer(ob)
    return _carried(ob, names, "" if home is None else home.name, new, guard.left_out(wanted))


def to_carry_named(ob, names: Sequence[str], new: bool) -> Chosen:
    """The same for layers by name; new strokes are drawn on the last one. Raises a `Problem` if one of them cannot be carried, or is closed."""
    if not names:
        raise Problem("layers: found none, expected the names of layers")
    names = list(dict.fromkeys(names))
    for name in names:
        layer = gp.find_layer(ob, name)
        if layer is None:
            raise Problem(f'"{ob.name}" has no layer "{name}"')
        if guard.as_contours(ob, name):
            raise Problem(f'The layer "{name}" has contours: track them')
        if not dr.may_have_lines(ob, layer) or aside.is_aside(ob, layer):
            raise Problem(f'The layer "{name}" has snapped or hidden lines, or paint: carry another one')
    guard.need_open(gp.find_layer(ob, name) for name in names)
    return _carried(ob, names, names[-1], new)


def _carried(ob, names: list[str], home: str, new: bool, left: str = "") -> Chosen:
    traced = ob.rototoon.lines_layer
    if traced in names:
        return Chosen(names, traced, True, left)
    return Chosen(names, home if home in names else names[-1], new, left)

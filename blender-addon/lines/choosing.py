"""The layers of a run of tracing, and the layer on which new strokes are drawn. Changes nothing."""

from __future__ import annotations

from dataclasses import dataclass

from ..blender import grease_pencil as gp
from ..blender import guard
from ..blender.errors import Problem
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
    wanted = dr.layers(ob, active)
    if not wanted:
        what = "The active layer has contours, snapped lines or paint: make" if active else "There are no drawings to carry: draw on"
        raise Problem(f"{what} another layer active" if active else f"{what} a layer of your own")
    guard.need_some(wanted)
    names = [layer.name for layer in guard.open_layers(wanted)]
    home = gp.active_layer(ob)
    home = home.name if home is not None and home.name in names else names[-1]
    traced = ob.rototoon.lines_layer in names
    return Chosen(names, ob.rototoon.lines_layer if traced else home, new or traced, guard.left_out(wanted))

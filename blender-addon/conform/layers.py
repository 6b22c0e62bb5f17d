"""Which layers of an object have something of Rototoon, and the layers for what is left over."""

from __future__ import annotations

from ..blender import grease_pencil as gp
from ..lines import records as line_records
from ..style import limbs
from ..tween import records as tween_records

LEFT_OVER = "Left over: "
"""How the names of layers begin that keep drawings whose picture is gone. Behind it is the name of their layer."""


def ours(ob) -> list:
    """The layers that go along with the footage, lowest first: those of contours, snapped lines, traced lines, paint and limbs, and all on which Rototoon has
    noted anything. No array is read."""
    settings = ob.rototoon
    named = {settings.lines_layer, settings.fills_layer, limbs.LAYER}
    for prefix in (settings.contours_layer, settings.snapped_layer):
        named |= {layer.name for layer in gp.layers(ob, prefix)}
    named |= tween_records.read(ob.data).keys() | line_records.read(ob.data).keys()
    return [layer for layer in gp.every_layer(ob) if layer.name in named or _is_noted(layer)]


def others(ob) -> list:
    """The other layers with strokes."""
    own = {layer.name for layer in ours(ob)}
    return [layer for layer in gp.every_layer(ob) if layer.name not in own and gp.has_strokes(layer)]


def left_over(name: str) -> str:
    """The name of the layer that keeps what is left over of a layer."""
    return name if is_left_over(name) else LEFT_OVER + name


def is_left_over(name: str) -> bool:
    """Whether a layer keeps what is left over of another one."""
    return name.startswith(LEFT_OVER)


def _is_noted(layer) -> bool:
    return any(name.startswith("rototoon_") for handle in gp.handles(layer) for name in gp.names(handle))

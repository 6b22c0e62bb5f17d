"""Weights of vertex groups on drawings whose points become others.

Blender lets scripts set the weights of Grease Pencil points, but not read them, and keeps them with the indices of the points. So points that are
new have the weights of unrelated ones or none. Nobody can tell whether a drawing has weights; that its object has vertex groups is a hint.
"""

from __future__ import annotations

import bpy

from ..common.wording import counted

LOST = "Blender does not let them follow: points get other weights or none, and only undo brings them back"


def groups(ob) -> int:
    """The number of vertex groups of an object, or of another one with its data."""
    return max(len(other.vertex_groups) for other in (ob, *bpy.data.objects) if other.data == ob.data)


def warning(ob) -> str:
    """What happens to weights when strokes get other points; empty without vertex groups."""
    count = groups(ob)
    return f'"{ob.name}" has {counted(count, "vertex group")}, and weights do not follow strokes that get other points: look at them, or undo this' if count else ""

"""Where objects are in the world, also those that Blender does not evaluate.

Blender computes `matrix_world` only for what the view layer evaluates. It is not saved in files. For an object that is disabled in viewports, in an excluded
collection or in another scene, it is the identity after a file is opened, and otherwise that of an older frame.
"""

from __future__ import annotations

import bpy
from mathutils import Matrix

from .errors import Problem

_CARRIED_AS_A_WHOLE = {"OBJECT", "ARMATURE", "LATTICE"}
"""Kinds of parents that carry an object with their own matrix alone."""


def matrix_of(ob: bpy.types.Object) -> Matrix:
    """The matrix of an object in the world on the current frame. Raises a `Problem` if only Blender could compute it, and does not."""
    if is_evaluated(ob):
        return ob.matrix_world
    parent = ob.parent
    if has_own_motion(ob) or has_animation(ob.data) or (parent is not None and not _is_carried_as_a_whole(ob)):
        raise Problem(
            f'"{ob.name}" moves, and Blender does not show where: it is disabled in viewports or excluded from the view layer. Show it in the Outliner'
        )
    return ob.matrix_basis if parent is None else matrix_of(parent) @ ob.matrix_parent_inverse @ ob.matrix_basis


def has_own_motion(ob: bpy.types.Object) -> bool:
    """Whether an object can move by itself: it is animated, or it has constraints."""
    owners = [ob] + ([ob.data] if ob.type in {"CAMERA", "EMPTY"} and ob.data is not None else [])
    return any(has_animation(owner) for owner in owners) or len(ob.constraints) > 0


def has_animation(owner) -> bool:
    """Whether a data-block has an action, drivers or strips."""
    data = getattr(owner, "animation_data", None)
    return data is not None and (data.action is not None or len(data.drivers) > 0 or len(data.nla_tracks) > 0)


def _is_carried_as_a_whole(ob) -> bool:
    along = ob.parent.type == "CURVE" and ob.parent.data.use_path
    return ob.parent_type in _CARRIED_AS_A_WHOLE and not along


def is_evaluated(ob: bpy.types.Object) -> bool:
    """Whether Blender computes where an object and its bones are."""
    if ob.visible_get():
        return True
    # Blender evaluates some of what is hidden: what the eye hides, parents, the scene's camera. Its own `is_evaluated` does not tell.
    return any(each.original == ob for each in bpy.context.evaluated_depsgraph_get().ids)

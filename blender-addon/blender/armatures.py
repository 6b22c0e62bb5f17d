"""Armatures: their bones at rest, the view from which they are seen, and the frames of their motion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from . import camera as cameras
from . import world
from .errors import Problem

SCALE = 100.0
"""Pixels per unit where no camera shows the armature."""
VIEWS = (
    ("CAMERA", "Camera", "As the scene's camera sees it. Without a camera, from the front"),
    ("FRONT", "Front", "Along Y"),
    ("RIGHT", "Right", "Along -X"),
)
_AXES = {
    "FRONT": ((1, 0, 0), (0, 0, 1), (0, -1, 0)),
    "RIGHT": ((0, 1, 0), (0, 0, 1), (1, 0, 0)),
}


@dataclass(frozen=True)
class Bone:
    """A bone at rest."""

    parent: str
    head: np.ndarray
    tail: np.ndarray


def view_of(scene, which: str) -> cameras.View:
    """The view from a side, or the view of the scene's camera on the current frame."""
    if which == "CAMERA" and scene.camera is not None:
        render = scene.render
        return cameras.camera_view(scene, scene.camera, render.resolution_x, render.resolution_y, cameras.RENDERED)
    to_view = np.eye(4)
    to_view[:3, :3] = _AXES["FRONT" if which == "CAMERA" else which]
    return cameras.View(to_view, False, np.array([[SCALE, 0, 0], [0, -SCALE, 0]]))


def bones_of(ob) -> dict[str, Bone]:
    """The bones at rest, in armature space, parents first."""
    return {
        bone.name: Bone(
            bone.parent.name if bone.parent else "", np.array(bone.head_local), np.array(bone.tail_local)
        )
        for bone in ob.data.bones
    }


def need_posed(ob) -> None:
    """Raises a `Problem` if Blender does not move the bones of an armature: it would be the same on all frames."""
    if not world.is_evaluated(ob):
        raise Problem(
            f'"{ob.name}" is disabled in viewports or excluded from the view layer, so Blender does not move its bones: show it in the Outliner'
        )


def range_of(ob, scene) -> range:
    """The frames of an armature's motion: those of its action if it has one, otherwise those of the scene."""
    data = ob.animation_data
    if data is not None and data.action is not None:
        first, last = (int(round(frame)) for frame in data.action.frame_range)
        if last > first:
            return range(first, last + 1)
    return range(scene.frame_start, scene.frame_end + 1)

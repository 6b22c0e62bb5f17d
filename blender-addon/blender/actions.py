"""Animation curves in new actions. Blender 4.5 and later keep them in layers and slots."""

from __future__ import annotations

from collections.abc import Mapping

import bpy
import numpy as np

LINEAR = 1
"""The value of linear interpolation in arrays of key points."""


def give(owner, kind: str, name: str, frames: np.ndarray, curves: Mapping[tuple[str, int], np.ndarray]) -> str:
    """Puts curves (by data path and index) into a new action and assigns it to `owner`, a data-block of type `kind`.

    `kind` is "OBJECT" or "KEY". Returns the name of the action that the data-block had before, or "". That action stays in the file.
    """
    action = bpy.data.actions.new(name)
    slot = action.slots.new(id_type=kind, name=owner.name)
    strip = action.layers.new("Layer").strips.new(type="KEYFRAME")
    bag = strip.channelbag(slot, ensure=True)
    for (path, index), values in curves.items():
        curve = bag.fcurves.new(path, index=index)
        curve.keyframe_points.add(len(frames))
        curve.keyframe_points.foreach_set("co", np.stack([frames, values], 1).astype(np.float32).ravel())
        curve.keyframe_points.foreach_set("interpolation", np.full(len(frames), LINEAR, np.int32))
        curve.update()
    data = owner.animation_data or owner.animation_data_create()
    before = data.action
    if before is not None:
        # Without a user the action would not be saved.
        before.use_fake_user = True
    data.action = action
    data.action_slot = slot
    return before.name if before is not None else ""

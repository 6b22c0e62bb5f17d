"""Clear In-betweens."""

import bpy

from ...blender import grease_pencil as gp
from ...blender import guard, memo
from ...blender import strokes as st
from ...common.operators import Guarded, OnDrawing
from ...common.wording import counted, joined, stayed
from .. import tweening
from .tweening_base import LAYERS


class ROTOTOON_OT_clear_in_betweens(Guarded, OnDrawing, bpy.types.Operator):
    bl_idname = "rototoon.clear_in_betweens"
    bl_label = "Clear In-betweens"
    bl_description = "Remove the in-betweens. Your own drawings stay, and so do in-betweens that you have changed: they become keys"
    bl_options = {"REGISTER", "UNDO"}

    frames: bpy.props.EnumProperty(
        name="Frames",
        description="Where",
        items=(
            ("ALL", "All", "All frames"),
            ("CURRENT", "Around the Playhead", "In-betweens between the two keys around the current frame"),
        ),
    )
    layers: bpy.props.EnumProperty(name="Layers", description="On which layers", items=LAYERS, default="ALL")

    @classmethod
    def lacking(cls, ob, changes: str) -> str:
        """As `OnDrawing.lacking`."""
        why = super().lacking(ob, changes)
        return why or ("" if memo.kept(ob, any_in_between) else "There are no in-betweens")

    def run(self, context) -> str:
        ob, active = context.object, self.layers == "ACTIVE"
        around = context.scene.frame_current if self.frames == "CURRENT" else None
        done = tweening.clear(ob, st.editable_layers(ob, active), around)
        self.warn(guard.left_out(st.drawn_layers(ob, active)))
        said = f"{counted(done.removed, 'in-between')} removed" if done.removed or done.kept else "There are no in-betweens"
        return joined(said, stayed("in-between", done.kept))


def any_in_between(ob) -> bool:
    """Whether a layer has in-betweens, also changed ones. Reads no array."""
    layers = gp.every_layer(ob)
    return any(gp.has(handle, gp.TWEENED) for kind in (gp.GENERATED, "") for layer in layers for handle in gp.handles(layer, kind))


CLASSES = (ROTOTOON_OT_clear_in_betweens,)

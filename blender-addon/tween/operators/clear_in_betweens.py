"""Clear In-betweens."""

import bpy

from ...blender import grease_pencil as gp
from ...blender import guard
from ...blender import strokes as st
from ...common.operators import Guarded, OnDrawing
from ...common.wording import counted
from .. import keys as ks
from .. import tweening
from .tweening_base import LAYERS


class ROTOTOON_OT_clear_in_betweens(Guarded, OnDrawing, bpy.types.Operator):
    bl_idname = "rototoon.clear_in_betweens"
    bl_label = "Clear In-betweens"
    bl_description = "Remove the in-betweens. Your own drawings stay"
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
        """As `OnDrawing.lacking`. No array is read."""
        why = super().lacking(ob, changes)
        handles = (handle for layer in gp.every_layer(ob) for handle, _ in gp.drawings(layer).values()) if not why else ()
        return why or ("" if any(gp.has(handle, gp.TWEENED) for handle in handles) else "There are no in-betweens")

    def run(self, context) -> str:
        ob = context.object
        removed = 0
        for layer in st.editable_layers(ob, self.layers == "ACTIVE"):
            span = (None, None)
            if self.frames == "CURRENT":
                keys = [n for n, found in gp.drawings(layer).items() if not ks.is_tweened(*found)]
                span = ks.around(keys, context.scene.frame_current)
                if span is None:
                    continue
            removed += tweening.clear(ob, [layer], *span)
        self.warn(guard.left_out(st.drawn_layers(ob, self.layers == "ACTIVE")))
        return f"{counted(removed, 'in-between')} removed" if removed else "There are no in-betweens"


CLASSES = (ROTOTOON_OT_clear_in_betweens,)

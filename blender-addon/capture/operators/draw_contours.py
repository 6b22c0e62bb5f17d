"""Draw Contours: to the footage, to Draw Mode, to the layer and the brush for contours."""

import bpy

from ...blender import grease_pencil as gp
from ...blender import guard, view
from ...blender.errors import Problem
from ...common.operators import Guarded, OnDrawing
from .setup import look_at_footage, make_frame


class ROTOTOON_OT_draw_contours(Guarded, OnDrawing, bpy.types.Operator):
    bl_idname = "rototoon.draw_contours"
    bl_label = "Draw Contours"
    bl_description = (
        "Look at the footage and go to Draw Mode, on the layer of the contours, with a brush that draws lines of one width. "
        "Draw one closed line around each part; ends that nearly meet are joined. A frame without contours becomes an empty key"
    )
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def lacking(cls, ob, changes):
        why = super().lacking(ob, changes)
        return why or ("" if ob.rototoon.pattern else "Choose the footage first, with Set Up Footage or in the panel Footage")

    def run(self, context) -> str:
        ob = context.object
        if ob.hide_get():
            raise Problem(f'"{ob.name}" is hidden: show it in the Outliner first')
        layers = gp.layers(ob, ob.rototoon.contours_layer)
        free = [layer for layer in layers if not guard.closed(layer)]
        if layers and not free:
            guard.need_some(layers)
        active = gp.active_layer(ob)
        if active is None or active.name not in {layer.name for layer in free}:
            gp.activate(ob, free[-1] if free else gp.layer(ob, ob.rototoon.contours_layer))
        frame = context.scene.frame_current
        made = make_frame(gp.active_layer(ob), frame)
        look_at_footage(context, ob)
        view.begin_to_draw(context)
        return (f"Frame {frame} is a new, empty key. " if made else "") + "Draw one closed line around each part"


CLASSES = (ROTOTOON_OT_draw_contours,)

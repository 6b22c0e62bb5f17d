"""Contours to Mask: makes an animated mask of the contours."""

import bpy

from ...blender import guard, masks
from ...blender.errors import Problem
from ...capture import document, snapping
from ...common.operators import Guarded, OnContours
from ...common.wording import counted
from .. import outlines


class ROTOTOON_OT_contours_to_mask(Guarded, OnContours, bpy.types.Operator):
    bl_idname = "rototoon.contours_to_mask"
    bl_label = "Contours to Mask"
    bl_description = "Make a mask of the contours, with a layer for each part and a shape key for every frame"
    bl_options = {"REGISTER", "UNDO"}
    changes = guard.NOTHING

    name: bpy.props.StringProperty(
        name="Mask",
        description="Name of the mask. If empty, the object's name. A mask of this name is replaced if it was made here",
        options={"SKIP_SAVE"},
    )
    use_snapped: bpy.props.BoolProperty(
        name="Snapped Lines",
        description="Follow the snapped lines where there are any, otherwise the control points",
        default=True,
    )

    def run(self, context) -> str:
        ob = context.object
        settings = ob.rototoon
        name = self.name or ob.name
        known = bpy.data.masks.get(name)
        if known is not None:
            guard.need_own(known)
            masks.need_made(name)
        reading = document.read(ob, results=True, gaps=True)
        parts = outlines.outlines(reading.document, settings.frame_offset, self.use_snapped)
        if not parts:
            raise Problem("No part has a key yet: press Track, or New Key Here, first")
        older = snapping.older(ob, reading.document) if self.use_snapped else ""
        if older:
            self.warn(older)
        mask = masks.write(context, name, parts, settings.width, settings.height)
        return f'{counted(len(parts), "part")} in the mask "{mask.name}"'


CLASSES = (ROTOTOON_OT_contours_to_mask,)

"""Release Pins: removes corrections."""

import bpy

from ...blender import grease_pencil as gp
from ...blender import guard, selection
from ...common.operators import Guarded
from ...common.wording import counted
from .. import corrections
from ..polls import OnTracked


class ROTOTOON_OT_release_pins(Guarded, OnTracked, bpy.types.Operator):
    bl_idname = "rototoon.release_pins"
    bl_label = "Release Pins"
    bl_description = (
        "Release points and parts that you fixed on generated frames, so that Track moves them again. "
        "Locked and hidden layers stay as they are"
    )
    bl_options = {"REGISTER", "UNDO"}

    which: bpy.props.EnumProperty(
        name="Which",
        description="What is released",
        items=(
            ("SELECTED", "Selected Points", "The points selected in edit mode on this frame"),
            ("FRAME", "This Frame", "Everything fixed on this frame"),
            ("ALL", "All Frames", "Everything fixed on any frame"),
        ),
        default="FRAME",
    )

    def run(self, context) -> str:
        ob, current = context.object, context.scene.frame_current
        layers, released = gp.layers(ob, ob.rototoon.contours_layer), 0
        guard.need_some(layers)
        for layer in guard.open_layers(layers):
            drawings = gp.drawings(layer)
            frames = list(drawings) if self.which == "ALL" else [f for f in drawings if f == current]
            for frame in frames:
                drawing = drawings[frame][0]
                mask = selection.selected_points(drawing) if self.which == "SELECTED" else None
                released += corrections.release(drawing, mask)
        ob.data.update_tag()
        self.warn(guard.left_out(layers))
        if not released:
            return "There was nothing to release"
        return f"{counted(released, 'pin')} released" + ("" if ob.rototoon.live else ": press Track")


CLASSES = (ROTOTOON_OT_release_pins,)

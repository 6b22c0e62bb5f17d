"""Footage from Reference Image."""

import bpy

from ...blender import footage
from ...blender.errors import Problem
from .footage_base import FootageOfActive


def reference_image(context):
    """The selected empty that shows an image, otherwise the one in the settings."""
    for ob in context.selected_objects:
        if ob.type == "EMPTY" and ob.empty_display_type == "IMAGE":
            return ob
    return context.object.rototoon.reference


class ROTOTOON_OT_footage_from_reference(FootageOfActive, bpy.types.Operator):
    bl_idname = "rototoon.footage_from_reference"
    bl_label = "Footage from Reference Image"
    bl_description = "Use the image of the selected reference image (an empty that shows an image), with its timing"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        if not super().poll(context):
            return False
        if reference_image(context) is None:
            cls.poll_message_set("Select the reference image together with the Grease Pencil object")
            return False
        return True

    def source(self, context) -> footage.Source:
        self._empty = reference_image(context)
        if self._empty is None:
            raise Problem("No reference image is selected")
        return footage.source_of_image(self._empty.data, self._empty.image_user)

    def apply(self, context, shot):
        said, settings = self.assign(shot), self._ob.rototoon
        settings.plane, settings.reference = "REFERENCE", self._empty
        return said


CLASSES = (ROTOTOON_OT_footage_from_reference,)

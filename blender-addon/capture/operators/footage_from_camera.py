"""Footage from Camera."""

import bpy

from ...blender import footage, placement
from ...blender.errors import Problem
from .footage_base import FootageOfActive


class ROTOTOON_OT_footage_from_camera(FootageOfActive, bpy.types.Operator):
    bl_idname = "rototoon.footage_from_camera"
    bl_label = "Footage from Camera"
    bl_description = "Use the image sequence, movie or clip in the camera's background, with its timing"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        if not super().poll(context):
            return False
        camera = placement.camera_of(context.object)
        if camera is None:
            cls.poll_message_set(placement.NO_CAMERA)
            return False
        if not len(camera.data.background_images):
            cls.poll_message_set(f'Camera "{camera.name}" has no background image: add one in its properties, Background Images')
            return False
        return True

    def source(self, context) -> footage.Source:
        camera = placement.camera_of(context.object)
        if camera is None:
            raise Problem(placement.NO_CAMERA)
        return footage.background_source(camera)[0]

    def apply(self, context, shot):
        said = self.assign(shot)
        self._ob.rototoon.plane = "CAMERA"
        return said


CLASSES = (ROTOTOON_OT_footage_from_camera,)

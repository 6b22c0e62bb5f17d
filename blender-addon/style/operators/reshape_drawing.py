"""Reshape Drawing: a drawing follows a clip of the library."""

import bpy

from .. import clip_browser
from ..clip_library import clip_of, folder_of
from ..clip_properties import shared
from .reshaping_base import Reshaping


class ROTOTOON_OT_reshape_drawing(Reshaping, bpy.types.Operator):
    bl_idname = "rototoon.reshape_drawing"
    bl_label = "Reshape Drawing"
    bl_description = (
        "Make the drawing at the playhead follow a clip of the library, on generated frames after the drawing. "
        "On hidden layers too, not on locked ones"
    )
    bl_options = {"REGISTER", "UNDO"}

    character: shared("character", names=lambda _self: clip_browser.characters())
    motion: shared("motion", names=lambda self: clip_browser.motions(self.character))

    def begin(self, context):
        folder = folder_of(context.object, self.folder)
        character, motion = self.character, self.motion
        return self.work(context, lambda _progress, _threads: clip_of(folder, character, motion))


CLASSES = (ROTOTOON_OT_reshape_drawing,)

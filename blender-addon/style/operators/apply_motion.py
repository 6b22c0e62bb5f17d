"""Apply Motion in Style of…: a drawing follows a motion, re-made in another character's style."""

import bpy

from .. import clip_browser
from ..clip_library import folder_of
from ..clip_properties import Manner, shared
from .reshaping_base import Reshaping


class _Content:
    """The clip to re-make. It is a class of its own, so that the dialog lists it before the style."""

    motion: shared("motion", names=lambda _self: clip_browser.motions(human=True))
    content: shared(
        "character",
        name="Content",
        description="The character whose motion it is",
        names=lambda self: clip_browser.characters(self.motion, human=True),
    )


class ROTOTOON_OT_apply_motion(Manner, _Content, Reshaping, bpy.types.Operator):
    bl_idname = "rototoon.apply_motion"
    bl_label = "Apply Motion in Style of…"
    bl_description = (
        "Re-make a motion of the library in another character's style, and make the drawing at the playhead follow it, on "
        "generated frames after the drawing. On hidden layers too, not on locked ones"
    )
    bl_options = {"REGISTER", "UNDO"}

    style: shared("style", description="The character whose style the motion gets")

    def draw(self, _context) -> None:
        """Called by Blender for the dialog and the redo panel: what is asked for first comes first."""
        layout = self.layout
        layout.use_property_split = True
        for name in ("content", "motion", "style", "preset", "strength", "sub_keys", "chains", "mirror"):
            layout.prop(self, name)

    def begin(self, context):
        remake = self.remake(folder_of(context.object, self.folder), self.motion, self.content)
        return self.work(context, remake, before=0.5)


CLASSES = (ROTOTOON_OT_apply_motion,)

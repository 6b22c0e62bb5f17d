"""The panel of armatures: key points, saving clips, driving bones."""

import bpy

from ..style import bodies, clip_browser
from .clips import draw_browser
from .panel import Panel


class ROTOTOON_PT_bones(Panel, bpy.types.Panel):
    bl_idname = "ROTOTOON_PT_bones"
    bl_label = "Bones"
    page = "artist/bones.html"

    @classmethod
    def poll(cls, context):
        return context.object is not None and context.object.type == "ARMATURE"

    def draw(self, context):
        layout, settings = self.layout, context.object.rototoon
        layout.use_property_decorate = False
        layout.prop(settings, "clips_folder")
        layout.operator("rototoon.save_clip_from_armature", icon="FILE_TICK")
        draw_browser(layout, context)
        drive = layout.operator("rototoon.drive_bones", icon="ARMATURE_DATA")
        chosen = clip_browser.chosen()
        if chosen is not None:
            drive.content, drive.motion = chosen.character, chosen.motion
        layout.operator("rototoon.guess_bones", icon="BONE_DATA")
        if not settings.bones:
            layout.label(text="Guess Bones fills the list of key points", icon="INFO")
            return
        column = layout.column(align=True)
        split = column.split(factor=0.36, align=True)
        split.active = False
        split.label(text="Key Point")
        split = split.split(factor=0.7, align=True)
        split.label(text="Bone")
        split.label(text="Along")
        for item in settings.bones:
            split = column.split(factor=0.36, align=True)
            split.alert = item.bone not in context.object.data.bones
            split.label(text=bodies.label(item.name))
            split = split.split(factor=0.7, align=True)
            split.prop_search(item, "bone", context.object.data, "bones", text="")
            split.prop(item, "along", text="")


CLASSES = (ROTOTOON_PT_bones,)

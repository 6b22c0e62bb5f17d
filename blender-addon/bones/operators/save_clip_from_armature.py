"""Save Clip from Armature: adds the motion of bones to the library."""

import bpy

from ...blender import armatures, guard
from ...blender.errors import Problem
from ...common import jobs
from ...common.operators import Long, OnArmature
from ...style import clip_browser, clip_library
from ...style.clip_library import folder_of
from ...style.clip_properties import Performance, shared
from .. import key_points


class ROTOTOON_OT_save_clip_from_armature(Long, Performance, OnArmature, bpy.types.Operator):
    bl_idname = "rototoon.save_clip_from_armature"
    bl_label = "Save Clip from Armature"
    bl_description = "Save the motion of the armature's bones, seen from a side, as a skeleton clip in the library"
    bl_options = {"REGISTER"}
    changes = guard.NOTHING

    last: shared(
        "last", description="Last frame. If it is not after the first frame, the frames of the action"
    )
    view: bpy.props.EnumProperty(name="Seen From", description="Side from which the bones are seen", items=armatures.VIEWS)
    replace: shared("replace")
    folder: shared("folder")

    def invoke(self, context, _event):
        frames = armatures.range_of(context.object, context.scene)
        self.first, self.last = frames[0], frames[-1]
        self.character = self.character or context.object.name
        return context.window_manager.invoke_props_dialog(self)

    def begin(self, context):
        self._ob, self._postures = context.object, []
        self._folder = folder_of(self._ob, self.folder)
        key_points.table_of(self._ob)
        if self._ob.data.pose_position == "REST":
            raise Problem(f'"{self._ob.name}" is in Rest Position, so its bones do not move: choose Pose Position in the armature\'s properties')
        armatures.need_posed(self._ob)
        frames = range(self.first, self.last + 1)
        frames = frames if self.last > self.first else armatures.range_of(self._ob, context.scene)
        return jobs.Stepper(key_points.sample(self._ob, frames, self.view, self._postures), "reading poses")

    def finish(self, context, _work) -> str:
        render = context.scene.render
        character = self.character or self._ob.name
        made = key_points.clips(character, self.motion, render.fps / render.fps_base, self._postures)
        replaced = clip_library.add(self._folder, [(made, bpy.path.basename(bpy.data.filepath))], self.replace)
        clip_browser.refresh(self._folder)
        return f'"{self.motion}" by "{character}", {len(self._postures)} frames{clip_library.replaced(replaced)}'


CLASSES = (ROTOTOON_OT_save_clip_from_armature,)

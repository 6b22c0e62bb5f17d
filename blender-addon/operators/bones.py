"""Armatures: which bones tell the key points, their motion as clips, and bones that follow clips."""

import bpy
import numpy as np

from .. import actions, armatures, bone_driving, clip_browser, jobs, preferences
from ..clip_library import clips_of, folder_of
from ..errors import Problem
from ..style import KEY_POINTS, add_to_library, translate_clip
from .base import Guarded, Long
from .shared import shared


def armature_poll(cls, context) -> bool:
    """Poll: the active object is an armature of this file."""
    ob = context.object
    if ob is None or ob.type != "ARMATURE":
        cls.poll_message_set("Make an armature active first")
        return False
    if ob.library is not None or context.mode == "EDIT_ARMATURE":
        cls.poll_message_set("The armature is linked from another file, or in Edit Mode")
        return False
    return True


class ROTOTOON_OT_guess_bones(Guarded, bpy.types.Operator):
    bl_idname = "rototoon.guess_bones"
    bl_label = "Guess Bones"
    bl_description = "Find by their names the bones that tell the key points; what you chose stays"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return armature_poll(cls, context)

    def run(self, context) -> str:
        found = armatures.guess(context.object)
        missing = [point for point in KEY_POINTS if point not in found]
        return f"{len(found)} key points" + (f"; choose bones for {', '.join(missing)}" if missing else "")


class ROTOTOON_OT_save_clip_from_armature(Long, bpy.types.Operator):
    bl_idname = "rototoon.save_clip_from_armature"
    bl_label = "Save Clip from Armature"
    bl_description = "Keep the motion of the armature's bones, seen from a side, as a skeleton clip in the library"
    bl_options = {"REGISTER"}

    character: shared("performer")
    motion: shared("performed")
    first: shared("first")
    last: shared(
        "last", description="Last frame; where it is not after the first, the action's frames are taken"
    )
    view: bpy.props.EnumProperty(name="Seen From", description="On which plane it is seen", items=armatures.VIEWS)
    folder: shared("folder")

    @classmethod
    def poll(cls, context):
        return armature_poll(cls, context)

    def invoke(self, context, _event):
        frames = armatures.range_of(context.object, context.scene)
        self.first, self.last = frames[0], frames[-1]
        self.character = self.character or context.object.name
        return context.window_manager.invoke_props_dialog(self)

    def begin(self, context):
        self._ob, self._postures = context.object, []
        self._folder = folder_of(self._ob, self.folder)
        armatures.table_of(self._ob)
        frames = range(self.first, self.last + 1)
        frames = frames if self.last > self.first else armatures.range_of(self._ob, context.scene)
        return jobs.Stepper(armatures.sample(self._ob, frames, self.view, self._postures), "reading poses")

    def finish(self, context, _work) -> str:
        render = context.scene.render
        character = self.character or self._ob.name
        made = armatures.clips(character, self.motion, render.fps / render.fps_base, self._postures)
        add_to_library(self._folder, made, bpy.path.basename(bpy.data.filepath))
        clip_browser.refresh(self._folder)
        return f'"{self.motion}" by "{character}", {len(self._postures)} frames'


class ROTOTOON_OT_drive_bones(Long, bpy.types.Operator):
    bl_idname = "rototoon.drive_bones"
    bl_label = "Drive Bones"
    bl_description = (
        "Let the armature's bones follow a clip of the library in the view's plane, as it is or in another character's manner. "
        "Keys go into a new action; the one before stays in the file"
    )
    bl_options = {"REGISTER", "UNDO"}

    content: shared("character")
    motion: shared("motion")
    style: shared("style")
    preset: shared("preset")
    strength: shared("strength")
    view: bpy.props.EnumProperty(name="Plane", description="In which plane the limbs move", items=armatures.VIEWS)
    start: bpy.props.IntProperty(name="Start", description="Frame of the first posture", default=1)
    move: bpy.props.BoolProperty(name="Move", description="The pelvis goes where the clip's goes", default=True)
    folder: shared("folder")

    @classmethod
    def poll(cls, context):
        return armature_poll(cls, context)

    def invoke(self, context, _event):
        self.start = context.scene.frame_current
        return context.window_manager.invoke_props_dialog(self)

    def begin(self, context):
        self._ob = context.object
        armatures.table_of(self._ob)
        folder, threads = folder_of(self._ob, self.folder), preferences.threads()
        wanted = {"style": self.style, "motion": self.motion, "content": self.content}
        how = {"preset": self.preset, "strength": self.strength, "threads": threads}

        def work(progress):
            clips = clips_of(folder)
            if wanted["style"]:
                clips = translate_clip(clips, progress=progress, **wanted, **how)
                return clips["clips"][0], clips["fps"]
            return _only(clips, wanted["content"], wanted["motion"]), clips["fps"]

        return jobs.Worker(work)

    def finish(self, context, work) -> str:
        (clip, fps), ob, scene = work.result, self._ob, context.scene
        postures = np.array(clip["points"], np.float64)
        plane = bone_driving.Plane.of(ob, scene, self.view)
        found = list(bone_driving.poses(ob, postures, plane, self.move))
        frames = self.start + np.arange(len(postures)) * scene.render.fps / scene.render.fps_base / fps
        curves = bone_driving.channels(ob, found, self.move)
        manner = f" as {self.style}" if self.style else ""
        before = actions.give(ob, "OBJECT", f"{ob.name} {self.motion}{manner}", frames, curves)
        said = f"{len(found[0])} bones on frames {frames[0]:g} to {frames[-1]:g}"
        held = [name for name in found[0] if any(not c.mute for c in ob.pose.bones[name].constraints)]
        said += f"; their constraints hold {', '.join(held)}" if held else ""
        return said + (f'; the action "{before}" is kept' if before else "")


def _only(clips, character: str, motion: str):
    found = [c for c in clips["clips"] if c["motion"] == motion and character in ("", c["character"])]
    if len(found) != 1:
        names = ", ".join(f"{c['character']} {c['motion']}" for c in clips["clips"])
        raise Problem(f'Found {len(found)} clips "{motion}" by "{character}", expected one; the library holds {names}')
    return found[0]


CLASSES = (ROTOTOON_OT_guess_bones, ROTOTOON_OT_save_clip_from_armature, ROTOTOON_OT_drive_bones)

"""Drive Bones: bones follow a clip of the library."""

import bpy
import numpy as np
from rototoon.style import Found, read_library, skeleton_of, stance_of

from ...blender import actions, armatures, preferences
from ...blender.errors import Problem
from ...blender.frames import kept
from ...common import jobs
from ...common.operators import Long, OnArmature
from ...style.clip_library import clips_of, folder_of, refuse_damaged
from ...style.clip_properties import Manner, mirroring, shared
from .. import driving, key_points


class _Content:
    """The clip that the bones follow. It is a class of its own, so that the dialog lists it before the style."""

    content: shared("character")
    motion: shared("motion")


class ROTOTOON_OT_drive_bones(Manner, _Content, Long, OnArmature, bpy.types.Operator):
    bl_idname = "rototoon.drive_bones"
    bl_label = "Drive Bones"
    bl_description = (
        "Make the armature's bones follow a clip of the library in the view's plane, as it is or in another character's style. "
        "The keys are in a new action. The action before stays in the file"
    )
    bl_options = {"REGISTER", "UNDO"}

    view: bpy.props.EnumProperty(name="Plane", description="The plane in which the limbs move", items=armatures.VIEWS)
    start: bpy.props.IntProperty(name="Start", description="Frame of the first posture", default=1)
    move: bpy.props.BoolProperty(name="Move", description="The pelvis moves as in the clip", default=True)
    mirror: shared("mirror")
    folder: shared("folder")

    def invoke(self, context, _event):
        self.start = context.scene.frame_current
        return context.window_manager.invoke_props_dialog(self)

    def begin(self, context):
        self._ob, self._rests_on = context.object, []
        key_points.table_of(self._ob)
        armatures.need_posed(self._ob)
        folder, threads = folder_of(self._ob, self.folder), preferences.threads()
        content, motion = self.content, self.motion
        remake = self.remake(folder, motion, content) if self.style else None

        def work(progress):
            if remake is None:
                found = read_library(folder, content, motion, exact=True)
                self._file = found.clips
                return _only(folder, found, content, motion), found.clips["fps"]
            made = remake(progress, threads)
            self._rests_on, self._file = made.notes, made.clips
            return made.clips["clips"][0], made.clips["fps"]

        return jobs.Worker(work)

    def finish(self, context, work) -> str:
        (clip, fps), ob, scene = work.result, self._ob, context.scene
        postures = np.array(clip["points"], np.float64)
        one = {key: value for key, value in self._file.items() if key != "clips"} | {"clips": [clip]}
        stance, mirrored = stance_of(one), self.mirror == "on"
        with kept(scene):
            # The motion begins with the pose there, wherever the playhead is. If it is there, the pose need not be keyed.
            if (scene.frame_current, scene.frame_subframe) != (self.start, 0.0):
                scene.frame_set(self.start)
            plane = driving.Plane.of(ob, scene, self.view)
            rig = driving.looks(ob, plane)
            if self.mirror == "auto":
                mirrored = None not in (rig, stance.looks) and rig != stance.looks
            if mirrored:
                postures = driving.mirrored(postures)
            found = driving.poses(ob, postures, plane, self.move, stance.air)
            at_start = {bone.name: bone.matrix_basis.copy() for bone in ob.pose.bones}
        driving.pose(ob, at_start)
        frames = self.start + np.arange(len(postures)) * scene.render.fps / scene.render.fps_base / fps
        curves = driving.channels(ob, found, self.move)
        manner = f" as {self.style}" if self.style else ""
        before = actions.give(ob, "OBJECT", f"{ob.name} {self.motion}{manner}", frames, curves)
        for note in self._rests_on:
            self.warn(note)
        self.warn(f"the frames go on to {frames[-1]:g}, beyond the end of the scene ({scene.frame_end})" if frames[-1] > scene.frame_end else "")
        said = f"{len(found[0])} bones on frames {frames[0]:g} to {frames[-1]:g}"
        held = [name for name in found[0] if any(not c.mute for c in ob.pose.bones[name].constraints)]
        self.warn(f"constraints also move {', '.join(held)}" if held else "")
        said += mirroring({"rig": rig, "clip": stance.looks}, mirrored) if self.mirror == "auto" else ""
        return said + (f'; the action "{before}" is kept' if before else "")


def _only(folder: str, read: Found, character: str, motion: str):
    found = read.clips["clips"]
    if not found:
        refuse_damaged(folder, read)
    if len(found) == 1 and (body := skeleton_of(read.clips, found[0])) != "human":
        name = body if isinstance(body, str) else body["name"]
        raise Problem(f'"{motion}" by "{character}" is a clip of the body "{name}": bones follow human clips')
    if len(found) != 1:
        names = ", ".join(f"{c['character']} {c['motion']}" for c in clips_of(folder)["clips"])
        raise Problem(f'Found {len(found)} clips "{motion}" by "{character}", expected one; the library has {names}')
    return found[0]


CLASSES = (ROTOTOON_OT_drive_bones,)

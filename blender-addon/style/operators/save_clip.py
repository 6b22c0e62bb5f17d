"""Save Clip: adds the motion of contours to the library."""

import bpy
from rototoon.style import capture_clip

from ...blender import guard
from ...capture import document
from ...common.operators import Guarded, OnContours
from ...common.wording import counted
from .. import clip_browser, clip_library, limbs
from ..clip_library import folder_of
from ..clip_properties import Performance, shared


class ROTOTOON_OT_save_clip(Guarded, Performance, OnContours, bpy.types.Operator):
    bl_idname = "rototoon.save_clip"
    bl_label = "Save Clip"
    bl_description = "Save the motion of the tracked contours and their limbs as a skeleton clip in the library"
    bl_options = {"REGISTER"}
    changes = guard.NOTHING

    last: shared("last")
    replace: shared("replace")
    folder: shared("folder")

    def invoke(self, context, _event):
        settings = context.object.rototoon
        self.first, self.last = settings.first + settings.frame_offset, settings.last + settings.frame_offset
        self.character = self.character or context.object.name
        return context.window_manager.invoke_props_dialog(self)

    def run(self, context) -> str:
        ob = context.object
        folder = folder_of(ob, self.folder)
        reading = document.read(ob, results=True, gaps=True)
        project = reading.document
        limbs.needed(ob, project)
        self.warn(document.leave_out_missing(reading))
        document.reach(project)
        character, offset = self.character or ob.name, ob.rototoon.frame_offset
        frames = (self.first - offset, self.last - offset) if self.last > self.first else (None, None)
        made = capture_clip(project, character, self.motion, *frames)
        replaced = clip_library.add(folder, [(made.clips, bpy.path.basename(bpy.data.filepath))], self.replace)
        clip_browser.refresh(folder)
        shifted = f" (of the document; scene frames are {offset:+})" if offset else ""
        self.warn(f"the clip has what lost and doubtful contours show{shifted}: {'; '.join(made.doubts)}" if made.doubts else "")
        count = len(made.clips["clips"][0]["points"])
        guessed = f"; filled in: {', '.join(made.guessed)}" if made.guessed else ""
        return f'"{self.motion}" by "{character}", {counted(count, "frame")}{guessed}{clip_library.replaced(replaced)}'


CLASSES = (ROTOTOON_OT_save_clip,)

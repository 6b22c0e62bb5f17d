"""A drawing that follows a clip of the library, as it is or in another character's manner."""

import bpy

from .. import clip_browser, jobs, preferences, reshaping
from ..clip_library import clips_of, folder_of
from ..style import reshape, translate_clip
from .base import Long, contours_poll
from .shared import shared


class Reshaping(Long):
    """Reads the drawing, works in a thread, writes generated frames after it."""

    _before = 0.0
    """Share of the work before reshaping."""

    sub_keys: bpy.props.IntProperty(
        name="Sub-key Points", description="Points of each limb that hold its shape", default=5, min=0, max=100
    )
    folder: shared("folder")

    @classmethod
    def poll(cls, context):
        return contours_poll(cls, context)

    def invoke(self, context, _event):
        return context.window_manager.invoke_props_dialog(self)

    def work(self, context, clips, more=None):
        """The worker that reshapes the active drawing by what `clips(progress, threads)` gives: clips, and options; `more(drawing)`
        gives further options."""
        self._ob = context.object
        self._drawing = drawing = reshaping.begin(self._ob, context.scene.frame_current)
        threads, sub_keys, before = preferences.threads(), self.sub_keys, self._before
        further = more(drawing) if more is not None else {}

        def run(progress):
            chosen, options = clips(progress, threads)
            rest = lambda done, step: progress(before + (1 - before) * done, step)  # noqa: E731 - the rest of the bar
            return reshape(drawing.project, chosen, rest, sub_keys=sub_keys, threads=threads, **options, **further)

        return jobs.Worker(run)

    def finish(self, context, work) -> str:
        """Called in the end."""
        frames = reshaping.finish(self._ob, self._drawing, work.result)
        given = ", ".join(f"{entry['part']} ({entry['from']} to {entry['to']})" for entry in work.result.given)
        return f"{frames} frames after frame {self._drawing.frame}" + (f"; by the nearest limb: {given}" if given else "")


class ROTOTOON_OT_reshape_drawing(Reshaping, bpy.types.Operator):
    bl_idname = "rototoon.reshape_drawing"
    bl_label = "Reshape Drawing"
    bl_description = "Make the drawing at the playhead follow a clip of the library, on generated frames after it"
    bl_options = {"REGISTER", "UNDO"}

    character: shared("character", names=lambda _self: clip_browser.characters())
    motion: shared("motion", names=lambda self: clip_browser.motions(self.character))

    def begin(self, context):
        folder = folder_of(context.object, self.folder)
        wanted = {"character": self.character, "motion": self.motion}
        return self.work(context, lambda _progress, _threads: (clips_of(folder), wanted))


class ROTOTOON_OT_apply_motion(Reshaping, bpy.types.Operator):
    bl_idname = "rototoon.apply_motion"
    bl_label = "Apply Motion in Style of…"
    _before = 0.5
    bl_description = (
        "Re-make a motion of the library in another character's manner, and make the drawing at the playhead follow it, on "
        "generated frames after it"
    )
    bl_options = {"REGISTER", "UNDO"}

    motion: shared("motion")
    content: shared("character", name="Content", description="The character whose motion it was")
    style: shared("style", description="The character in whose manner")
    preset: shared("preset")
    strength: shared("strength")

    def begin(self, context):
        folder = folder_of(context.object, self.folder)
        wanted = {"style": self.style, "motion": self.motion, "content": self.content}
        how = {"preset": self.preset, "strength": self.strength}

        def clips(progress, threads):
            half = lambda done, step: progress(0.5 * done, step)  # noqa: E731 - the first half of the bar
            return translate_clip(clips_of(folder), progress=half, threads=threads, **wanted, **how), {}

        return self.work(context, clips)


CLASSES = (ROTOTOON_OT_reshape_drawing, ROTOTOON_OT_apply_motion)

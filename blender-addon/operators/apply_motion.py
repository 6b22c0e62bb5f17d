"""A drawing that follows a clip of the library, as it is or in another character's manner."""

import bpy

from .. import clip_browser, jobs, preferences, reshaping
from ..clip_library import clips_of, folder_of
from ..style import reshape, translate_clip
from .base import Long, contours_poll

PRESETS = (
    ("rototoon", "Rototoon", "Gaussian processes over style and posture"),
    ("bilinear", "Bilinear", "Tenenbaum & Freeman 2000, a style matrix for each character"),
    ("bilinear-symmetric", "Bilinear, Symmetric", "Tenenbaum & Freeman 2000, a style vector for each character"),
    ("liang2012", "Liang et al. 2012", "Non-negative factorisation"),
)


class Reshaping(Long):
    """Reads the drawing, works in a thread, writes generated frames after it."""

    _before = 0.0
    """Share of the work before reshaping."""

    sub_keys: bpy.props.IntProperty(
        name="Sub-key Points", description="Points of each limb that hold its shape", default=5, min=0, max=100
    )
    folder: bpy.props.StringProperty(name="Library", description="Another folder than the panel's", subtype="DIR_PATH")

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

    character: bpy.props.StringProperty(
        name="Character",
        description="Whose clip",
        search=lambda self, _context, text: clip_browser.offered(clip_browser.characters(), text),
        search_options={"SORT", "SUGGESTION"},
    )
    motion: bpy.props.StringProperty(
        name="Motion",
        description="Which motion",
        default="walk",
        search=lambda self, _context, text: clip_browser.offered(clip_browser.motions(self.character), text),
        search_options={"SORT", "SUGGESTION"},
    )

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

    motion: bpy.props.StringProperty(
        name="Motion",
        description="Which motion",
        default="walk",
        search=lambda _self, _context, text: clip_browser.offered(clip_browser.motions(), text),
        search_options={"SORT", "SUGGESTION"},
    )
    content: bpy.props.StringProperty(
        name="Content",
        description="The character whose motion it was",
        search=lambda self, _context, text: clip_browser.offered(clip_browser.characters(self.motion), text),
        search_options={"SORT", "SUGGESTION"},
    )
    style: bpy.props.StringProperty(
        name="Style",
        description="The character in whose manner",
        search=lambda _self, _context, text: clip_browser.offered(clip_browser.characters(), text),
        search_options={"SORT", "SUGGESTION"},
    )
    preset: bpy.props.EnumProperty(name="Method", description="How it is re-made", items=PRESETS)
    strength: bpy.props.FloatProperty(
        name="Strength", description="How thick the manner is laid on; 1 is the most probable", default=1.1, min=0, max=3
    )

    def begin(self, context):
        folder = folder_of(context.object, self.folder)
        wanted = {"style": self.style, "motion": self.motion, "content": self.content}
        how = {"preset": self.preset, "strength": self.strength}

        def clips(progress, threads):
            half = lambda done, step: progress(0.5 * done, step)  # noqa: E731 - the first half of the bar
            return translate_clip(clips_of(folder), progress=half, threads=threads, **wanted, **how), {}

        return self.work(context, clips)


CLASSES = (ROTOTOON_OT_reshape_drawing, ROTOTOON_OT_apply_motion)

"""Conform to New Footage."""

from dataclasses import replace

import bpy

from ...blender import footage
from ...blender.errors import Problem
from ...capture.operators.footage_base import FootageOperator
from ...capture.operators.footage_from_file import PictureFile
from ...common import jobs
from ...common.operators import OnDrawing
from .. import comparing, run

TIMINGS = (
    ("STAY", "Drawings Stay", "Most drawings stay on their frames, and the new footage is laid under them. Handles may lie before the scene's first frame"),
    ("SCENE", "Begin at Scene Start", "The scene's first frame shows the first picture"),
    ("FRAME", "Begin at Frame", "A frame of your choice shows the first picture"),
)


class ROTOTOON_OT_conform(PictureFile, FootageOperator, OnDrawing, bpy.types.Operator):
    bl_idname = "rototoon.conform"
    bl_label = "Conform to New Footage"
    bl_description = (
        "The footage was delivered again, at another size, with other frames or drawings: choose one picture of it. Your keys, corrections and lines go "
        "with their drawings, and so do results. Hidden layers go along too, locked ones are refused"
    )
    bl_options = {"REGISTER", "UNDO"}

    timing: bpy.props.EnumProperty(name="Frames", description="Which frame of the scene shows the first picture", items=TIMINGS)
    frame: bpy.props.IntProperty(name="Begin at Frame", description="Frame that shows the first picture, with Begin at Frame", default=1)
    compare: bpy.props.BoolProperty(
        name="Compare Pictures",
        description="Find place, size and frames by the pictures. Without it only the numbers of the pictures count, and the old footage may be gone",
        default=True,
    )
    frame_offset: bpy.props.IntProperty(
        name="Number Offset", description="What is added to the numbers of the pictures, if they are not compared", default=0
    )
    scale: bpy.props.FloatProperty(
        name="Scale",
        description="Pixels of the new picture for each pixel of the old one. 0 finds it by the pictures, or by their sizes if they are not compared",
        default=0.0,
        min=0.0,
        max=100.0,
        precision=4,
    )
    find_shift: bpy.props.BoolProperty(
        name="Find Shift", description="Find the place of the old picture in the new one by the pictures", default=True
    )
    shift: bpy.props.FloatVectorProperty(
        name="Shift", description="The place of the old picture's top left corner in the new picture, in pixels, if it is not to be found", size=2, default=(0.0, 0.0)
    )

    def invoke(self, context, event):
        """Called by Blender: the new footage has gaps as the old one has."""
        self.hold_gaps = context.object.rototoon.hold_gaps
        return super().invoke(context, event)

    def begin(self, context):
        """Checks the source and the layers, and compares. Frames of a movie go to the cache first."""
        self._ob = context.object
        run.need(self._ob)
        first = super().begin(context)
        return jobs.Chain(first, self._compare) if self._source.movie else self._compare()

    def _compare(self) -> jobs.Worker:
        self._shot = self.shot(bpy.context)
        if not self._source.movie:
            # The frame rate of a sequence is that of the old footage.
            self._shot = replace(self._shot, fps=footage.rate(self._ob))
        return run.begin(self._ob, self._shot, self._asked())

    def _asked(self) -> comparing.Asked:
        if 0.0 < self.scale < comparing.LEAST_SCALE:
            raise Problem(f"Scale: found {self.scale:.4g}, expected 0 or a number from {comparing.LEAST_SCALE}")
        return comparing.Asked(self.scale or None, None if self.find_shift else tuple(self.shift), None if self.compare else self.frame_offset)

    def finish(self, context, work):
        begins = {"STAY": None, "SCENE": context.scene.frame_start, "FRAME": self.frame}[self.timing]
        done = yield from run.finishing(self._ob, self._shot, work.result, begins)
        for text in done.warnings:
            self.warn(text)
        return done.text

    def draw(self, _context):
        """Called by Blender for the redo panel and the file browser's sidebar."""
        self.draw_hint()
        layout = self.layout
        layout.prop(self, "timing")
        row = layout.row()
        row.active = self.timing == "FRAME"
        row.prop(self, "frame")
        layout.prop(self, "hold_gaps")
        layout.prop(self, "compare")
        row = layout.row()
        row.active = not self.compare
        row.prop(self, "frame_offset")
        layout.prop(self, "scale")
        layout.prop(self, "find_shift")
        row = layout.row()
        row.active = not self.find_shift
        row.prop(self, "shift")


CLASSES = (ROTOTOON_OT_conform,)

"""Open Sample: a small cartoon to try everything on."""

from pathlib import Path

import bpy

from ...blender import preferences, stage, view
from ...blender.errors import Problem
from ...capture import sessions
from ...capture.operators.setup import look_at_footage
from ...common import jobs
from ...common.operators import Long
from ...exchange import importing
from .. import cartoon


class ROTOTOON_OT_open_sample(Long, bpy.types.Operator):
    bl_idname = "rototoon.open_sample"
    bl_label = "Open Sample"
    bl_description = (
        "Add a small cartoon with keys on its first and last frame, to try Track and corrections on, or its line drawings, to try "
        "Trace Drawing on. It is drawn on this machine; nothing is downloaded"
    )
    bl_options = {"REGISTER", "UNDO"}

    version: bpy.props.EnumProperty(
        name="Version",
        description="What is drawn",
        items=(
            ("PAINTED", "Painted", "The painted cartoon, with contours on two keys"),
            ("LINES", "Lines", "Its line drawings, ink on paper"),
        ),
    )

    def begin(self, _context):
        self._folder = Path(preferences.data_folder("sample"))
        return jobs.Worker(self._write)

    def _write(self, progress) -> bool:
        try:
            return cartoon.write(self._folder, progress, self.version == "LINES")
        except OSError as error:
            raise Problem(f"Cannot write the sample's pictures to {self._folder}: {error}") from error

    def finish(self, context, _work) -> str:
        lines = self.version == "LINES"
        project = cartoon.document(self._folder, lines)
        shot = project["footage"]
        view.leave_mode(context)
        shown = stage.Shot(
            shot["pattern"], shot["first"], shot["last"], shot["width"], shot["height"], shot["fps"], context.scene.frame_start
        )
        ob = stage.build(context, shown, "CAMERA", "Penguin", match_scene=True)
        stage.hide_default_cube(context.scene)
        context.view_layer.update()
        importing.apply(ob, project)
        sessions.drop(ob)
        ob.data.update_tag()
        context.scene.frame_set(context.scene.frame_start)
        look_at_footage(context, ob)
        if lines:
            return "The line drawings of a penguin. Open the panel Lines and press Trace Drawing"
        return "A penguin with keys on its first and last frame. Press Track, then Go to Weakest Frame: the wing waves there"


CLASSES = (ROTOTOON_OT_open_sample,)

"""Import Document."""

import os

import bpy

from ...blender import footage, stage, view
from ...blender.errors import Problem
from ...capture import sessions
from ...common.operators import Guarded
from ...common.wording import counted
from .. import files, filled, importing, traced


class ROTOTOON_OT_import_document(Guarded, bpy.types.Operator):
    bl_idname = "rototoon.import_document"
    bl_label = "Import Document"
    bl_description = "Make strokes from a Rototoon project document: keys, corrections, tracks, snapped and traced lines, paint"
    bl_options = {"REGISTER", "UNDO"}

    filepath: bpy.props.StringProperty(name="File", description="The project document", subtype="FILE_PATH", options={"SKIP_SAVE"})
    filter_glob: bpy.props.StringProperty(default="*.json", options={"HIDDEN"})
    into: bpy.props.EnumProperty(
        name="Into",
        description="The object that gets the contours",
        items=(
            ("NEW", "New Object", "A new Grease Pencil object, with a camera if the scene has none"),
            ("ACTIVE", "Active Object", "The active Grease Pencil object. Its contours are replaced, on hidden layers too"),
        ),
    )
    keep_numbers: bpy.props.BoolProperty(
        name="Keep Frame Numbers",
        description="Show picture n on frame n, instead of the first picture on the scene's first frame",
        default=False,
    )

    def invoke(self, context, _event):
        """Called by Blender: opens the file browser. A file that was dropped into the window is taken at once."""
        if self.filepath:
            return self.execute(context)
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def run(self, context) -> str:
        path = bpy.path.abspath(self.filepath)
        project = files.load(path)
        traced.checked(project)
        filled.read(project)
        shot = self._shot(context, project["footage"], os.path.dirname(os.path.abspath(path)))
        if self.into == "ACTIVE":
            ob = context.object
            if ob is None or ob.type != "GREASEPENCIL":
                raise Problem("Make a Grease Pencil object active, or import into a new one")
            importing.need_open(ob)
            traced.need_open(ob, project)
            filled.need_open(ob, project)
            stage.assign(ob, shot)
        else:
            name = os.path.splitext(os.path.basename(path))[0]
            view.leave_mode(context)
            ob = stage.build(context, shot, "CAMERA", name, match_scene=True)
        context.view_layer.update()
        importing.apply(ob, project)
        lines, paint = traced.draw(ob, project), filled.draw(ob, project)
        sessions.drop(ob)
        ob.data.update_tag()
        also = f" and {counted(lines, 'traced stroke')}" if lines else ""
        also += f" and paint of {counted(paint, 'frame')}" if paint else ""
        return f"{counted(len(ob.rototoon.parts), 'part')}{also} from {os.path.basename(path)}"

    def _shot(self, context, shot: dict, folder: str) -> stage.Shot:
        pattern = os.path.normpath(os.path.join(folder, shot["pattern"]))
        first = footage.picture(pattern, shot["first"])
        if not os.path.isfile(first):
            raise Problem(f"No picture {first}: the document's footage is missing")
        start = shot["first"] if self.keep_numbers else context.scene.frame_start
        fps = float(shot.get("fps", 24.0))
        return stage.Shot(pattern, shot["first"], shot["last"], shot["width"], shot["height"], fps, start)


CLASSES = (ROTOTOON_OT_import_document,)

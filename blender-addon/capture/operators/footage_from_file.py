"""Footage from File."""

from dataclasses import replace

import bpy

from ...blender import footage
from ...blender.errors import Problem
from .footage_base import FootageOfActive

FILTER = "*.png;*.jpg;*.jpeg;*.tif;*.tiff;*.bmp;*.webp;*.exr;" + ";".join("*" + end for end in sorted(footage.MOVIES))


class PictureFile:
    """A file: a picture of a sequence, or a movie."""

    filepath: bpy.props.StringProperty(
        name="File", description="Any picture of the sequence, or a movie", subtype="FILE_PATH", options={"SKIP_SAVE", "PATH_SUPPORTS_BLEND_RELATIVE"}
    )
    filter_glob: bpy.props.StringProperty(default=FILTER, options={"HIDDEN"})

    def invoke(self, context, _event):
        """Called by Blender: opens the file browser. A file that was dropped into the window is taken at once."""
        if self.filepath:
            return self._follow(context)
        self._picked = True
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def source(self, context) -> footage.Source:
        """The chosen file."""
        if not self.filepath:
            raise Problem("No file chosen")
        path = bpy.path.abspath(self.filepath)
        return footage.Source(path, footage.is_movie(path))

    def draw_hint(self) -> None:
        """Draws what to choose, in the file browser's sidebar."""
        if bpy.context.area is not None and bpy.context.area.type == "FILE_BROWSER":
            column = self.layout.column(align=True)
            column.label(text="Choose a movie, or any picture", icon="INFO")
            column.label(text="of a sequence: the others are found", icon="BLANK1")


class FilePicker(PictureFile):
    """A file, and the frame of its first picture."""

    at_scene_start: bpy.props.BoolProperty(
        name="Begin at Scene Start", description="Show the first picture on the scene's first frame", default=True
    )
    frame: bpy.props.IntProperty(
        name="Begin at Frame", description="Frame that shows the first picture, if it is not the scene's first frame", default=1
    )

    def timed(self, context, shot):
        """The footage with the chosen first frame."""
        return replace(shot, frame_of_first=context.scene.frame_start if self.at_scene_start else self.frame)

    def draw(self, _context) -> None:
        """Called by Blender for the redo panel and the file browser's sidebar."""
        self.draw_hint()
        self.layout.prop(self, "at_scene_start")
        row = self.layout.row()
        row.active = not self.at_scene_start
        row.prop(self, "frame")
        self.layout.prop(self, "hold_gaps")


class ROTOTOON_OT_footage_from_file(FilePicker, FootageOfActive, bpy.types.Operator):
    bl_idname = "rototoon.footage_from_file"
    bl_label = "Footage from File"
    bl_description = "Choose one picture of the footage, and the sequence around it is found. Movies work too"
    bl_options = {"REGISTER", "UNDO"}

    def apply(self, context, shot):
        return self.assign(self.timed(context, shot))


CLASSES = (ROTOTOON_OT_footage_from_file,)

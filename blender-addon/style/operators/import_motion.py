"""Import Motion Capture: adds BVH files to the library."""

import os

import bpy
from rototoon import RototoonError
from rototoon.style import import_and_note

from ...blender.errors import Problem
from ...common.operators import Guarded
from ...common.wording import counted
from .. import clip_browser, clip_library
from ..clip_library import folder_of
from ..clip_properties import shared

VIEWS = (
    ("auto", "Where Most Is Seen", "From the side that shows most of the motion"),
    ("front", "Front", "The figure faces the picture"),
    ("side", "Side", "The figure faces a side of the picture"),
    ("three-quarter", "Three Quarters", "Half-way between front and side"),
    ("angle", "Angle", "From an angle about the vertical axis"),
)


class ROTOTOON_OT_import_motion(Guarded, bpy.types.Operator):
    bl_idname = "rototoon.import_motion"
    bl_label = "Import Motion Capture"
    bl_description = "Add motion capture files (BVH), seen from one side, to the library as skeleton clips"
    bl_options = {"REGISTER"}

    filepath: bpy.props.StringProperty(name="File", description="A BVH file", subtype="FILE_PATH", options={"PATH_SUPPORTS_BLEND_RELATIVE"})
    directory: bpy.props.StringProperty(
        name="Folder", description="Folder of several files", subtype="DIR_PATH", options={"HIDDEN", "PATH_SUPPORTS_BLEND_RELATIVE"}
    )
    files: bpy.props.CollectionProperty(
        name="Files",
        description='Several files of the folder, each {"name": file name}',
        type=bpy.types.OperatorFileListElement,
        options={"HIDDEN", "SKIP_SAVE"},
    )
    filter_glob: bpy.props.StringProperty(default="*.bvh", options={"HIDDEN"})
    character: bpy.props.StringProperty(
        name="Character", description="The character who moves. If empty, the name of the file's folder"
    )
    motion: bpy.props.StringProperty(
        name="Motion", description="Name of the motion. If empty, the file's name. Several files always get their own names"
    )
    view: bpy.props.EnumProperty(name="Seen From", description="Side from which the figure is seen", items=VIEWS)
    angle: bpy.props.FloatProperty(
        name="Angle", description="Angle about the vertical axis: 0 is the front, 90 the side", min=-360, max=360
    )
    way: bpy.props.BoolProperty(
        name="Go Its Way",
        description="The pelvis travels through the picture, so that feet can stand still. Otherwise it stays in its place",
        default=True,
    )
    replace: shared("replace")
    folder: shared("folder")

    def invoke(self, context, _event):
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def draw(self, _context) -> None:
        """Called by Blender for the file browser's sidebar and the redo panel."""
        for name in ("character", "motion", "view"):
            self.layout.prop(self, name)
        row = self.layout.row()
        row.active = self.view == "angle"
        row.prop(self, "angle")
        self.layout.prop(self, "way")
        self.layout.prop(self, "replace")

    def run(self, context) -> str:
        folder = folder_of(context.object if hasattr(context.object, "rototoon") else None, self.folder)
        paths = self._paths()
        # All files are read before any is added. So an error leaves the library as it was.
        made = [(path, self._clip(path, len(paths) == 1)) for path in paths]
        replaced = clip_library.add(folder, [(clips, os.path.basename(path)) for path, clips in made], self.replace)
        clip_browser.refresh(folder)
        clips = [file["clips"][0] for _, file in made]
        if len(clips) == 1:
            return f'"{clips[0]["motion"]}" by "{clips[0]["character"]}", {counted(len(clips[0]["points"]), "frame")}' + clip_library.replaced(replaced)
        return counted(len(clips), "clip") + clip_library.replaced(replaced)

    def _paths(self) -> list[str]:
        folder = bpy.path.abspath(self.directory)
        chosen = [os.path.join(folder, file.name) for file in self.files if file.name]
        paths = chosen or ([bpy.path.abspath(self.filepath)] if self.filepath else [])
        if not paths:
            raise Problem("No file chosen")
        return sorted(paths)

    def _clip(self, path: str, alone: bool) -> dict:
        try:
            with open(path, encoding="utf-8", errors="replace") as file:
                motion = file.read()
        except OSError as error:
            raise Problem(f"{path}: {error.strerror}") from error
        whole = os.path.abspath(path)
        character = self.character or os.path.basename(os.path.dirname(whole))
        name = (self.motion if alone else "") or os.path.splitext(os.path.basename(whole))[0]
        view = self.angle if self.view == "angle" else self.view
        try:
            made = import_and_note(motion, character, name, view=view, way=self.way)
        except RototoonError as error:
            raise Problem(f"{os.path.basename(path)}: {error}") from error
        for note in made.notes:
            self.warn(f"{os.path.basename(path)}: {note}")
        return made.clips


CLASSES = (ROTOTOON_OT_import_motion,)

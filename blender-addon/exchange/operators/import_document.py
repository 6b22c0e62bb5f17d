"""Import Document."""

import os

import bpy

from ...blender import footage, stage, view
from ...blender.errors import Problem
from ...capture import sessions
from ...common.operators import Guarded
from ...common.wording import counted, listed
from .. import drawn, files, filled, importing, known_files, looks, places


class _Scene:
    """A scene's camera, size and frames."""

    def __init__(self, scene):
        render = scene.render
        self.camera, self.size, self.frames = scene.camera, f"{render.resolution_x}x{render.resolution_y}", f"{scene.frame_start} to {scene.frame_end}"

    def changes(self, scene, ob) -> str:
        """What is other now, and through which camera an object is seen if that is not the scene's, or new."""
        now, camera, said = _Scene(scene), ob.rototoon.camera, ""
        if self.camera is not None and camera != self.camera:
            said += f'; it is seen through {"a new camera" if now.camera == camera else "a camera of its own"}, "{camera.name}"'
        if now.size != self.size:
            said += f"; the scene has {now.size} pixels now, before {self.size}"
        return said + (f"; the scene has the frames {now.frames} now, before {self.frames}" if now.frames != self.frames else "")


class ROTOTOON_OT_import_document(Guarded, bpy.types.Operator):
    bl_idname = "rototoon.import_document"
    bl_label = "Import Document"
    bl_description = (
        "Make strokes from a Rototoon project document: keys, corrections, tracks, snapped lines, drawings, traced lines, in-betweens, "
        "paint"
    )
    bl_options = {"REGISTER", "UNDO"}

    filepath: bpy.props.StringProperty(name="File", description="The project document", subtype="FILE_PATH", options={"SKIP_SAVE", "PATH_SUPPORTS_BLEND_RELATIVE"})
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
        description="Show picture n on frame n. Otherwise an object with the same footage keeps its frames, and the first picture of other "
        "footage is on the scene's first frame",
        default=False,
    )
    match_scene: bpy.props.BoolProperty(
        name="Match Scene",
        description="Give the scene the footage's size, frames and camera, for a new object. If it is not given, only a scene that has no camera and nothing to "
        "render beside footage gets them",
        default=False,
        options={"SKIP_SAVE"},
    )

    def invoke(self, context, _event):
        """Called by Blender: opens the file browser. A file that was dropped into the window is taken at once."""
        if not self.properties.is_property_set("match_scene"):
            self.match_scene = not stage.in_use(context.scene)
        if self.filepath:
            return self.execute(context)
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def run(self, context) -> str:
        if not self.filepath:
            raise Problem("No file chosen")
        path = bpy.path.abspath(self.filepath)
        held = known_files.mark(path)
        project = files.load(path)
        drawn.checked(project)
        filled.read(project)
        filled.recolours_of(project)
        ob = self._given(context)
        shot = self._shot(context, ob, project["footage"], os.path.dirname(os.path.abspath(path)))
        if ob is not None:
            importing.need_open(ob, project)
            drawn.need_open(ob, project)
            filled.need_open(ob, project)
            self._tell_of_other_footage(ob, shot)
            had, where = looks.of(ob), ""
            with stage.tried(ob, shot):
                context.view_layer.update()
                places.need(ob, project, had)
        else:
            name = os.path.splitext(os.path.basename(path))[0]
            view.leave_mode(context)
            ob, where = self._build(context, shot, name)
            had = looks.Looks()
        context.view_layer.update()
        importing.apply(ob, project, had)
        lines, paint = drawn.draw(ob, project), filled.draw(ob, project)
        sessions.drop(ob)
        known_files.note(ob, path, held)
        ob.data.update_tag()
        return f"{' and '.join(self._said(ob, lines, paint))} from {os.path.basename(path)}{where}"

    def _build(self, context, shot: stage.Shot, name: str):
        """The new object, and what is to be told of it and of the scene."""
        scene = context.scene
        match = self.match_scene if self.properties.is_property_set("match_scene") else not stage.in_use(scene)
        before = _Scene(scene)
        ob = stage.build(context, shot, "CAMERA", name, match, own_camera=match)
        return ob, f', in the new object "{ob.name}"{before.changes(scene, ob)}'

    def _said(self, ob, lines, paint: int) -> list[str]:
        """What came in, for the message."""
        if lines.stayed:
            self.warn(f"drawings of yours stay as they were, on {listed(sorted(lines.stayed))}")
        if lines.kept:
            self.warn(f"in-betweens of this object stay as they were, on {listed(sorted(lines.kept))}")
        if lines.beside:
            said = f"left out: {counted(len(lines.beside), 'in-between')} beside drawings of yours that stay, on {listed(sorted(lines.beside))}"
            self.warn(f"{said}; press In-between there")
        if lines.pairs:
            self.warn(f"left out: {counted(lines.pairs, 'pair')} of strokes on drawings of yours that stay; pair them by Match Strokes")
        if lines.left:
            verb = "lies" if lines.left == 1 else "lie"
            self.warn(f"left out: {counted(lines.left, 'in-between')} that {verb} between no two drawings of the document")
        found = [counted(lines.keys, "drawing")] if lines.keys else []
        found += [counted(lines.strokes, "traced stroke")] if lines.strokes else []
        found += [counted(lines.between, "in-between")] if lines.between else []
        found += [f"paint of {counted(paint, 'frame')}"] if paint else []
        parts = [counted(len(ob.rototoon.parts), "part")] if len(ob.rototoon.parts) or not found else []
        return parts + found

    def _given(self, context) -> bpy.types.Object | None:
        """The object that gets the contours; `None` for a new one."""
        if self.into == "NEW":
            return None
        if context.object is None or context.object.type != "GREASEPENCIL":
            raise Problem("Make a Grease Pencil object active, or import into a new one")
        return context.object

    def _tell_of_other_footage(self, ob, shot: stage.Shot) -> None:
        if ob.rototoon.pattern and footage.absolute(ob, ob.rototoon.pattern) != shot.pattern:
            name = os.path.basename(shot.pattern)
            self.warn(f'"{ob.name}" has other footage now: {name}, with picture {shot.first} on frame {shot.frame_of_first}')

    def _shot(self, context, ob, shot: dict, folder: str) -> stage.Shot:
        pattern = os.path.normpath(os.path.join(folder, shot["pattern"]))
        first = footage.picture(pattern, shot["first"])
        if not os.path.isfile(first):
            raise Problem(f"No picture {first}: the document's footage is missing")
        start, movie = context.scene.frame_start, ""
        if ob is not None and ob.rototoon.pattern and footage.absolute(ob, ob.rototoon.pattern) == pattern:
            start = shot["first"] + ob.rototoon.frame_offset
            movie = footage.absolute(ob, ob.rototoon.movie) if ob.rototoon.movie else ""
        start = shot["first"] if self.keep_numbers else start
        fps = float(shot.get("fps", 24.0))
        return stage.Shot(pattern, shot["first"], shot["last"], shot["width"], shot["height"], fps, start, movie, hold_gaps="gaps" in shot)


CLASSES = (ROTOTOON_OT_import_document,)

"""Set Up: footage, a camera or reference image that shows it, and an object to draw on."""

import os

import bpy

from ...blender import grease_pencil as gp
from ...blender import stage, view
from .. import properties
from .footage_base import FootageOperator, described
from .footage_from_file import FilePicker


NO_NAMES = {"f", "frame", "frames", "image", "images", "img", "pic", "picture", "pictures", "png", "render", "seq", "sequence"}
"""Names of files and folders that do not tell what the footage is."""


class ROTOTOON_OT_setup(FilePicker, FootageOperator, bpy.types.Operator):
    bl_idname = "rototoon.setup"
    bl_label = "Set Up Footage"
    bl_description = (
        "Choose footage: a picture of a sequence, or a movie. You get a camera or a reference image that shows it, "
        "an object to draw on, and a brush for contours in Draw Mode"
    )
    bl_options = {"REGISTER", "UNDO"}

    plane: bpy.props.EnumProperty(name="Show In", description="What shows the footage", items=properties.PLANES)
    match_scene: bpy.props.BoolProperty(
        name="Match Scene",
        description="Give the scene the footage's size and frames. If other footage uses the scene, its size stays, and frames are only added",
        default=True,
    )
    start_drawing: bpy.props.BoolProperty(
        name="Start Drawing",
        description="Look at the footage and go to Draw Mode with a brush for contours. Without a window nothing changes",
        default=True,
    )

    def apply(self, context, shot):
        shot = self.timed(context, shot)
        return described(shot) + prepare(context, shot, self.plane, self.match_scene, self.start_drawing)

    def draw(self, context):
        super().draw(context)
        for name in ("plane", "match_scene", "start_drawing"):
            self.layout.prop(self, name)


def prepare(context, shot: stage.Shot, plane: str, match_scene: bool, start_drawing: bool) -> str:
    """Makes the camera or reference image and the object, and goes to Draw Mode. Returns the rest of the message."""
    view.leave_mode(context)
    before = context.scene.camera
    stage.build(context, shot, plane, _name(shot), match_scene)
    camera, said = context.scene.camera, ""
    if before is not None and camera != before:
        said += f'; it is seen through a new camera, "{camera.name}"'
    render = context.scene.render
    if match_scene and (render.resolution_x, render.resolution_y) != (shot.width, shot.height):
        said += f"; the scene keeps its {render.resolution_x}x{render.resolution_y}, since other footage uses it"
    if stage.hide_default_cube(context.scene):
        said += "; the default cube is hidden"
    if start_drawing:
        look_at_footage(context, context.object)
        if view.begin_to_draw(context):
            make_frame(gp.active_layer(context.object), context.scene.frame_current)
            said += ". Now draw one closed line around each part"
    return said


def make_frame(layer, frame: int) -> bool:
    """Makes an empty key on a frame without one: Blender draws on no frame, or on the frame before. Returns whether it was needed."""
    if frame in gp.drawings(layer):
        return False
    gp.make_frames(layer, [frame], gp.KEYFRAME)
    return True


def look_at_footage(context, ob) -> None:
    """Shows the footage of an object in the 3D view."""
    settings = ob.rototoon
    if settings.plane == "REFERENCE":
        view.look_from_front(context)
        return
    if settings.camera is not None and context.scene.camera is None:
        context.scene.camera = settings.camera
    view.look_through_camera(context, settings.camera)


def _name(shot: stage.Shot) -> str:
    """The name of the movie, or of the sequence without its number; if that says nothing, the name of the folder around it."""
    path = shot.movie or shot.pattern
    stem = os.path.splitext(os.path.basename(path))[0].split("%")[0].rstrip("_-. ")
    folder = os.path.dirname(os.path.abspath(path))
    names = [stem, os.path.basename(folder), os.path.basename(os.path.dirname(folder))]
    telling = [name for name in names if name and name.lower() not in NO_NAMES]
    return telling[0] if telling else stem or "Contours"


CLASSES = (ROTOTOON_OT_setup,)

"""Objects to begin with: a camera or reference image that shows the footage, and a Grease Pencil object that faces it."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass

import bpy
from mathutils import Matrix

from . import camera as cameras
from . import footage
from . import grease_pencil as gp

WIDTH = 10.0
"""Width of a new camera's frame or reference image in scene units. Blender's brushes suit this size."""
DISTANCE = 10.0
"""Distance of a new camera from the drawing plane."""


@dataclass(frozen=True)
class Shot:
    """A picture sequence and its timing."""

    pattern: str
    first: int
    last: int
    width: int
    height: int
    fps: float
    frame_of_first: int
    movie: str = ""


def assign(ob, shot: Shot) -> None:
    """Gives an object its footage."""
    settings = ob.rototoon
    settings.pattern = footage.relative(shot.pattern, bpy.data.filepath)
    settings.movie = footage.relative(shot.movie, bpy.data.filepath) if shot.movie else ""
    settings.first, settings.last = shot.first, shot.last
    settings.width, settings.height = shot.width, shot.height
    settings.fps = shot.fps
    settings.frame_offset = shot.frame_of_first - shot.first


def build(context, shot: Shot, plane: str, name: str, match_scene: bool) -> bpy.types.Object:
    """Makes a camera background or a reference image, and a Grease Pencil object with the footage, which becomes active."""
    scene = context.scene
    if match_scene:
        scene.render.resolution_x, scene.render.resolution_y = shot.width, shot.height
        scene.frame_start = shot.frame_of_first
        scene.frame_end = shot.frame_of_first + shot.last - shot.first
    ob = gp.new_object(name, context.collection or scene.collection)
    assign(ob, shot)
    ob.rototoon.plane = plane
    if plane == "REFERENCE":
        ob.rototoon.reference = _reference(context, shot, name)
    else:
        camera = _camera(context)
        _background(camera, shot)
        ob.matrix_world = _facing(scene, camera)
    layer = gp.layer(ob, ob.rototoon.contours_layer)
    ob.data.layers.active = layer
    ob.show_in_front = True
    _activate(context, ob)
    return ob


def _camera(context):
    scene = context.scene
    if scene.camera is not None:
        return scene.camera
    data = bpy.data.cameras.new("Camera")
    data.type, data.ortho_scale = "ORTHO", WIDTH
    camera = bpy.data.objects.new("Camera", data)
    camera.matrix_world = Matrix.Translation((0, -DISTANCE, 0)) @ Matrix.Rotation(math.pi / 2, 4, "X")
    (context.collection or scene.collection).objects.link(camera)
    scene.camera = camera
    return camera


def load_sequence(shot: Shot):
    """The footage as an image data-block."""
    image = bpy.data.images.load(footage.picture(shot.pattern, shot.first), check_existing=True)
    image.source = "SEQUENCE"
    image.name = os.path.basename(shot.pattern)
    return image


def _time(user, shot: Shot) -> None:
    user.frame_duration = shot.last - shot.first + 1
    user.frame_start = shot.frame_of_first
    user.frame_offset = shot.first - 1
    user.use_auto_refresh = True


def _background(camera, shot: Shot) -> None:
    camera.data.show_background_images = True
    image = load_sequence(shot)
    entry = next((e for e in camera.data.background_images if e.source == "IMAGE" and e.image == image), None)
    if entry is None:
        entry = camera.data.background_images.new()
        entry.image, entry.frame_method, entry.alpha = image, "FIT", 1.0
    _time(entry.image_user, shot)


def _reference(context, shot: Shot, name: str):
    empty = bpy.data.objects.new(f"{name} footage", None)
    empty.empty_display_type = "IMAGE"
    empty.data = load_sequence(shot)
    _time(empty.image_user, shot)
    empty.empty_display_size = WIDTH
    empty.empty_image_offset = (-0.5, -0.5)
    # A little behind the drawing plane, so that strokes are visible.
    empty.matrix_world = Matrix.Translation((0, 0.001, 0)) @ Matrix.Rotation(math.pi / 2, 4, "X")
    (context.collection or context.scene.collection).objects.link(empty)
    return empty


def _facing(scene, camera) -> Matrix:
    """The matrix of an object whose front (XZ) plane faces the camera, where the camera's frame is `WIDTH` wide."""
    bpy.context.view_layer.update()
    left, bottom, width, height = cameras.camera_frame(scene.render, camera.data)
    centre = (left + width / 2, bottom + height / 2)
    matrix = camera.matrix_world.normalized()
    distance = DISTANCE if camera.data.type == "ORTHO" else WIDTH / width
    reach = 1.0 if camera.data.type == "ORTHO" else distance
    place = Matrix.Translation((centre[0] * reach, centre[1] * reach, -distance))
    # The object's Y axis points away from the viewer, its Z axis up.
    return matrix @ place @ Matrix.Rotation(-math.pi / 2, 4, "X")


def _activate(context, ob) -> None:
    for other in context.view_layer.objects:
        other.select_set(False)
    ob.select_set(True)
    context.view_layer.objects.active = ob

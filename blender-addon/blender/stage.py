"""Objects to begin with: a camera or reference image that shows the footage, and a Grease Pencil object that faces it."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import bpy
from mathutils import Matrix

from . import camera as cameras
from . import footage, guard, placement
from . import grease_pencil as gp
from .errors import Problem

WIDTH = 10.0
"""Width of a new camera's frame or reference image in scene units. Blender's brushes suit this size."""
DISTANCE = 10.0
"""Distance of a new camera from the drawing plane."""
_FOOTAGE = ("pattern", "movie", "first", "last", "width", "height", "fps", "hold_gaps", "frame_offset")
"""The settings that `assign` changes."""
_RENDERED = {"MESH", "CURVE", "SURFACE", "META", "FONT", "CURVES", "POINTCLOUD", "VOLUME", "GREASEPENCIL"}
"""Types of objects that can be seen in a render."""


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
    hold_gaps: bool = False
    """Whether a frame without a file shows the picture before it."""


def assign(ob, shot: Shot) -> None:
    """Gives an object its footage."""
    settings = ob.rototoon
    blend = bpy.data.filepath if footage.wants_relative() else ""
    settings.pattern = footage.relative(shot.pattern, blend)
    settings.movie = footage.relative(shot.movie, blend) if shot.movie else ""
    settings.first, settings.last = shot.first, shot.last
    settings.width, settings.height = shot.width, shot.height
    settings.fps = shot.fps
    settings.hold_gaps = shot.hold_gaps
    settings.frame_offset = shot.frame_of_first - shot.first


@contextmanager
def tried(ob, shot: Shot) -> Iterator[None]:
    """Gives an object its footage. If what is done with it raises a `Problem`, the object has its old footage again."""
    settings = ob.rototoon
    before = {name: getattr(settings, name) for name in _FOOTAGE}
    assign(ob, shot)
    try:
        yield
    except Problem:
        for name, value in before.items():
            setattr(settings, name, value)
        raise


def build(context, shot: Shot, plane: str, name: str, match_scene: bool, own_camera: bool = True) -> bpy.types.Object:
    """Makes a camera background or a reference image, and a Grease Pencil object with the footage, which becomes active. A new camera becomes the
    scene's with `own_camera`, or if the scene has none."""
    scene = context.scene
    if match_scene:
        _match(scene, shot)
    ob = gp.new_object(name, collection_of(context))
    assign(ob, shot)
    ob.rototoon.plane = plane
    if plane == "REFERENCE":
        ob.rototoon.reference = _reference(context, shot, name)
    else:
        camera = ob.rototoon.camera = _camera(context, shot, name, own_camera)
        _background(camera, shot)
        ob.matrix_world = _facing(scene, camera)
    layer = gp.layer(ob, ob.rototoon.contours_layer)
    ob.data.layers.active = layer
    ob.show_in_front = True
    _activate(context, ob)
    return ob


def collection_of(context) -> bpy.types.Collection:
    """The collection for new objects: the active one. If it belongs to another file, that of the scene."""
    active = context.collection
    others = active is None or active.library is not None or active.override_library is not None
    return context.scene.collection if others else active


def _users(scene) -> list[bpy.types.Object]:
    """The scene's objects that have footage."""
    return [ob for ob in scene.objects if ob.rototoon.pattern]


def _match(scene, shot: Shot) -> None:
    """Gives the scene the footage's size and frames. If other footage uses the scene, the size stays, and frames are only added."""
    last = shot.frame_of_first + shot.last - shot.first
    if _users(scene):
        scene.frame_start, scene.frame_end = min(scene.frame_start, shot.frame_of_first), max(scene.frame_end, last)
        return
    scene.render.resolution_x, scene.render.resolution_y = shot.width, shot.height
    scene.frame_start, scene.frame_end = shot.frame_of_first, last
    if not scene.frame_start <= scene.frame_current <= last:
        scene.frame_set(scene.frame_start)


def in_use(scene) -> bool:
    """Whether a scene has something to render beside objects with footage: then its size, its frames and its camera are somebody's."""
    if any(ob.type in _RENDERED and not ob.hide_render and not ob.rototoon.pattern and not _is_default_cube(ob) for ob in scene.objects):
        return True
    return scene.camera is not None and not _is_default(scene.camera) and not _users(scene)


def _camera(context, shot: Shot, name: str, own: bool):
    """The scene's camera if it is free, otherwise a new one. It becomes the scene's if it is its `own`, or the scene has none."""
    scene = context.scene
    if scene.camera is not None and _is_free(scene.camera, shot):
        return scene.camera
    data = bpy.data.cameras.new("Camera" if scene.camera is None else f"{name} Camera")
    data.type, data.ortho_scale = "ORTHO", WIDTH
    camera = bpy.data.objects.new(data.name, data)
    aside = 1.5 * WIDTH * sum(len(other.data.background_images) > 0 for other in scene.objects if other.type == "CAMERA")
    camera.matrix_world = Matrix.Translation((aside, -DISTANCE, 0)) @ Matrix.Rotation(math.pi / 2, 4, "X")
    collection_of(context).objects.link(camera)
    if scene.camera is not None and not own:
        return camera
    # Footage that was seen through the scene's camera is seen through the same camera afterwards.
    for ob in _users(scene):
        if ob.rototoon.plane == "CAMERA" and ob.rototoon.camera is None and not guard.refusal(ob, guard.SETTINGS):
            ob.rototoon.camera = scene.camera
    scene.camera = camera
    return camera


def _is_free(camera, shot: Shot) -> bool:
    """Whether a camera can show footage without a change of what it was made for: it shows no other picture and does not move.

    The camera of Blender's new file is free too, but it looks down at a slant. Footage is easier to draw on from the front.
    """
    data = camera.data
    if _is_default(camera):
        return False
    if camera.library is not None or data.library is not None or data.type not in {"PERSP", "ORTHO"}:
        return False
    if camera.parent is not None or len(camera.constraints) or camera.animation_data is not None:
        return False
    wanted = os.path.normpath(footage.picture(shot.pattern, shot.first))
    for entry in data.background_images:
        image = entry.image if entry.source == "IMAGE" else entry.clip
        if image is not None and os.path.normpath(bpy.path.abspath(image.filepath)) != wanted:
            return False
    return data.animation_data is None


DEFAULT_CAMERA = (7.35889, -6.92579, 4.95831)
"""Place of the camera that a new file of Blender contains."""


def _is_default(camera) -> bool:
    place = camera.matrix_world.translation
    return camera.name == "Camera" and max(abs(a - b) for a, b in zip(place, DEFAULT_CAMERA)) < 1e-4


CUBE = 24.0
"""Sum of the absolute coordinates of the cube that a new file of Blender contains."""


def hide_default_cube(scene) -> bool:
    """Hides the cube of Blender's new file, which stands between the camera and the footage. Returns whether it was there.

    A cube that somebody has moved, scaled, edited or animated stays as it is.
    """
    cube = scene.objects.get("Cube")
    if cube is None or not cube.visible_get() or not _is_default_cube(cube):
        return False
    cube.hide_set(True)
    cube.hide_render = True
    return True


def _is_default_cube(ob) -> bool:
    if ob.name != "Cube" or ob.type != "MESH" or ob.library is not None:
        return False
    corners = ob.data.vertices
    untouched = len(corners) == 8 and abs(sum(abs(x) for v in corners for x in v.co) - CUBE) < 1e-4
    touched = len(ob.modifiers) or ob.animation_data is not None or ob.parent is not None or ob.children
    return untouched and not touched and ob.matrix_world == Matrix.Identity(4)


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
    shown = camera.data.background_images
    entry = next((e for e in shown if e.source == "IMAGE" and e.image in {image, None}), None)
    if entry is None:
        entry = shown.new()
    if entry.image is None:
        entry.image, entry.frame_method, entry.alpha = image, "FIT", 1.0
    _time(entry.image_user, shot)


def need_shown(ob) -> None:
    """Raises a `Problem` if what shows an object's footage belongs to another file, so that it cannot show other footage."""
    block = _shower(ob)
    if block is not None:
        guard.need_own(block)


def show_instead(ob, shot: Shot) -> None:
    """Shows other footage where an object's footage is to be seen, in the same place of the background or reference image. To be called while the object
    has the old footage still."""
    block = _shower(ob)
    if block is None:
        return
    if block == ob.rototoon.reference:
        x, y = block.data.display_aspect if block.data is not None else (1.0, 1.0)
        block.data = _shaped(load_sequence(shot), x / y)
        _time(block.image_user, shot)
        return
    entry = placement.background_of(placement.camera_of(ob), ob)
    image = _shaped(load_sequence(shot), footage.pixel_aspect(entry))
    entry.source, entry.image = "IMAGE", image
    _time(entry.image_user, shot)


def _shaped(image, pixel_aspect: float):
    """An image, its pixels of the shape of those that it replaces, unless it has a shape of its own."""
    if tuple(image.display_aspect) == (1.0, 1.0):
        image.display_aspect = (pixel_aspect, 1.0) if pixel_aspect > 1.0 else (1.0, 1.0 / pixel_aspect)
    return image


def _shower(ob) -> bpy.types.ID | None:
    """The reference image, or the data of the camera that shows an object's footage; `None` if it is not to be seen."""
    if ob.rototoon.plane == "REFERENCE":
        return ob.rototoon.reference
    camera = placement.camera_of(ob)
    return None if camera is None or placement.background_of(camera, ob) is None else camera.data


def _reference(context, shot: Shot, name: str):
    empty = bpy.data.objects.new(f"{name} footage", None)
    empty.empty_display_type = "IMAGE"
    empty.data = load_sequence(shot)
    _time(empty.image_user, shot)
    empty.empty_display_size = WIDTH
    empty.empty_image_offset = (-0.5, -0.5)
    # A little behind the drawing plane, so that strokes are visible.
    empty.matrix_world = Matrix.Translation((0, 0.001, 0)) @ Matrix.Rotation(math.pi / 2, 4, "X")
    collection_of(context).objects.link(empty)
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

"""The mapping between pixels and layer points on each frame, from an object's settings.

If the camera and the object do not move, one mapping serves all frames. Otherwise the scene is set to each frame and back.
"""

from __future__ import annotations

import os
from collections.abc import Iterable

import bpy
import numpy as np

from . import camera as cameras
from . import footage, hierarchy, world
from . import grease_pencil as gp
from .errors import Problem
from .frames import kept

NO_CAMERA = "The scene has no camera: add one, or choose one in the panel Footage"


class Mapper:
    """Mappings of an object's layers on some frames."""

    def __init__(
        self, ob: bpy.types.Object, frames: Iterable[int], points: dict[int, np.ndarray], names: list[str], size: tuple[int, int] | None = None
    ):
        """`names` are the layers; one that does not exist yet is where the object is. `points` are the artist's points by layer index; they show the
        plane on which the artist drew. `size` is that of the picture where there is no footage."""
        self._mappings: dict[tuple[int, int | None], cameras.Mapping] = {}
        self._ob, self._points, self._names, self._size, self._frames = ob, points, names, size, set()
        layers = [gp.find_layer(ob, name) for name in names]
        self._moves = moves(ob, layers)
        if not self._moves:
            self._add(ob, layers, None)
        self.extend(frames)

    def extend(self, frames: Iterable[int]) -> None:
        """Adds frames. Where nothing moves they are known already."""
        new = set(frames) - self._frames
        if not self._moves or not new:
            return
        layers, scene = [gp.find_layer(self._ob, name) for name in self._names], bpy.context.scene
        with kept(scene):
            for frame in sorted(new):
                scene.frame_set(frame)
                self._add(self._ob, layers, frame)
        self._frames |= new

    def at(self, layer: int, frame: int) -> cameras.Mapping:
        """The mapping of a layer on a scene frame."""
        return self._mappings[layer, frame if self._moves else None]

    @property
    def still(self) -> bool:
        """Whether all frames share one mapping."""
        return not self._moves

    def _add(self, ob, layers, frame: int | None) -> None:
        view = view_of(ob, self._size)
        for index, layer in enumerate(layers):
            matrix = cameras.need_size(ob, cameras.layer_to_world(ob, layer))
            # The view's z axis in layer space: the normal of a plane that faces the view.
            normal = (view.to_view @ matrix)[2, :3]
            normal = normal / np.linalg.norm(normal)
            plane = cameras.plane_of(self._points.get(index, np.zeros((0, 3))), normal)
            self._mappings[index, frame] = cameras.Mapping(view, matrix, plane, cameras.radius_of(ob))


def view_of(ob: bpy.types.Object, size: tuple[int, int] | None = None) -> cameras.View:
    """The view of an object's footage on the current frame. `size` is that of the picture where there is no footage."""
    settings = ob.rototoon
    width, height = size or (settings.width, settings.height)
    if not width or not height:
        raise Problem("No footage chosen: choose it in the panel Footage")
    if settings.plane == "REFERENCE":
        empty = settings.reference
        if empty is None or empty.empty_display_type != "IMAGE":
            raise Problem("No reference image chosen: choose the empty that shows the footage")
        return cameras.reference_view(empty, width, height)
    found = camera_of(ob)
    if found is None:
        raise Problem(NO_CAMERA)
    return cameras.camera_view(bpy.context.scene, found, width, height, placement_in(found, ob))


def camera_of(ob: bpy.types.Object) -> bpy.types.Object | None:
    """The camera that shows the footage."""
    return ob.rototoon.camera or bpy.context.scene.camera


def placement_in(camera: bpy.types.Object, ob: bpy.types.Object) -> cameras.Placement:
    """The placement of the camera's background image that has the object's footage; the default, which fits, if there is none. Without footage it is that
    of the rendered picture, which is the frame."""
    entry = background_of(camera, ob)
    if entry is None:
        return cameras.Placement() if ob.rototoon.pattern else cameras.RENDERED
    return cameras.Placement(
        entry.frame_method,
        tuple(entry.offset),
        entry.rotation,
        entry.scale,
        entry.use_flip_x,
        entry.use_flip_y,
        footage.pixel_aspect(entry),
    )


def background_of(camera: bpy.types.Object, ob: bpy.types.Object) -> bpy.types.CameraBackgroundImage | None:
    """The camera's background image that has the object's footage, shown or not; `None` if there is none."""
    return next((entry for source, entry in footage.backgrounds(camera) if _shows(source, ob)), None)


def _shows(source: footage.Source, ob: bpy.types.Object) -> bool:
    settings = ob.rototoon
    if source.movie:
        return bool(settings.movie) and footage.absolute(ob, settings.movie) == os.path.normpath(source.path)
    number = footage.number_of(source.path)
    if number is None or not settings.pattern:
        return False
    try:
        return footage.picture(footage.absolute(ob, settings.pattern), number) == os.path.normpath(source.path)
    except Problem:
        # Text that a person typed: what needs the footage says so.
        return False


def moves(ob: bpy.types.Object, layers) -> bool:
    """Whether the object, a layer or its parent, or the camera or reference image can move, or the scene goes to another camera.

    A layer that does not exist yet is `None`.
    """
    settings, scene = ob.rototoon, bpy.context.scene
    there = [layer for layer in layers if layer is not None]
    through_camera = settings.plane != "REFERENCE"
    shows = camera_of(ob) if through_camera else settings.reference
    if is_animated(ob) or is_animated(shows) or any(is_animated(layer.parent, carries=True) for layer in there):
        return True
    if any(hierarchy.is_animated(ob, layer.name) for layer in there):
        return True
    return through_camera and (settings.camera is None or not settings.width) and _changes_camera(scene)


def _changes_camera(scene: bpy.types.Scene) -> bool:
    """Whether markers on the timeline give the scene another camera on some frames."""
    return any(marker.camera not in (None, scene.camera) for marker in scene.timeline_markers)


def is_animated(ob: bpy.types.Object | None, carries: bool = False) -> bool:
    """Whether an object or one of its parents can move. With `carries`, the object is a parent itself."""
    by_points = False
    while ob is not None:
        if world.has_own_motion(ob) or (carries and _moves_children(ob, by_points)):
            return True
        by_points = ob.parent_type.startswith("VERTEX")
        ob, carries = ob.parent, True
    return False


def may_part(ob: bpy.types.Object, layer, other) -> bool:
    """Whether a layer can move against another one, which may be `None`: a new one."""
    there = [each for each in (layer, other) if each is not None]
    carriers = {(each.parent, each.parent_bone) for each in there} | ({(None, "")} if other is None else set())
    carried = len(carriers) > 1 and (is_animated(ob) or any(is_animated(each.parent, carries=True) for each in there))
    return carried or any(hierarchy.is_animated(ob, each.name) for each in there)


def _moves_children(ob: bpy.types.Object, by_points: bool) -> bool:
    """Whether what an object carries can move though the object stays: with its bones, along it, or with its points."""
    if ob.type == "ARMATURE":
        return world.has_animation(ob.data) or any(len(bone.constraints) for bone in ob.pose.bones)
    if by_points or (ob.type == "CURVE" and ob.data.use_path):
        return world.has_animation(ob.data) or world.has_animation(getattr(ob.data, "shape_keys", None)) or len(ob.modifiers) > 0
    return False

"""Trace Image: a reference image as strokes."""

import os
import shutil
import tempfile

import bpy
import numpy as np

from ...blender import camera as cameras
from ...blender import footage, guard, preferences, world
from ...blender import grease_pencil as gp
from ...blender.errors import Problem
from ...capture.operators.footage_from_reference import reference_image
from ...common.operators import Long, OnDrawing
from .. import drawings as dr
from .. import plan as pl
from .. import properties, run, tracing

LIFT = 1e-3
"""Distance of the strokes from the image in scene units, so that they are seen."""


class ROTOTOON_OT_trace_image(Long, OnDrawing, bpy.types.Operator):
    bl_idname = "rototoon.trace_image"
    bl_label = "Trace Image"
    bl_description = (
        "Turn the lines of the selected reference image (an empty that shows an image) into strokes on the current frame, where the "
        "image is. No footage is needed"
    )
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        if not super().poll(context):
            return False
        if reference_image(context) is None:
            cls.poll_message_set("Select the reference image together with the Grease Pencil object")
            return False
        return True

    def begin(self, context):
        self._ob, frame = context.object, context.scene.frame_current
        settings = self._ob.rototoon
        empty, self._home = reference_image(context), settings.lines_layer
        guard.need_apart(self._ob, [self._home])
        (layer,) = dr.read(self._ob, [self._home])
        if frame in layer.kept:
            raise Problem(f"There is a drawing of yours on frame {frame} already: go to another frame")
        self._folder = tempfile.mkdtemp(prefix="rototoon-")
        try:
            path, size = _copied(empty, frame, self._folder)
        except (OSError, RuntimeError) as error:
            self._tidy()
            raise Problem(f'Cannot read the image of "{empty.name}": {error}') from error
        except Problem:
            self._tidy()
            raise
        self._plan = pl.of_picture(layer, frame, path, size, _Still(self._ob, empty, self._home, size))
        chosen = settings.line_style.lower(), settings.line_sensitivity, preferences.threads(), properties.left_out_of_lines(settings)
        options = tracing.Options(*chosen)
        return tracing.worker(self._plan, options, self._tidy)

    def _tidy(self) -> None:
        shutil.rmtree(self._folder, ignore_errors=True)

    def finish(self, _context, work):
        done = yield from tracing.finishing(self._ob, self._plan, work.result, self._home)
        return run.told(done)


class _Still:
    """The mapping through a reference image, the same on all frames."""

    still = True

    def __init__(self, ob, empty, name: str, size: tuple[int, int]):
        matrix = cameras.need_size(ob, cameras.layer_to_world(ob, gp.find_layer(ob, name)))
        inverse, board = np.linalg.inv(matrix), np.array(world.matrix_of(empty), np.float64)
        normal = board[:3, 2] / np.linalg.norm(board[:3, 2])
        point = inverse @ np.append(board[:3, 3] + LIFT * normal, 1.0)
        # A normal goes with the transposed matrix.
        own = matrix[:3, :3].T @ normal
        self._mapping = cameras.Mapping(cameras.reference_view(empty, *size), matrix, (point[:3], own / np.linalg.norm(own)), cameras.radius_of(ob))

    def at(self, _layer: int, _frame: int) -> cameras.Mapping:
        """The mapping."""
        return self._mapping


def _copied(empty, frame: int, folder: str) -> tuple[str, tuple[int, int]]:
    """Copies the picture that an empty shows to a file whose name is a pattern, and gives the pattern and the size."""
    image = empty.data
    if image is None or image.source in {"MOVIE", "VIEWER", "TILED"}:
        raise Problem(f'"{empty.name}" shows no still image: take the movie as footage, with Footage from Reference Image')
    drawn_on = image.is_dirty and image.source == "FILE"
    if drawn_on or image.packed_file is not None or image.source == "GENERATED" or not image.filepath:
        suffix, target = ".png", os.path.join(folder, "picture_1.png")
        # A copy of an image has not what was drawn on it since it was saved.
        copy = _of_pixels(image) if drawn_on or image.source == "GENERATED" else image.copy()
        try:
            copy.file_format = "PNG"
            copy.save(filepath=target)
        finally:
            bpy.data.images.remove(copy)
    else:
        source = _shown(empty, image, frame)
        suffix = os.path.splitext(source)[1].lower()
        target = os.path.join(folder, "picture_1" + suffix)
        shutil.copyfile(source, target)
    return os.path.join(folder, "picture_%d" + suffix), footage.size_of(target)


def _of_pixels(image) -> bpy.types.Image:
    """A new image with the pixels that an image has now. Raises a `Problem` if it has none."""
    pixels = np.empty(len(image.pixels), np.float32)
    width, height = image.size
    if not len(pixels):
        raise Problem(f'The image "{image.name}" has no pixels: save it, or load it anew')
    image.pixels.foreach_get(pixels)
    found = bpy.data.images.new("Rototoon", width, height, alpha=True, float_buffer=image.is_float)
    found.colorspace_settings.name = image.colorspace_settings.name
    rgba = np.ones((height * width, 4), np.float32)
    channels = len(pixels) // max(height * width, 1)
    if channels < 3:
        rgba[:, :3] = pixels.reshape(-1, channels)[:, :1]
    else:
        rgba[:, :channels] = pixels.reshape(-1, channels)
    found.pixels.foreach_set(rgba.ravel())
    return found


def _shown(empty, image, frame: int) -> str:
    """The file that an empty shows on a frame."""
    path = bpy.path.abspath(image.filepath, library=image.library)
    if image.source != "SEQUENCE":
        return path
    sequence = footage.sequence_around(path)
    user = empty.image_user
    number = frame - user.frame_start + 1 + user.frame_offset
    return footage.picture(sequence.pattern, min(max(number, sequence.first), sequence.last))


CLASSES = (ROTOTOON_OT_trace_image,)

"""Footage pixels ↔ points on the drawing plane, through a camera or a reference image. Only this module converts them.

A view is a coordinate system in the world with a picture plane, coordinates (u, v) on that plane, and rays. Through a
perspective camera, the rays meet in the origin and the picture plane is at distance 1. Through an orthographic camera or a
reference image, they run along -z. An affine map takes (u, v) to footage pixels. All steps can be inverted: a pixel goes to
the drawing plane and back to the same pixel. The computation is in double precision; Blender's settings are in single precision.

Footage pixels: x right, y down, origin at the outer top-left corner of the picture.

The camera's frame follows Blender's rules. The side that the sensor fits (auto: the longer side after pixel aspect) measures
`sensor_width` or `sensor_height`, and shift is in units of that side. The settings of a camera background image say where
the footage is in the frame (stretch, fit, crop, offset, rotation, scale, flips).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from . import world
from .errors import Problem


@dataclass(frozen=True)
class Placement:
    """Where footage is in a camera's frame: the settings of a camera background image, and the shape of its pixels."""

    method: str = "FIT"
    offset: tuple[float, float] = (0.0, 0.0)
    rotation: float = 0.0
    scale: float = 1.0
    flip_x: bool = False
    flip_y: bool = False
    pixel_aspect: float = 1.0
    """Width of a pixel of the footage by its height."""


RENDERED = Placement("STRETCH")
"""The picture that the scene renders fills the frame, whatever the shape of its pixels."""


@dataclass(frozen=True)
class View:
    """The rays of the footage's pixels."""

    to_view: np.ndarray
    """World to view, 4×4."""
    perspective: bool
    to_pixel: np.ndarray
    """(u, v, 1) to footage pixels, 2×3."""


class Mapping:
    """Mapping between footage pixels and layer points on one frame."""

    def __init__(
        self, view: View, layer_to_world: np.ndarray, plane: tuple[np.ndarray, np.ndarray] | None = None, radius: float | None = None
    ):
        """`plane` is a point and a normal in layer space. The default is the layer's XZ plane, Blender's front view. `radius` is how large a radius of 1
        is in the world (`radius_of`); without it, as large as lengths in the layer."""
        self.view = view
        self._linear = layer_to_world[:3, :3] / (_mean_scale(layer_to_world) if radius is None else radius)
        self.to_view = view.to_view @ layer_to_world
        self.from_view = np.linalg.inv(self.to_view)
        self.point, self.normal = plane or (np.zeros(3), np.array([0.0, 1.0, 0.0]))
        self.linear_inverse = np.linalg.inv(view.to_pixel[:, :2])

    def to_pixels(self, points: np.ndarray) -> np.ndarray:
        """Layer points (..., 3) to pixels (..., 2)."""
        points = np.asarray(points, np.float64)
        local = points @ self.to_view[:3, :3].T + self.to_view[:3, 3]
        uv = local[..., :2]
        if self.view.perspective:
            depth = -local[..., 2:]
            if (depth <= 0).any():
                raise Problem("Some strokes lie behind the camera: move them in front of it, or choose another camera")
            uv = uv / depth
        return uv @ self.view.to_pixel[:, :2].T + self.view.to_pixel[:, 2]

    def to_layer(self, pixels: np.ndarray) -> np.ndarray:
        """Pixels (..., 2) to points (..., 3) of the drawing plane in layer space."""
        pixels = np.asarray(pixels, np.float64)
        rotation, shift = self.from_view[:3, :3], self.from_view[:3, 3]
        # With the pixel moves the ray's direction (perspective camera) or the ray's start (all others).
        linear = self.linear_inverse.T @ rotation[:, :2].T
        start = -self.view.to_pixel[:, 2] @ linear
        moving = pixels @ linear
        if self.view.perspective:
            moving += start - rotation[:, 2]
            along = moving @ self.normal
            self._refuse_edge_on(along, moving)
            moving *= (((self.point - shift) @ self.normal) / along)[..., None]
            moving += shift
            return moving
        direction = -rotation[:, 2]
        along = np.asarray(direction @ self.normal)
        self._refuse_edge_on(along, direction)
        moving += start + shift
        moving += direction * (((self.point - moving) @ self.normal) / along)[..., None]
        return moving

    def radii(self, pixels: np.ndarray, half: np.ndarray | float) -> np.ndarray:
        """The radii of lines through pixels (..., 2) that go `half` so many pixels to each side."""
        pixels = np.asarray(pixels, np.float64)
        beside = pixels + np.stack([half + 0 * pixels[..., 0], 0 * pixels[..., 0]], -1)
        return np.linalg.norm((self.to_layer(beside) - self.to_layer(pixels)) @ self._linear.T, axis=-1)

    def _refuse_edge_on(self, along: np.ndarray, direction: np.ndarray) -> None:
        # The norm of every direction would cost more than everything else here. The largest coordinate is a bound for all.
        bound = 2.0 * np.abs(direction).max(initial=0.0)
        if along.size and np.abs(along).min() > 1e-9 * bound:
            return
        if (np.abs(along) <= 1e-9 * np.linalg.norm(direction, axis=-1)).any():
            raise Problem("The drawing plane is seen edge-on: turn the Grease Pencil object towards the camera")


def radius_of(ob) -> float:
    """How large a stroke's radius of 1 is in the world: Blender scales it with the object, and not with the layer."""
    return _mean_scale(np.array(world.matrix_of(ob), np.float64))


def _mean_scale(matrix: np.ndarray) -> float:
    """The scale of a matrix as Blender takes it for widths: that of the diagonal."""
    return float(np.linalg.norm(matrix[:3, :3].sum(1)) / math.sqrt(3))


def plane_of(points: np.ndarray, view_normal: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The plane on which an artist drew `points` (N, 3) in layer space: a point and a normal.

    Blender draws on the XZ plane (front), or on the plane through the object's origin that faces the view. If the points lie on
    one of these, it is taken exactly. Otherwise it is the plane that fits the points best. If the points lie on a line, it is the
    plane through their mean that faces the view. Points without a place show nothing.
    """
    front = np.zeros(3), np.array([0.0, 1.0, 0.0])
    points = np.asarray(points, np.float64)
    points = points[np.isfinite(points).all(1)]
    if not len(points):
        return front
    mean = points.mean(0)
    spread = points - mean
    extent = np.abs(spread).max()
    tolerance = max(1e-4 * extent, 1e-7)
    for point, normal in (front, (np.zeros(3), view_normal)):
        if np.abs((points - point) @ normal).max() <= tolerance:
            return point, normal
    _, sizes, axes = np.linalg.svd(spread[:: max(len(spread) // 4096, 1)], full_matrices=False)
    if len(sizes) < 3 or sizes[1] <= 1e-3 * sizes[0] or abs(axes[2] @ view_normal) < 0.05:
        return mean, view_normal
    return mean, axes[2]


def camera_view(scene, camera, width: int, height: int, placement: Placement) -> View:
    """The view through a camera whose frame shows footage of `width` × `height` pixels at `placement`."""
    data = camera.data
    if data.type not in {"PERSP", "ORTHO"}:
        raise Problem(f'Camera "{camera.name}" is of type {data.type}: only perspective and orthographic cameras can be used')
    left, bottom, frame_width, frame_height = camera_frame(scene.render, data)
    image = width * placement.pixel_aspect / height
    half = _frame_half_size(placement.method, image, frame_width, frame_height)
    half *= placement.scale * np.array([-1 if placement.flip_x else 1, -1 if placement.flip_y else 1])
    centre = np.array([left + frame_width / 2, bottom + frame_height / 2])
    centre += _frame_offset(placement.offset, data, image, frame_width, frame_height)
    cos, sin = math.cos(-placement.rotation), math.sin(-placement.rotation)
    turn = np.array([[cos, -sin], [sin, cos]])
    # Pixel to (u, v): to -1..1 with y up, then scale, rotation, offset.
    unit = np.array([[2 / width, 0, -1], [0, -2 / height, 1], [0, 0, 1]])
    place = np.eye(3)
    place[:2, :2] = turn * half
    place[:2, 2] = centre
    matrix = np.array(world.matrix_of(camera).normalized(), np.float64)
    if not np.linalg.det(place):
        raise Problem(f'The footage in the background of "{camera.name}" has a scale of 0: set the scale of the background image to 1')
    return View(_inverse(matrix, camera), data.type == "PERSP", np.linalg.inv(place @ unit)[:2])


def camera_frame(render, data) -> tuple[float, float, float, float]:
    """Left, bottom, width and height of the frame on the picture plane (at distance 1 for perspective)."""
    width, height = render.resolution_x, render.resolution_y
    aspect = render.pixel_aspect_y / render.pixel_aspect_x
    fit = data.sensor_fit
    if fit == "AUTO":
        horizontal, sensor = width * render.pixel_aspect_x >= height * render.pixel_aspect_y, data.sensor_width
    else:
        horizontal = fit == "HORIZONTAL"
        sensor = data.sensor_width if horizontal else data.sensor_height
    side = width if horizontal else height * aspect
    unit = (data.ortho_scale if data.type == "ORTHO" else sensor / data.lens) / side
    left = (data.shift_x * side - width / 2) * unit
    bottom = (data.shift_y * side - height * aspect / 2) * unit
    return left, bottom, width * unit, height * aspect * unit


def _frame_half_size(method: str, image: float, width: float, height: float) -> np.ndarray:
    frame = width / height
    if method == "STRETCH":
        return np.array([width, height]) / 2
    wider = image > frame
    if (method == "FIT") == wider:
        return np.array([width, width / image]) / 2
    return np.array([height * image, height]) / 2


def _frame_offset(offset, data, image: float, width: float, height: float) -> np.ndarray:
    """The offset of a background image in units of the picture plane, by Blender's rule.

    Blender measures the offset in units of the side that the sensor fits.
    """
    frame = width / height
    unit = {"AUTO": max(width, height), "HORIZONTAL": width, "VERTICAL": height}[data.sensor_fit]
    x = offset[0] * unit * min(1.0, frame)
    y = offset[1] * unit / (max(1.0, frame) * (image / frame))
    return np.array([x, y])


def reference_view(empty, width: int, height: int) -> View:
    """The view of a reference image. Rays run along the image's normal. Pixels are where the empty shows them."""
    image = empty.data
    aspect_x, aspect_y = image.display_aspect if image is not None else (1.0, 1.0)
    shown_width, shown_height = width * aspect_x, height * aspect_y
    unit = empty.empty_display_size / max(shown_width, shown_height)
    offset = empty.empty_image_offset
    place = np.array(
        [
            [unit * aspect_x, 0, unit * shown_width * offset[0]],
            [0, -unit * aspect_y, unit * shown_height * (1 + offset[1])],
            [0, 0, 1],
        ]
    )
    matrix = np.array(world.matrix_of(empty), np.float64)
    if not np.linalg.det(place):
        raise Problem(f'The image of "{empty.name}" has a size of 0: set its size to 1')
    return View(_inverse(matrix, empty), False, np.linalg.inv(place)[:2])


def _inverse(matrix: np.ndarray, ob) -> np.ndarray:
    """The inverse of an object's matrix."""
    if not np.linalg.det(matrix[:3, :3]):
        raise Problem(f'"{ob.name}", or what it hangs on, has a scale of 0: set the scale to 1')
    return np.linalg.inv(matrix)


def need_size(ob, matrix: np.ndarray) -> np.ndarray:
    """A matrix (4×4) that places drawings of an object, if it has an inverse. Otherwise raises a `Problem`."""
    if not np.linalg.det(matrix[:3, :3]):
        raise Problem(f'"{ob.name}", or what it or its layer hangs on, has a scale of 0: set the scale to 1')
    return matrix


def layer_to_world(ob, layer) -> np.ndarray:
    """4×4: a layer's points to the world. The layer's parent counts. `None` is a layer that does not exist yet."""
    if layer is None:
        return np.array(world.matrix_of(ob), np.float64)
    parent = layer.parent
    base = world.matrix_of(ob if parent is None else parent)
    if parent is not None:
        if parent.type == "ARMATURE" and layer.parent_bone in parent.pose.bones:
            base = base @ parent.pose.bones[layer.parent_bone].matrix
        base = base @ layer.matrix_parent_inverse
    return np.array(base, np.float64) @ np.array(layer.matrix_local, np.float64)

"""Pixels and the drawing plane: there and back, and as Blender itself sees it."""

import math

import bpy
import numpy as np
import pytest
from bpy_extras.object_utils import world_to_camera_view
from mathutils import Matrix, Vector

WIDTH, HEIGHT = 960, 540


def camera(kind="PERSP", shift=(0.0, 0.0), fit="AUTO"):
    data = bpy.data.cameras.new("camera")
    data.type, data.lens, data.ortho_scale = kind, 42.0, 7.3
    data.shift_x, data.shift_y, data.sensor_fit = *shift, fit
    data.sensor_width, data.sensor_height = 32.0, 20.0
    ob = bpy.data.objects.new("camera", data)
    bpy.context.scene.collection.objects.link(ob)
    ob.matrix_world = Matrix.Translation((1.5, -9.0, 2.0)) @ Matrix.Rotation(1.45, 4, "X") @ Matrix.Rotation(0.2, 4, "Y")
    ob.scale = (2.0, 2.0, 2.0)
    bpy.context.scene.camera = ob
    bpy.context.view_layer.update()
    return ob


CASES = [
    ("PERSP", (0, 0), "AUTO", (1, 1), (960, 540)),
    ("PERSP", (0.13, -0.21), "AUTO", (1, 1), (960, 540)),
    ("PERSP", (0.13, -0.21), "VERTICAL", (1, 1), (960, 540)),
    ("PERSP", (0.05, 0.1), "HORIZONTAL", (1, 1.5), (500, 700)),
    ("PERSP", (0.05, 0.1), "AUTO", (2, 1), (500, 700)),
    ("ORTHO", (0, 0), "AUTO", (1, 1), (960, 540)),
    ("ORTHO", (-0.3, 0.2), "VERTICAL", (1, 1.2), (960, 540)),
    ("ORTHO", (-0.3, 0.2), "AUTO", (1.3, 1), (540, 960)),
]


@pytest.mark.parametrize(("kind", "shift", "fit", "aspect", "size"), CASES)
def test_agrees_with_blender_and_returns(addon, kind, shift, fit, aspect, size):
    cameras = addon("blender.camera")
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.render.pixel_aspect_x, scene.render.pixel_aspect_y = aspect
    ob = camera(kind, shift, fit)
    view = cameras.camera_view(scene, ob, WIDTH, HEIGHT, cameras.Placement(method="STRETCH"))
    turn = np.array(Matrix.Translation((0.2, 0.3, 0.1)) @ Matrix.Rotation(0.3, 4, "Z"))
    mapping = cameras.Mapping(view, turn)
    grid = np.stack(np.meshgrid(np.linspace(-50, 1010, 9), np.linspace(-40, 600, 9)), -1).reshape(-1, 2)
    points = mapping.to_layer(grid)
    assert np.abs(points[:, 1]).max() < 1e-9
    assert np.abs(mapping.to_pixels(points) - grid).max() < 1e-9
    single = mapping.to_pixels(points.astype(np.float32))
    assert np.abs(single - grid).max() < 1e-3
    for point, pixel in zip(points, grid):
        seen = world_to_camera_view(scene, ob, Matrix(turn.tolist()) @ Vector(point))
        assert abs(seen.x * WIDTH - pixel[0]) < 1e-3 * 2
        assert abs((1 - seen.y) * HEIGHT - pixel[1]) < 1e-3 * 2


def test_background_placement_keeps_shape(addon):
    cameras = addon("blender.camera")
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = 1000, 500
    ob = camera("ORTHO")
    ob.matrix_world = Matrix.Rotation(math.pi / 2, 4, "X")
    ob.data.ortho_scale = 10
    bpy.context.view_layer.update()

    def at(placement, pixel):
        mapping = cameras.Mapping(cameras.camera_view(scene, ob, 400, 400, placement), np.eye(4))
        return mapping.to_layer(np.array([pixel], float))[0, [0, 2]]

    # A square picture in a frame of 10 by 5: fitted it is 5 by 5, cropped 10 by 10, stretched 10 by 5.
    assert at(cameras.Placement("FIT"), (400, 0)) == pytest.approx([2.5, 2.5])
    assert at(cameras.Placement("CROP"), (400, 0)) == pytest.approx([5, 5])
    assert at(cameras.Placement("STRETCH"), (400, 0)) == pytest.approx([5, 2.5])
    assert at(cameras.Placement("FIT", flip_x=True), (400, 0)) == pytest.approx([-2.5, 2.5])
    assert at(cameras.Placement("FIT", scale=2.0), (400, 0)) == pytest.approx([5, 5])
    # Blender turns background images clockwise for positive angles.
    assert at(cameras.Placement("FIT", rotation=math.pi / 2), (400, 0)) == pytest.approx([2.5, -2.5])
    # One unit of offset is the fitted side; upwards it is measured in picture heights.
    assert at(cameras.Placement("FIT", offset=(0.1, 0.0)), (200, 200)) == pytest.approx([1.0, 0.0])
    assert at(cameras.Placement("FIT", offset=(0.0, 0.1)), (200, 200)) == pytest.approx([0.0, 1.0])
    # Pixels that are twice as wide as high make it a picture of two to one.
    assert at(cameras.Placement("FIT", pixel_aspect=2.0), (400, 0)) == pytest.approx([5, 2.5])
    assert at(cameras.Placement("CROP", pixel_aspect=4.0), (400, 0)) == pytest.approx([10, 2.5])
    assert at(cameras.Placement("FIT", offset=(0.0, 0.1), pixel_aspect=2.0), (200, 200)) == pytest.approx([0.0, 0.5])


def test_reference_image(addon, tmp_path):
    cameras = addon("blender.camera")
    image = bpy.data.images.new("picture", 200, 100)
    empty = bpy.data.objects.new("reference", None)
    bpy.context.scene.collection.objects.link(empty)
    empty.empty_display_type, empty.data, empty.empty_display_size = "IMAGE", image, 4.0
    empty.empty_image_offset = (-0.5, 0.0)
    empty.matrix_world = Matrix.Translation((1, 2, 3)) @ Matrix.Rotation(math.pi / 2, 4, "X")
    bpy.context.view_layer.update()
    mapping = cameras.Mapping(cameras.reference_view(empty, 200, 100), np.eye(4))
    # Four units wide and two high, standing on its origin.
    corners = mapping.to_layer(np.array([[0.0, 0.0], [200.0, 100.0]]))
    assert corners == pytest.approx(np.array([[-1.0, 0.0, 5.0], [3.0, 0.0, 3.0]]), abs=1e-6)
    assert mapping.to_pixels(corners) == pytest.approx(np.array([[0.0, 0.0], [200.0, 100.0]]), abs=1e-4)


def test_plane_of_what_was_drawn(addon):
    plane_of = addon("blender.camera").plane_of
    view = np.array([0.0, -0.6, 0.8])
    rng = np.random.default_rng(3)
    flat = rng.normal(size=(40, 3)) * (1, 0, 1)
    point, normal = plane_of(flat, view)
    assert np.array_equal(normal, (0, 1, 0)) and np.array_equal(point, (0, 0, 0))
    tilted = flat @ np.array(Matrix.Rotation(0.4, 3, "X")).T + (0.1, 0.2, 0.3)
    point, normal = plane_of(tilted, view)
    assert np.abs((tilted - point) @ normal).max() < 1e-9


def test_behind_the_camera_is_an_error(addon):
    cameras = addon("blender.camera")
    ob = camera()
    view = cameras.camera_view(bpy.context.scene, ob, WIDTH, HEIGHT, cameras.Placement())
    behind = np.array(ob.matrix_world.normalized() @ Vector((0, 0, 1)))
    with pytest.raises(addon("blender.errors").Problem, match="behind the camera"):
        cameras.Mapping(view, np.eye(4)).to_pixels(behind[None])

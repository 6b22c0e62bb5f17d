"""Drawings on other planes than the front view: a floor plan in XY, a side view in YZ, and planes that are tilted a little."""

import bpy
import numpy as np
import pytest
from test_strokes import add, circle, content, drawing, drawing_object

pytestmark = pytest.mark.usefixtures("library")

ABOUT_X = np.array([[1, 0, 0], [0, np.cos(0.01), -np.sin(0.01)], [0, np.sin(0.01), np.cos(0.01)]])
PLANES = {
    # Each takes (x, 0, z) of the front view to its plane.
    "XZ": np.eye(3),
    "XY": np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]]),
    "YZ": np.array([[0, -1.0, 0], [1, 0, 0], [0, 0, 1]]),
    "nearly XY": ABOUT_X @ np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]]),
}


def put_on(addon, ob, frame, to, by=(0.0, 0.0, 0.0), layer="Lines"):
    """Takes a drawing from the front view to another plane."""
    gp = addon("blender.grease_pencil")
    handle = drawing(addon, ob, layer, frame)
    gp.put(handle, "position", gp.positions(handle, int(gp.offsets(handle)[-1])) @ to.T + by)


def blade(angle, centre=(0.0, 0.0), length=1.0):
    share = np.linspace(0, length, 12)[:, None]
    return np.asarray(centre) + share * [np.cos(angle), np.sin(angle)]


def in_between(addon, shapes, to, by=(0.0, 0.0, 0.0)):
    """Positions on frame 5, back in the front view, of in-betweens of `shapes` on two keys."""
    ob = drawing_object(addon)
    for frame, drawn in zip((1, 9), shapes):
        add(addon, ob, "Lines", frame, drawn)
        put_on(addon, ob, frame, to, by)
    assert bpy.ops.rototoon.in_between(spacing="LINEAR") == {"FINISHED"}
    return (content(addon, ob, "Lines", 5).point["position"] - by) @ to


SCENES = {
    "scissors": ([blade(0.0), blade(2.0)], [blade(1.2, (1, 0.3)), blade(3.2, (1, 0.3))]),
    "a stick that turns": ([blade(0.3)], [blade(1.4)]),
    "an upright stick that turns": ([blade(np.pi / 2)], [blade(0.4)]),
    "a stick that slides along itself": ([blade(0.3)], [blade(0.3, (2 * np.cos(0.3), 2 * np.sin(0.3)))]),
    "a dot that moves": ([[(0.0, 0.0)]], [[(2.0, 1.0)]]),
}


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("plane", [name for name in PLANES if name != "XZ"])
def test_in_betweens_are_the_same_on_every_plane(addon, scene, plane):
    front = in_between(addon, SCENES[scene], PLANES["XZ"])
    assert np.abs(front[:, 1]).max() < 1e-5
    bpy.ops.wm.read_homefile(use_empty=True)
    there = in_between(addon, SCENES[scene], PLANES[plane], by=(3.0, -2.0, 1.0))
    # The plane is rounded to a thirty-second, and the library computes in pixels of a thousandth of the drawing.
    assert np.abs(there - front).max() < 2e-3


@pytest.mark.parametrize("plane", PLANES)
def test_fits_keep_their_tolerance_on_every_plane(addon, plane):
    ob = drawing_object(addon)
    add(addon, ob, "Lines", 1, [circle((2, 2), 1, 300)], cyclic=True)
    put_on(addon, ob, 1, PLANES[plane], by=(0.0, 0.5, 0.0))
    assert bpy.ops.rototoon.fit_strokes(tolerance=1.0) == {"FINISHED"}
    found = content(addon, ob, "Lines", 1)
    assert 3 < found.sizes[0] < 20 and found.types[0] == 3
    guides = (found.point["position"] - (0.0, 0.5, 0.0)) @ PLANES[plane]
    assert np.abs(guides[:, 1]).max() < 1e-5
    # The guiding points are near the corners of a polygon around the circle: of a hexagon, 1.155 from its centre.
    away = np.hypot(guides[:, 0] - 2, guides[:, 2] - 2)
    assert (away > 0.99).all() and (away < 1.17).all()

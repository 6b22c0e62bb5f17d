"""Fit Strokes within the tolerance: strokes across the drawing's plane, and drawings of other frames. With the real library."""

import bpy
import numpy as np
import pytest
from test_strokes import add, circle, content, drawing, drawing_object, wave

pytestmark = [pytest.mark.every_version, pytest.mark.usefixtures("library")]


def messages(addon):
    return " / ".join(each.text for each in addon("common.reports").take())


def place(addon, ob, change):
    """Changes the points of the drawing."""
    gp, handle = addon("blender.grease_pencil"), drawing(addon, ob, "Lines", 1)
    points = gp.positions(handle, int(gp.offsets(handle)[-1]))
    change(points)
    gp.put(handle, "position", points)


def farthest(addon, before, after):
    """How far each stroke is from what it became, at most."""
    lines = addon("blender.stroke_lines").lines
    one, other = lines(before), lines(after, 64)
    farthest = addon("strokes.fitting")._farthest
    return [max(farthest(a, b), farthest(b, a)) for a, b in zip(one, other)]


def _depth(points):
    """A wave in depth, which the drawing's plane shows as a line."""
    points[:400, 1] = 0.3 * np.sin(12 * points[:400, 0])


def _side(points):
    """A circle across the plane of the others."""
    points[400:800, 1], points[400:800, 0] = points[400:800, 0].copy(), 0


def _slope(points):
    """A wave on a slope."""
    points[:400, 1] = 0.7 * points[:400, 0]


@pytest.mark.parametrize("change", [_depth, _side, _slope])
def test_strokes_across_the_plane_of_a_drawing_are_fitted_in_their_own(addon, change):
    ob = drawing_object(addon)
    add(addon, ob, "Lines", 1, [np.stack([np.linspace(-1, 1, 400), np.zeros(400)], 1) if change is _depth else wave()])
    add(addon, ob, "Lines", 1, [circle((0, 0), 1, 400), circle((2, 0), 1, 400)], cyclic=True)
    place(addon, ob, change)
    before = content(addon, ob, "Lines", 1)
    bpy.ops.rototoon.fit_strokes(tolerance=0.01, unit="WORLD")
    after = content(addon, ob, "Lines", 1)
    assert (after.sizes < before.sizes / 5).all()
    assert max(farthest(addon, before, after)) < 0.0112
    assert "no plane" not in messages(addon)


def test_a_stroke_in_no_plane_is_near_its_curve_or_stays(addon):
    ob = drawing_object(addon)
    turn = np.linspace(0, 2 * np.pi, 400)
    add(addon, ob, "Lines", 1, [wave(), np.stack([np.cos(turn), np.sin(turn)], 1), np.stack([turn, 0 * turn], 1)])

    def deepen(points):
        points[400:800, 1] = 0.5 * np.sin(9 * turn)
        points[800:, 1] = np.where(np.arange(400) % 2, 0.3, -0.3)
        points[800:, 2] = 0.5 * np.sin(40 * turn)

    place(addon, ob, deepen)
    before = content(addon, ob, "Lines", 1)
    bpy.ops.rototoon.fit_strokes(tolerance=0.02, unit="WORLD")
    after = content(addon, ob, "Lines", 1)
    assert after.sizes[0] < 50 and max(farthest(addon, before, after)) < 0.0225
    stay = int((after.sizes == before.sizes).sum())
    text = messages(addon)
    assert stay == 0 or "lies in no plane and stays" in text or "lie in no plane and stay" in text


@pytest.mark.parametrize("current", [1, 50])
def test_pixels_are_those_of_each_drawings_own_frame(addon, current):
    ob = drawing_object(addon)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    bpy.context.collection.objects.link(camera)
    scene = bpy.context.scene
    scene.camera, camera.rotation_euler = camera, (np.pi / 2, 0, 0)
    x = np.linspace(-1, 1, 300)
    for frame, away in ((1, -10.0), (50, -1000.0)):
        camera.location = (0, away, 0)
        camera.keyframe_insert("location", frame=frame)
        add(addon, ob, "Lines", frame, [np.stack([x, 0.05 * np.sin(20 * x)], 1)])
    scene.frame_set(current)
    bpy.ops.rototoon.fit_strokes(frames="ALL", tolerance=1.0)
    # On the first frame the wave is 13 pixels high, on the last one a tenth of a pixel.
    assert content(addon, ob, "Lines", 1).sizes[0] > 10 and content(addon, ob, "Lines", 50).sizes[0] == 2
    assert scene.frame_current == current

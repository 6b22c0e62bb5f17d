"""Drawings, cameras and images that are squashed to nothing, points without a place, and texts that somebody damaged: all of them are told."""

import bpy
import numpy as np
import pytest
import shots
from test_strokes import add, drawing_object

SQUASHED = "has a scale of 0: set the scale to 1"


@pytest.fixture
def keyed(addon):
    """Two keys of a line."""
    ob = drawing_object(addon)
    for frame in (1, 9):
        add(addon, ob, "Lines", frame, [[(0, 0), (1, 0), (2, 0.1 * frame)]])
    return ob


def of_layer(ob):
    ob.data.layers["Lines"].scale = (1, 0, 1)


def of_object(ob):
    ob.scale = (0, 1, 1)


@pytest.mark.parametrize(
    ("call", "squash"), [("fit_strokes", of_layer), ("fit_strokes", of_object), ("hidden_lines", of_object), ("in_between", of_layer)]
)
def test_a_drawing_without_a_size(keyed, call, squash):
    squash(keyed)
    with pytest.raises(RuntimeError, match=f'"{keyed.name}", or what it or its layer hangs on, {SQUASHED}'):
        getattr(bpy.ops.rototoon, call)()


def test_what_shows_the_footage_has_no_size(addon, tmp_path):
    ob = shots.set_up(tmp_path)
    shots.draw(addon, ob, 1, [shots.square(0)])
    camera = ob.rototoon.camera
    camera.data.background_images[0].scale = 0
    with pytest.raises(RuntimeError, match=f'The footage in the background of "{camera.name}" has a scale of 0'):
        bpy.ops.rototoon.match_contours()
    empty = bpy.data.objects.new("Board", None)
    empty.empty_display_type, empty.data = "IMAGE", camera.data.background_images[0].image
    bpy.context.scene.collection.objects.link(empty)
    ob.rototoon.plane, ob.rototoon.reference = "REFERENCE", empty
    empty.scale = (0, 0, 0)
    with pytest.raises(RuntimeError, match=f'"Board", or what it hangs on, {SQUASHED}'):
        bpy.ops.rototoon.match_contours()


def test_an_image_in_the_scene_hinders_no_look_at_other_frames(addon, tmp_path):
    ob = shots.set_up(tmp_path, plane="REFERENCE")
    ob.rototoon.reference.keyframe_insert("location", frame=1)
    assert addon("scripting").set_key(ob, 9, {"square": shots.square(8)}) == ["square"]


def test_points_without_a_place_show_no_plane(addon):
    camera = addon("blender.camera")
    points = np.array([[0, 2.0, 0], [1, 2, 0], [0, 2, 1], [np.nan, 0, 0]])
    point, normal = camera.plane_of(points, np.array([0, 1.0, 0]))
    assert point[1] == 2 and abs(normal) == pytest.approx([0, 1, 0])
    assert np.isfinite(camera.plane_of(points[3:], np.array([0, 1.0, 0]))).all()


DAMAGED = ['{"limbs": 3}', '{"limbs": [4, {"from": 1}], "depth_marks": {"front": 2}}', '{"depth_marks": [[]]}']


@pytest.mark.parametrize("text", DAMAGED)
def test_damaged_limbs_count_as_missing(addon, text):
    limbs, ob = addon("style.limbs"), drawing_object(addon)
    ob.rototoon.extra = text
    assert limbs.defined(ob) == limbs.marks(ob) == []
    limbs.add_mark(ob, {"front": "arm", "behind": "body"})
    assert limbs.marks(ob) == [{"front": "arm", "behind": "body"}]
    assert bpy.ops.rototoon.choose_body(body="quadruped") == {"FINISHED"}
    assert limbs.defined(ob) == []


def test_a_damaged_body_has_a_name_in_the_panel(addon):
    ob = drawing_object(addon)
    ob.rototoon.extra = '{"skeleton": 7}'
    assert addon("style.limbs").body_name(ob) == "?"


def test_a_limb_line_without_a_place_marks_nothing(addon, tmp_path):
    gp, limbs = addon("blender.grease_pencil"), addon("style.limbs")
    ob = shots.set_up(tmp_path)
    layer = ob.data.layers.new(limbs.LAYER)
    handle = layer.frames.new(1).drawing
    handle.add_strokes([2, 2])
    gp.put(handle, "position", np.array([[0, 0, 0], [1, 0, 0], [np.nan, 0, 0], [1, 0, 1]]))
    gp.put(handle, gp.KEY_POINT, np.array([1, 2]))
    assert limbs.count_lines(ob) == 1


def test_numbers_that_no_stroke_has_are_told(addon, tmp_path):
    shots.set_up(tmp_path)
    with pytest.raises(RuntimeError, match="numbers: found '98, 99', expected numbers of strokes on frame 1"):
        bpy.ops.rototoon.make_part(numbers="98, 99")


def test_import_without_a_file_says_so(addon):
    with pytest.raises(RuntimeError, match="No file chosen"):
        bpy.ops.rototoon.import_document()


def test_scripts_find_what_they_have_moved(addon, tmp_path):
    ob = shots.set_up(tmp_path)
    scripting = addon("scripting")
    scripting.set_key(ob, 1, {"square": shots.square(0)})
    ob.location.x += 0.5
    assert scripting.set_key(ob, 1, {"diamond": shots.diamond(0)}) == ["diamond"]
    # 160 pixels are 10 units.
    found = [pixels for _, pixels in shots.pixels(addon, ob, 1)]
    assert found[0] == pytest.approx(shots.square(0) + (8, 0), abs=2e-3)
    assert found[1] == pytest.approx(shots.diamond(0), abs=2e-3)

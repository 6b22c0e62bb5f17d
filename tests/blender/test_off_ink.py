"""Drawings of the artist whose picture was drawn anew: they stay, and are named and marked. With the real library."""

import shutil

import bpy
import line_shots as ls
import numpy as np
import pytest
from line_stage import film, handle_of, kinds, pictures, said  # noqa: F401 - fixtures
from shots import write_png


@pytest.fixture
def own(addon, film, pictures, tmp_path):  # noqa: F811
    """The film in a folder of its own, traced, with the drawing of frame 3 thickened by the artist."""
    for number in range(1, 7):
        shutil.copy(pictures.with_name(f"line_{number:03}.png"), tmp_path)
    film.rototoon.pattern = str(tmp_path / "line_%03d.png")
    bpy.ops.rototoon.trace_drawing()
    for point in handle_of(addon, film, "Lines", 3).strokes[0].points:
        point.radius *= 2
    return film


def draw_anew(folder, by=(0, 40)):
    """The picture of frame 3, with everything elsewhere."""
    write_png(folder / "line_003.png", np.roll(ls.picture(2), by, (1, 0)))


def marks(addon, ob, frame=3):
    gp = addon("blender.grease_pencil")
    handle = handle_of(addon, ob, "Lines", frame)
    return gp.value(handle, gp.OFF_INK, len(gp.offsets(handle)) - 1)


def test_a_drawing_on_its_picture_is_not_named(addon, own):
    done = addon("scripting").trace_drawing(own)
    assert done.kept == 1 and done.off == () and not marks(addon, own).any()
    assert not any("picture" in warning for warning in said(addon).warnings)


def test_a_drawing_beside_its_picture_stays_and_is_named_and_marked(addon, own, tmp_path):
    before = ls.strokes(addon, own, "Lines", 3)
    draw_anew(tmp_path)
    bpy.ops.rototoon.trace_drawing()
    report = said(addon)
    (warning,) = [each for each in report.warnings if "picture" in each]
    assert warning.startswith("your drawing on frame 3 does not lie on the lines of the picture")
    assert "on 5 frames" in report.text, "the kept drawing is not counted"
    after = ls.strokes(addon, own, "Lines", 3)
    assert kinds(addon, own, "Lines")[3] == "KEYFRAME" and all(np.array_equal(after[n], points) for n, points in before.items())
    assert marks(addon, own).sum() > 3
    shown = addon("ui.doubts").marked(own, 3)
    assert len(shown) == marks(addon, own).sum() and not any(each.lost for each in shown)
    assert any(3 in doubt.doubtful for doubt in addon("scripting").doubtful_lines(own))
    bpy.context.scene.frame_set(2)
    bpy.ops.rototoon.next_doubt()
    assert bpy.context.scene.frame_current == 3 and "lies on no line of the picture on frame 3" in said(addon).text


def test_the_marks_go_when_the_drawing_lies_on_the_picture_again(addon, own, pictures, tmp_path):  # noqa: F811
    draw_anew(tmp_path)
    bpy.ops.rototoon.trace_drawing()
    assert marks(addon, own).any()
    shutil.copy(pictures.with_name("line_003.png"), tmp_path)
    bpy.ops.rototoon.trace_drawing()
    assert not marks(addon, own).any() and addon("ui.doubts").marked(own, 3) == []


def test_one_added_stroke_is_no_other_picture(addon, own):
    ls.put(addon, own, "Lines", 3, [(np.array([[5.0, 5.0], [25.0, 5.0]]), False)])
    assert addon("scripting").trace_drawing(own).off == ()


def test_lines_that_are_left_out_are_ink(addon, own):
    own.rototoon.line_leave_out, own.rototoon.line_left_out = True, (0.9, 0.3, 0.25)
    assert addon("scripting").trace_drawing(own).off == () and not marks(addon, own).any()


def test_drawings_outside_of_the_frames_are_not_looked_at(addon, own, tmp_path):
    draw_anew(tmp_path)
    assert addon("scripting").trace_drawing(own, (5, 6)).off == ()
    assert addon("scripting").trace_drawing(own, (2, 4)).off == (3,)


def test_a_stroke_beside_the_picture_that_is_right_is_accepted(addon, own, tmp_path):
    draw_anew(tmp_path)
    bpy.ops.rototoon.trace_drawing()
    before = int(marks(addon, own).sum())
    bpy.context.scene.frame_set(2)
    bpy.ops.rototoon.next_doubt()
    assert bpy.ops.rototoon.accept_doubt() == {"FINISHED"}
    assert marks(addon, own).sum() == before - 1 and kinds(addon, own, "Lines")[3] == "KEYFRAME"

"""Edit on All Frames with some of its choices off: what is not done on other frames stays an edit, and can be done later."""

import bpy
import line_shots as ls
import numpy as np
import pytest
from line_stage import film, pictures, traced  # noqa: F401 - fixtures
from line_stage import handle_of, number_of, said

MOUTH, ARM, EYE = 3, 4, 1


def change(addon, ob, frame, number, by=0.0, radius=None):
    """Moves a stroke, and gives it a width, as the artist does."""
    gp = addon("blender.grease_pencil")
    handle = handle_of(addon, ob, "Lines", frame)
    starts = gp.offsets(handle)
    i = gp.value(handle, gp.TRACK, len(starts) - 1).tolist().index(number)
    points, radii = gp.positions(handle, int(starts[-1])), gp.value(handle, "radius", int(starts[-1]))
    points[starts[i] : starts[i + 1]] += np.float32([by, 0, 0])
    gp.put(handle, "position", points)
    if radius is not None:
        radii[starts[i] : starts[i + 1]] = radius
        gp.put(handle, "radius", radii)
    return i


def delete(addon, ob, frame, number):
    gp = addon("blender.grease_pencil")
    handle = handle_of(addon, ob, "Lines", frame)
    gp.remove_strokes(handle, [gp.value(handle, gp.TRACK, len(gp.offsets(handle)) - 1).tolist().index(number)])


def radii(addon, ob, frame):
    """The radii of the points by stroke number."""
    gp, handle = addon("blender.grease_pencil"), handle_of(addon, ob, "Lines", frame)
    starts = gp.offsets(handle)
    numbers, values = gp.value(handle, gp.TRACK, len(starts) - 1).tolist(), gp.value(handle, "radius", int(starts[-1]))
    return {number: values[a:b] for number, a, b in zip(numbers, starts, starts[1:])}


def points(addon, ob, frame):
    return ls.strokes(addon, ob, "Lines", frame)


def test_moves_are_done_later_where_only_looks_were_wanted(addon, traced):
    arm = number_of(addon, traced, ARM)
    before = points(addon, traced, 4)[arm]
    change(addon, traced, 1, arm, by=0.2, radius=0.3)
    bpy.ops.rototoon.spread_edits(shape=False)
    assert np.allclose(radii(addon, traced, 4)[arm], 0.3) and np.allclose(points(addon, traced, 4)[arm], before, atol=1e-3)
    bpy.ops.rototoon.spread_edits()
    assert said(addon).text == "1 edited stroke, on 5 other frames"
    assert np.linalg.norm(points(addon, traced, 4)[arm].mean(0) - before.mean(0)) > 3
    with pytest.raises(RuntimeError, match="No stroke on this frame differs"):
        bpy.ops.rototoon.spread_edits()


def test_looks_are_done_later_where_only_shapes_were_wanted(addon, traced):
    arm = number_of(addon, traced, ARM)
    change(addon, traced, 1, arm, by=0.2, radius=0.3)
    bpy.ops.rototoon.spread_edits(look=False)
    after = points(addon, traced, 4)[arm]
    assert not np.allclose(radii(addon, traced, 4)[arm], 0.3)
    bpy.ops.rototoon.spread_edits()
    assert np.allclose(radii(addon, traced, 4)[arm], 0.3) and np.allclose(points(addon, traced, 4)[arm], after, atol=1e-2)


@pytest.mark.parametrize("off", ["shape", "look"])
def test_a_stroke_of_which_nothing_is_wanted_is_no_edit(addon, traced, off):
    change(addon, traced, 1, number_of(addon, traced, ARM), by=0.2 if off == "shape" else 0.0, radius=0.3 if off == "look" else None)
    with pytest.raises(RuntimeError, match="No stroke on this frame differs"):
        bpy.ops.rototoon.spread_edits(**{off: False})
    assert bpy.ops.rototoon.spread_edits() == {"FINISHED"}


def test_deletions_are_done_later_where_they_were_not_wanted(addon, traced):
    eye = number_of(addon, traced, EYE)
    delete(addon, traced, 1, eye)
    change(addon, traced, 1, number_of(addon, traced, ARM), by=0.2)
    bpy.ops.rototoon.spread_edits(delete=False)
    assert eye in points(addon, traced, 4)
    bpy.ops.rototoon.spread_edits()
    assert said(addon).text == "1 deleted stroke, on 5 other frames"
    assert all(eye not in points(addon, traced, frame) for frame in range(1, 7))


def test_what_was_done_to_another_frame_is_still_done_from_there(addon, traced):
    eye, arm = number_of(addon, traced, EYE), number_of(addon, traced, ARM)
    delete(addon, traced, 4, eye)
    change(addon, traced, 4, arm, radius=0.3)
    change(addon, traced, 1, arm, by=0.2)
    bpy.ops.rototoon.spread_edits(look=False)
    assert eye in points(addon, traced, 1) and np.allclose(radii(addon, traced, 4)[arm], 0.3)
    bpy.context.scene.frame_set(4)
    bpy.ops.rototoon.spread_edits()
    assert said(addon).text == "1 edited and 1 deleted strokes, on 5 other frames"
    assert eye not in points(addon, traced, 1) and np.allclose(radii(addon, traced, 1)[arm], 0.3)


def test_a_moved_stroke_keeps_the_widths_that_it_has_on_other_frames(addon, traced):
    arm = number_of(addon, traced, ARM)
    change(addon, traced, 4, arm, radius=0.3)
    change(addon, traced, 1, arm, by=0.2)
    before = points(addon, traced, 4)[arm]
    bpy.ops.rototoon.spread_edits()
    assert np.linalg.norm(points(addon, traced, 4)[arm].mean(0) - before.mean(0)) > 3
    assert np.allclose(radii(addon, traced, 4)[arm], 0.3)


def test_strokes_that_are_not_followed_yet_are_never_deleted(addon, traced):
    arm = number_of(addon, traced, ARM)
    for frame in (1, 4):
        ls.put(addon, traced, "Lines", frame, [(np.array([[20.0, 20.0], [60.0, 30.0]]), False)])
    change(addon, traced, 1, arm, by=0.2)
    bpy.ops.rototoon.spread_edits()
    delete(addon, traced, 1, 0)
    change(addon, traced, 1, arm, by=0.2)
    bpy.ops.rototoon.spread_edits()
    assert said(addon).text == "1 edited stroke, on 5 other frames"
    assert 0 in points(addon, traced, 4)

"""Snapped drawings that the artist has changed, or drawn on, stay whole."""

import bpy
import numpy as np
import pytest
import shots
from line_stage import said

LAST = 6
"""The last key. The footage goes on."""


@pytest.fixture
def snapped(addon, fake, tmp_path):
    """Two parts, tracked and snapped up to `LAST`."""
    ob = shots.set_up(tmp_path)
    for frame in (1, LAST):
        shots.draw(addon, ob, frame, [shots.diamond(frame - 1), shots.square(frame - 1)])
    bpy.ops.rototoon.track()
    bpy.ops.rototoon.snap()
    assert strokes(addon, ob, 3) == 2 and strokes(addon, ob, LAST + 1) == 0
    return ob


def strokes(addon, ob, frame):
    """Number of strokes of the drawing on a frame; `None` without one."""
    gp = addon("blender.grease_pencil")
    drawings = gp.drawings(ob.data.layers["Snapped"])
    return len(gp.offsets(drawings[frame][0])) - 1 if frame in drawings else None


def kinds(ob):
    return {frame.frame_number: frame.keyframe_type for frame in ob.data.layers["Snapped"].frames}


def draw(addon, ob, frame):
    """A new line on the drawing that is shown on a frame."""
    gp = addon("blender.grease_pencil")
    handle = ob.data.layers["Snapped"].get_frame_at(frame).drawing
    before = int(gp.offsets(handle)[-1])
    handle.add_strokes([3])
    points = gp.positions(handle, before + 3)
    points[before:] = [[0, 0, 0], [0.1, 0, 0.1], [0.2, 0, 0]]
    gp.put(handle, "position", points)


def bend(addon, ob, frame):
    gp = addon("blender.grease_pencil")
    handle = gp.drawings(ob.data.layers["Snapped"])[frame][0]
    points = gp.positions(handle, int(gp.offsets(handle)[-1]))
    points[:3, 2] += 0.3
    gp.put(handle, "position", points)
    return points


def reopened(tmp_path):
    path = str(tmp_path / "older.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    return bpy.context.object


@pytest.mark.parametrize("reopen", [False, True])
def test_lines_drawn_after_the_end_stay(addon, snapped, tmp_path, reopen):
    # The empty drawing after the last snapped one is shown there.
    draw(addon, snapped, LAST + 2)
    ob = reopened(tmp_path) if reopen else snapped
    bpy.ops.rototoon.snap()
    assert strokes(addon, ob, LAST + 1) == 1 and kinds(ob)[LAST + 1] == "KEYFRAME"
    assert said(addon).text.endswith(f"the drawing that you had changed on frame {LAST + 1} stays, as a key")
    bpy.ops.rototoon.clear_generated()
    assert kinds(ob) == {LAST + 1: "KEYFRAME"} and strokes(addon, ob, LAST + 1) == 1


@pytest.mark.parametrize("between", ["nothing", "snap"])
def test_clear_generated_leaves_a_changed_drawing_whole(addon, snapped, between):
    draw(addon, snapped, 3)
    points = bend(addon, snapped, 3)
    if between == "snap":
        bpy.ops.rototoon.snap()
        assert said(addon).text.endswith("the drawing that you had changed on frame 3 stays, as a key")
    bpy.ops.rototoon.clear_generated()
    assert kinds(snapped) == {3: "KEYFRAME"} and strokes(addon, snapped, 3) == 3
    gp = addon("blender.grease_pencil")
    handle = gp.drawings(snapped.data.layers["Snapped"])[3][0]
    assert np.array_equal(gp.positions(handle, len(points)), points)


@pytest.mark.parametrize("between", ["nothing", "snap"])
def test_hiding_a_part_leaves_a_changed_drawing_and_says_so(addon, snapped, between):
    bend(addon, snapped, 3)
    if between == "snap":
        bpy.ops.rototoon.snap()
    bpy.context.scene.frame_set(3)
    bpy.ops.rototoon.hide_part()
    assert strokes(addon, snapped, 3) == 2 and kinds(snapped)[3] == "KEYFRAME"
    assert said(addon).warnings == ("your snapped lines of it on 3 stay",)
    bpy.context.scene.frame_set(4)
    bpy.ops.rototoon.hide_part()
    assert strokes(addon, snapped, 4) == 1 and kinds(snapped)[4] == "GENERATED" and said(addon).warnings == ()

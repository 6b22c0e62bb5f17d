"""Generated drawings that are moved in time, as where a drawing is inserted in a film, are still generated. What the artist changed is still the
artist's."""

import json

import bpy
import line_shots as ls
import numpy as np
import pytest
import shots
from line_stage import film, pictures, traced  # noqa: F401 - fixtures
from line_stage import handle_of, kinds, said
from test_paint import clicked, painted  # noqa: F401 - fixtures
from test_tween_moved import put_on

KEPT = "that you had changed"


def move_all(ob, layer, by, first=1):
    """Moves all drawings of a layer from a frame on, as in the dope sheet."""
    frames = ob.data.layers[layer].frames
    for number in sorted((f.frame_number for f in frames if f.frame_number >= first), reverse=by > 0):
        frames.move(number, number + by)


def shifted(addon, ob, frame, by=0.01):
    """Moves the first points of a drawing."""
    gp = addon("blender.grease_pencil")
    handle = handle_of(addon, ob, "Lines", frame)
    points = gp.positions(handle, int(gp.offsets(handle)[-1]))
    points[:10, 2] += by
    gp.put(handle, "position", points)


@pytest.mark.parametrize(("by", "first"), [(1, 3), (2, 1), (-1, 3), (3, 4), (40, 1)])
def test_moved_traced_drawings_are_still_traced(addon, traced, fake, by, first):  # noqa: F811
    if by < 0:
        traced.data.layers["Lines"].frames.remove(first + by)
    move_all(traced, "Lines", by, first)
    bpy.ops.rototoon.trace_drawing(hold=False)
    assert KEPT not in said(addon).text
    assert set(kinds(addon, traced, "Lines").values()) == {"GENERATED"}
    bpy.ops.rototoon.clear_lines()
    assert not kinds(addon, traced, "Lines").keys() & range(1, 7)


def test_what_is_traced_on_one_frame_leaves_moved_drawings_traced(addon, traced, fake):  # noqa: F811
    move_all(traced, "Lines", 1, 3)
    bpy.context.scene.frame_set(1)
    bpy.ops.rototoon.trace_drawing(frames="CURRENT")
    move_all(traced, "Lines", 1, 3)
    bpy.ops.rototoon.trace_drawing(hold=False)
    assert KEPT not in said(addon).text and set(kinds(addon, traced, "Lines").values()) == {"GENERATED"}


def test_a_changed_drawing_that_is_moved_is_the_artists(addon, traced, fake):  # noqa: F811
    shifted(addon, traced, 3)
    before = ls.strokes(addon, traced, "Lines", 3)
    move_all(traced, "Lines", 1, 2)
    bpy.ops.rototoon.trace_drawing(hold=False)
    assert f"1 drawing {KEPT} is a key now" in said(addon).text
    found = kinds(addon, traced, "Lines")
    assert [frame for frame, kind in found.items() if kind == "KEYFRAME"] == [4]
    after = ls.strokes(addon, traced, "Lines", 4)
    assert all(np.array_equal(points, after[number]) for number, points in before.items())


def test_another_look_on_another_frame_is_the_artists(addon, traced, fake):  # noqa: F811
    for point in handle_of(addon, traced, "Lines", 3).strokes[0].points:
        point.opacity = 0.5
    move_all(traced, "Lines", 2, 2)
    bpy.ops.rototoon.trace_drawing(hold=False)
    assert [frame for frame, kind in kinds(addon, traced, "Lines").items() if kind == "KEYFRAME"] == [5]


def test_a_copy_in_the_place_of_another_drawing_is_the_artists(addon, traced, fake):  # noqa: F811
    traced.data.layers["Lines"].frames.remove(5)
    traced.data.layers["Lines"].frames.copy(2, 5)
    bpy.ops.rototoon.trace_drawing(hold=False)
    assert [frame for frame, kind in kinds(addon, traced, "Lines").items() if kind == "KEYFRAME"] == [5]


def test_drawings_that_change_places_are_still_traced(addon, traced, fake):  # noqa: F811
    put_on(traced, {2: 5, 5: 2})
    bpy.ops.rototoon.trace_drawing(hold=False)
    assert set(kinds(addon, traced, "Lines").values()) == {"GENERATED"}


def test_a_stroke_deleted_before_a_move_is_deleted_on_all_frames(addon, traced):  # noqa: F811
    gp = addon("blender.grease_pencil")
    gone = list(ls.strokes(addon, traced, "Lines", 4))[2]
    gp.remove_strokes(handle_of(addon, traced, "Lines", 4), [2])
    move_all(traced, "Lines", 3)
    bpy.context.scene.frame_set(7)
    assert bpy.ops.rototoon.spread_edits() == {"FINISHED"}
    assert said(addon).text == "1 deleted stroke, on 5 other frames"
    assert all(gone not in ls.strokes(addon, traced, "Lines", frame) for frame in kinds(addon, traced, "Lines"))


def test_another_number_on_moved_drawings_is_noted_there(addon, traced, fake):  # noqa: F811
    move_all(traced, "Lines", 1, 2)
    bpy.context.scene.frame_set(1)
    one, other, *_ = ls.strokes(addon, traced, "Lines", 1)
    assert bpy.ops.rototoon.match_lines(earlier=one, later=other) == {"FINISHED"}
    kept = json.loads(traced.data["rototoon_lines"])["Lines"]
    assert sorted(map(int, kept["sums"])) == [1, *range(3, 8)]
    bpy.ops.rototoon.trace_drawing(hold=False)
    assert [frame for frame, kind in kinds(addon, traced, "Lines").items() if kind == "KEYFRAME"] == [3]


def test_moved_drawings_of_parts_and_snapped_lines_are_still_generated(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    bpy.ops.rototoon.snap()
    names = [ob.rototoon.contours_layer, ob.rototoon.snapped_layer]
    before = {name: kinds(addon, ob, name) for name in names}
    for name in names:
        ob.data.layers[name].frames.remove(8)
        for frame in range(7, 2, -1):
            ob.data.layers[name].frames.move(frame, frame + 1)
    bpy.ops.rototoon.track()
    bpy.ops.rototoon.snap()
    for name in names:
        assert kinds(addon, ob, name) == before[name]


def test_moved_paint_is_still_generated(addon, painted, fake):  # noqa: F811
    before = kinds(addon, painted, "Paint")
    move_all(painted, "Paint", 1, 3)
    bpy.ops.rototoon.fill_drawings(hold=False)
    assert before == {1: "KEYFRAME", **dict.fromkeys(range(2, 7), "GENERATED")}
    assert kinds(addon, painted, "Paint") == before | {7: "GENERATED"}

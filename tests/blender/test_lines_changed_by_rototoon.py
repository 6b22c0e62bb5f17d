"""Traced drawings that Fit Strokes and Remove Hidden Lines have changed: they stay traced, with their numbers, and the message says so."""

import json

import bpy
import line_shots as ls
import numpy as np
import pytest
from line_stage import film, pictures, traced  # noqa: F401 - fixtures
from line_stage import handle_of, kinds, said
from test_lines_edited import cover

AGAIN = "do this again after Trace Drawing or Carry Strokes draws"
ALL = range(1, 7)


def numbers(addon, ob, frame):
    gp, handle = addon("blender.grease_pencil"), handle_of(addon, ob, "Lines", frame)
    return gp.value(handle, gp.TRACK, len(gp.offsets(handle)) - 1).tolist()


def types(addon, ob, frame):
    return set(addon("blender.strokes").read(handle_of(addon, ob, "Lines", frame)).types.tolist())


def traced_frames(addon, ob):
    (layer,) = addon("lines.drawings").read(ob, ["Lines"])
    return sorted(layer.made)


def test_fitted_drawings_stay_traced(addon, traced):
    before = {frame: numbers(addon, traced, frame) for frame in ALL}
    bpy.ops.rototoon.fit_strokes(frames="ALL")
    assert said(addon).text.endswith(f"6 traced drawings among them: {AGAIN} them anew")
    assert traced_frames(addon, traced) == list(ALL) and all(numbers(addon, traced, frame) == before[frame] for frame in ALL)
    bpy.ops.rototoon.trace_drawing()
    assert said(addon).text == "6 strokes on 6 frames"
    assert all(types(addon, traced, frame) == {addon("blender.strokes").POLY} for frame in ALL)
    assert all(numbers(addon, traced, frame) == before[frame] for frame in ALL)


def test_fitted_drawings_are_cleared(addon, traced):
    bpy.ops.rototoon.fit_strokes(frames="ALL")
    bpy.ops.rototoon.clear_lines()
    assert said(addon).text == "6 traced drawings removed"


def test_a_drawing_that_the_artist_changed_stays_the_artists(addon, traced):
    gp, handle = addon("blender.grease_pencil"), handle_of(addon, traced, "Lines", 3)
    points = gp.positions(handle, int(gp.offsets(handle)[-1]))
    gp.put(handle, "position", points + np.float32([0.05, 0, 0]))
    bpy.ops.rototoon.fit_strokes(frames="ALL")
    assert said(addon).text.endswith(f"5 traced drawings among them: {AGAIN} them anew")
    assert traced_frames(addon, traced) == [1, 2, 4, 5, 6]
    bpy.ops.rototoon.trace_drawing()
    assert kinds(addon, traced, "Lines")[3] == gp.KEYFRAME and addon("blender.strokes").NURBS in types(addon, traced, 3)


def test_a_change_after_the_fit_makes_a_drawing_the_artists(addon, traced):
    bpy.ops.rototoon.fit_strokes(frames="ALL")
    gp, handle = addon("blender.grease_pencil"), handle_of(addon, traced, "Lines", 3)
    gp.put(handle, "radius", np.full(int(gp.offsets(handle)[-1]), 0.3, np.float32))
    assert traced_frames(addon, traced) == [1, 2, 4, 5, 6]


@pytest.mark.parametrize("frames", ["CURRENT", "RANGE"])
def test_cut_drawings_stay_traced_and_come_back_whole(addon, traced, frames):
    before = {frame: ls.strokes(addon, traced, "Lines", frame) for frame in ALL}
    cover(addon, traced, 2)
    bpy.context.scene.frame_set(2)
    bpy.ops.rototoon.hidden_lines(frames=frames)
    assert said(addon).text.endswith(f"1 traced drawing among them: {AGAIN} it anew")
    assert traced_frames(addon, traced) == list(ALL) and set(numbers(addon, traced, 2)) < set(before[2])
    bpy.ops.rototoon.trace_drawing()
    for frame in ALL:
        now = ls.strokes(addon, traced, "Lines", frame)
        assert list(now) == list(before[frame]) and all(np.allclose(now[n], before[frame][n], atol=1e-3) for n in now)


def test_hidden_lines_are_not_deleted_by_the_artist(addon, traced):
    cover(addon, traced, 2)
    bpy.context.scene.frame_set(2)
    bpy.ops.rototoon.hidden_lines()
    with pytest.raises(RuntimeError, match="No stroke on this frame differs"):
        bpy.ops.rototoon.spread_edits()


def test_doubts_stay(addon, traced):
    gp, handle = addon("blender.grease_pencil"), handle_of(addon, traced, "Lines", 5)
    gp.put(handle, gp.CONFIDENCE, np.full(int(gp.offsets(handle)[-1]), 0.3, np.float32))
    before = addon("scripting").doubtful_lines(traced)
    bpy.ops.rototoon.fit_strokes(frames="ALL")
    assert before and addon("scripting").doubtful_lines(traced) == before


def test_a_held_drawing_that_is_cut_on_a_later_frame_is_held_again(addon, traced):
    gp = addon("blender.grease_pencil")
    gp.remove_frames(gp.find_layer(traced, "Lines"), [3])
    cover(addon, traced, 3)
    bpy.ops.rototoon.hidden_lines(frames="RANGE")
    assert traced_frames(addon, traced) == list(ALL)
    bpy.ops.rototoon.trace_drawing()
    assert said(addon).text == "6 strokes on 6 frames" and all(len(numbers(addon, traced, frame)) == 6 for frame in ALL)


def aside(addon, ob):
    gp = addon("blender.grease_pencil")
    return {frame: len(gp.offsets(handle)) - 1 for frame, (handle, _) in gp.drawings(ob.data.layers["Lines Hidden"]).items()}


def moved_aside(addon, ob):
    cover(addon, ob, 2)
    bpy.context.scene.frame_set(2)
    bpy.ops.rototoon.hidden_lines(frames="RANGE", action="MOVE")
    assert aside(addon, ob)[2] == 4


def test_hidden_lines_that_were_moved_aside_are_not_there_twice(addon, traced):
    moved_aside(addon, traced)
    bpy.ops.rototoon.trace_drawing()
    assert not any(aside(addon, traced).values())


def test_hidden_lines_that_the_artist_changed_stay(addon, traced):
    moved_aside(addon, traced)
    gp, handle = addon("blender.grease_pencil"), handle_of(addon, traced, "Lines Hidden", 2)
    gp.put(handle, "radius", np.full(int(gp.offsets(handle)[-1]), 0.3, np.float32))
    bpy.ops.rototoon.trace_drawing()
    assert aside(addon, traced)[2] == 4


def test_hidden_lines_of_a_drawing_of_the_artist_stay(addon, traced):
    gp, handle = addon("blender.grease_pencil"), handle_of(addon, traced, "Lines", 2)
    points = gp.positions(handle, int(gp.offsets(handle)[-1]))
    gp.put(handle, "position", points + np.float32([0.01, 0, 0]))
    moved_aside(addon, traced)
    bpy.ops.rototoon.trace_drawing()
    assert kinds(addon, traced, "Lines")[2] == gp.KEYFRAME and aside(addon, traced)[2] == 4


def test_hidden_lines_go_with_the_traced_ones_and_are_not_carried(addon, traced):
    moved_aside(addon, traced)
    with pytest.raises(RuntimeError, match='"Lines Hidden" has snapped or hidden lines, or paint'):
        addon("scripting").carry_strokes(traced, ["Lines Hidden"])
    bpy.ops.rototoon.carry_strokes(layers="ALL")
    bpy.ops.rototoon.clear_lines()
    assert said(addon).text == "6 traced drawings removed" and not any(aside(addon, traced).values())


def test_clear_lines_takes_hidden_lines_along(addon, traced):
    moved_aside(addon, traced)
    bpy.ops.rototoon.clear_lines()
    assert said(addon).text == "6 traced drawings removed" and not any(aside(addon, traced).values())


def test_they_go_into_documents_as_traced_ones(addon, traced, tmp_path):
    bpy.ops.rototoon.fit_strokes(frames="ALL")
    cover(addon, traced, 2)
    bpy.context.scene.frame_set(2)
    bpy.ops.rototoon.hidden_lines()
    path = tmp_path / "out.json"
    assert bpy.ops.rototoon.export_document(filepath=str(path)) == {"FINISHED"}
    document = json.loads(path.read_text())
    assert not document.get("drawings") and [each["frame"] for each in document["traced"]] == list(ALL)
    assert bpy.ops.rototoon.import_document(filepath=str(path)) == {"FINISHED"}
    assert traced_frames(addon, bpy.context.object) == list(ALL)

"""Suggest Breakdown, in background, with the real library and with pictures drawn here."""

import bpy
import line_shots as ls
import numpy as np
import pytest
from line_stage import said
from shots import write_png
from test_strokes import add, drawing_object
from test_tween import figure, frames, looks

pytestmark = pytest.mark.usefixtures("library")
MARKER = "Breakdown?"


def markers():
    return {marker.name: marker.frame for marker in bpy.context.scene.timeline_markers}


def three_keys(addon):
    """Keys on 1, 5 and 15. The second span moves farther."""
    ob = drawing_object(addon)
    for frame, shift in ((1, 0.0), (5, 0.3), (15, 2.5)):
        add(addon, ob, "Lines", frame, figure(shift, 0.1 * shift))
    bpy.context.scene.frame_set(1)
    return ob


def filmed(addon, folder, shown, drawn=None):
    """A film whose pictures have the lines of the frames `shown`, with drawings of the lines `drawn` on its first and last picture."""
    folder.mkdir()
    for number, frame in enumerate(shown, 1):
        write_png(folder / f"line_{number:03}.png", ls.picture(frame))
    ob = ls.set_up(folder / "line_001.png")
    for frame, index in ((1, shown[0]), (len(shown), shown[-1])):
        lines = [(points, False) for points, _, _ in ls.lines(index)] if drawn is None else drawn(index)
        ls.put(addon, ob, "Drawn", frame, lines)
    return ob


def test_without_footage_it_is_the_middle_of_the_span_that_moves_most(addon):
    ob = three_keys(addon)
    before = {frame: looks(addon, ob, frame) for frame in (1, 5, 15)}
    assert bpy.ops.rototoon.suggest_breakdown() == {"FINISHED"}
    assert (bpy.context.scene.frame_current, markers()) == (10, {MARKER: 10})
    text = said(addon).text
    assert text.startswith("A breakdown helps most on frame 10, between the keys 5 and 15:")
    assert text.endswith("the middle of the span that moves most. No picture shows the movement")
    # Nothing is drawn, and the keys are as they were.
    assert frames(addon, ob) == dict.fromkeys((1, 5, 15), "KEYFRAME")
    assert all(looks(addon, ob, frame).equals(kept) for frame, kept in before.items())
    assert "rototoon_tween" not in ob.data


def test_a_second_suggestion_moves_its_marker_and_no_other(addon):
    three_keys(addon)
    bpy.context.scene.timeline_markers.new("Mine", frame=3)
    bpy.ops.rototoon.suggest_breakdown()
    bpy.context.scene.frame_set(2)
    assert bpy.ops.rototoon.suggest_breakdown(frames="CURRENT") == {"FINISHED"}
    assert (bpy.context.scene.frame_current, markers()) == (3, {"Mine": 3, MARKER: 3})


def test_in_betweens_that_are_drawn_stay_and_are_judged_too(addon):
    ob = three_keys(addon)
    bpy.ops.rototoon.in_between(frames="ALL", step=2)
    before = {frame: looks(addon, ob, frame) for frame in frames(addon, ob)}
    kept = ob.data["rototoon_tween"]
    assert bpy.ops.rototoon.suggest_breakdown() == {"FINISHED"}
    # On twos the drawings are on odd frames.
    assert bpy.context.scene.frame_current in (9, 11)
    assert all(looks(addon, ob, frame).equals(drawing) for frame, drawing in before.items())
    assert ob.data["rototoon_tween"] == kept


def test_the_footage_shows_where_the_in_between_is_worst(addon, tmp_path):
    # The movement is nearly over on the second picture; in-betweens are in the middle of it on the third and fourth.
    filmed(addon, tmp_path / "early", (0, 4, 4, 4, 5, 5))
    assert bpy.ops.rototoon.suggest_breakdown() == {"FINISHED"}
    assert (bpy.context.scene.frame_current, markers()) == (2, {MARKER: 2})
    assert "px off the picture, the keys" in said(addon).text
    # Without a look at it, only the movement is known.
    assert bpy.ops.rototoon.suggest_breakdown(look=False) == {"FINISHED"}
    assert bpy.context.scene.frame_current == 3
    assert said(addon).text.endswith("No picture shows the movement")


def test_footage_on_later_frames_is_compared_with_its_own_frames(addon, tmp_path):
    ob = filmed(addon, tmp_path / "late", (0, 0, 1, 1, 1, 5))
    gp = addon("blender.grease_pencil")
    ob.rototoon.frame_offset += 10
    layer = gp.find_layer(ob, "Drawn")
    for frame in (1, 6):
        gp.copy_frame(layer, frame, frame + 10)
    gp.remove_frames(layer, [1, 6])
    assert bpy.ops.rototoon.suggest_breakdown() == {"FINISHED"}
    assert bpy.context.scene.frame_current == 15, said(addon).text


def test_footage_that_shows_something_else_is_said(addon, tmp_path):
    # The arm's turn, drawn in the empty corner of the pictures.
    def corner(index):
        at = np.array([6.0, 5.0 + 2 * index])
        return [(at + np.linspace(0, 1, 20)[:, None] * np.array([25.0, 0.0]), False)]

    filmed(addon, tmp_path / "other", (0, 4, 4, 4, 5, 5), corner)
    assert bpy.ops.rototoon.suggest_breakdown() == {"FINISHED"}
    assert bpy.context.scene.frame_current == 3
    assert "The footage shows something else: the keys are" in said(addon).text


def test_keys_side_by_side_have_no_frame_for_a_breakdown(addon):
    ob = drawing_object(addon)
    for frame in (1, 2):
        add(addon, ob, "Lines", frame, figure(0.5 * frame))
    with pytest.raises(RuntimeError, match="No frames between two keys"):
        bpy.ops.rototoon.suggest_breakdown()
    assert markers() == {}

"""In-betweens that were drawn anew in their place, emptied, or changed by Rototoon itself."""

import bpy
import numpy as np
import pytest
from test_strokes import add, circle, content
from test_tween import figure, frames, keyed, move

pytestmark = pytest.mark.usefixtures("library")


def said(addon):
    return addon("scripting").take_reports()[-1]


def between(addon, keys=(1, 9)):
    ob = keyed(addon, keys)
    bpy.ops.rototoon.in_between(frames="ALL", spacing="LINEAR")
    return ob


def handle(addon, ob, frame):
    return addon("blender.grease_pencil").drawings(ob.data.layers["Lines"])[frame][0]


def places(addon, ob, frame):
    return content(addon, ob, "Lines", frame).point["position"]


@pytest.mark.parametrize("operator", ("in_between", "update_in_betweens", "clear_in_betweens"))
def test_an_own_drawing_in_the_place_of_an_in_between_is_a_named_breakdown(addon, operator):
    ob = between(addon)
    handle(addon, ob, 5).remove_strokes()
    add(addon, ob, "Lines", 5, figure(0.4, 0.2))
    assert frames(addon, ob)[5] == "GENERATED"
    mine = places(addon, ob, 5)
    assert getattr(bpy.ops.rototoon, operator)() == {"FINISHED"}
    assert frames(addon, ob)[5] == "BREAKDOWN" and np.array_equal(places(addon, ob, 5), mine)
    assert "that you had changed" in (text := said(addon).text) and "frame 5" in text
    if operator != "clear_in_betweens":
        assert text.startswith("6 in-betweens in 2 spans")


def test_an_emptied_in_between_is_a_blank_key_that_is_named(addon):
    ob = between(addon)
    handle(addon, ob, 3).remove_strokes()
    assert bpy.ops.rototoon.update_in_betweens() == {"FINISHED"}
    report = said(addon)
    assert "1 drawing that you had changed is a key now: frame 3" in report.text
    assert report.kind == "WARNING" and report.warnings == ("2 spans with a blank key were left out: frame 3 is blank",)
    assert frames(addon, ob)[3] == "BREAKDOWN"
    with pytest.raises(RuntimeError, match="The drawing on 3 is blank, so there is nothing to draw between"):
        bpy.ops.rototoon.update_in_betweens()


def test_spans_that_end_at_an_emptied_in_between_are_named_while_others_are_drawn(addon):
    ob = between(addon, (1, 7, 13))
    handle(addon, ob, 4).remove_strokes()
    move(addon, ob, 13, by=0.4)
    assert bpy.ops.rototoon.update_in_betweens() == {"FINISHED"}
    report = said(addon)
    assert report.text.startswith("5 in-betweens in 1 span, 1 drawing that you had changed is a key now: frame 4")
    assert report.warnings == ("2 spans with a blank key were left out: frame 4 is blank",)


def fitted(_addon, ob):
    return bpy.ops.rototoon.fit_strokes(tolerance=0.01, unit="WORLD", frames="ALL")


def without_hidden(_addon, ob):
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 1, 9
    return bpy.ops.rototoon.hidden_lines(frames="RANGE", covers="CLOSED")


def covered(addon):
    """The figure, and a closed line above one of its strokes."""
    ob = keyed(addon)
    around = np.array([[-0.3, -0.3], [1.0, -0.3], [1.0, 1.0], [-0.3, 1.0]])
    for frame in (1, 9):
        add(addon, ob, "Lines", frame, [around], cyclic=True)
    bpy.ops.rototoon.in_between(frames="ALL", spacing="LINEAR")
    return ob


@pytest.mark.parametrize("change", (fitted, without_hidden))
def test_what_rototoon_itself_changes_stays_an_in_between(addon, change):
    ob = covered(addon)
    before = {frame: places(addon, ob, frame) for frame in range(2, 9)}
    assert change(addon, ob) == {"FINISHED"}
    changed = [frame for frame, old in before.items() if not np.array_equal(places(addon, ob, frame), old)]
    assert changed and f"{len(changed)} in-between" in (text := said(addon).text)
    # Fitted keys are as good as before. Cut keys have lost lines.
    assert text.endswith("among them: do this again after Update In-betweens draws them anew") == (change is fitted)
    assert all(frames(addon, ob)[frame] == "GENERATED" for frame in changed)
    move(addon, ob, 9, by=0.4)
    assert bpy.ops.rototoon.update_in_betweens() == {"FINISHED"}
    assert said(addon).text == "7 in-betweens in 1 span"
    assert bpy.ops.rototoon.clear_in_betweens() == {"FINISHED"}
    assert said(addon).text == "7 in-betweens removed" and list(frames(addon, ob)) == [1, 9]


@pytest.fixture
def on_twos(addon):
    """In-betweens on twos under something that moves on ones, with their hidden lines cut: frames that were held have drawings of their own."""
    ob = keyed(addon)
    bpy.ops.rototoon.in_between(spacing="LINEAR", step=2)
    ob.data.layers.new("Cover")
    for frame in range(1, 10):
        add(addon, ob, "Cover", frame, [circle((0.5 + 0.15 * frame, 0.5), 0.5)], cyclic=True)
    assert list(frames(addon, ob)) == [1, 3, 5, 7, 9]
    without_hidden(addon, ob)
    assert {2, 4, 6, 8} <= frames(addon, ob).keys()
    return ob


def test_cut_copies_of_held_drawings_are_in_betweens(addon, on_twos):
    found = addon("tween.keys").frames_of(on_twos.data.layers["Lines"], addon("tween.records").read(on_twos.data)["Lines"])
    assert (found.keys, found.made, found.edited) == ([1, 9], list(range(2, 9)), [])
    bpy.ops.rototoon.update_in_betweens()
    assert said(addon).text.startswith("3 in-betweens in 1 span") and list(frames(addon, on_twos)) == [1, 3, 5, 7, 9]
    assert "BREAKDOWN" not in frames(addon, on_twos).values()


def test_cut_copies_of_held_drawings_are_cleared(addon, on_twos):
    bpy.ops.rototoon.clear_in_betweens()
    assert said(addon).text == "7 in-betweens removed" and list(frames(addon, on_twos)) == [1, 9]


def test_a_cut_copy_that_the_artist_changes_is_a_key(addon, on_twos):
    move(addon, on_twos, 2, by=0.4)
    bpy.ops.rototoon.update_in_betweens()
    assert "1 drawing that you had changed is a key now: frame 2" in said(addon).text
    assert frames(addon, on_twos)[2] == "BREAKDOWN"


@pytest.mark.parametrize("step", [1, 2])
def test_in_betweens_that_are_hidden_whole_stay_in_betweens(addon, step):
    ob = keyed(addon)
    bpy.ops.rototoon.in_between(spacing="LINEAR", step=step)
    ob.data.layers.new("Cover")
    for frame, size in ((1, 0.1), (4, 20.0), (7, 0.1)):
        add(addon, ob, "Cover", frame, [circle((2.0, 1.0), size)], cyclic=True)
    drawn = list(frames(addon, ob))
    without_hidden(addon, ob)
    assert not len(content(addon, ob, "Lines", 4).sizes) and not len(content(addon, ob, "Lines", 5).sizes)
    found = addon("tween.keys").frames_of(ob.data.layers["Lines"], addon("tween.records").read(ob.data)["Lines"])
    assert found.keys == [1, 9] and not found.edited
    ob.data.layers["Cover"].hide = True
    move(addon, ob, 9, by=0.4)
    bpy.ops.rototoon.update_in_betweens()
    assert "you had changed" not in said(addon).text and list(frames(addon, ob)) == drawn
    assert all(len(content(addon, ob, "Lines", frame).sizes) for frame in drawn)
    handle(addon, ob, 5).remove_strokes()
    bpy.ops.rototoon.update_in_betweens()
    assert "that you had changed is a key now: frame 5" in said(addon).text


def test_own_keys_that_are_cut_are_a_warning_with_their_frames(addon):
    ob = covered(addon)
    without_hidden(addon, ob)
    report = said(addon)
    assert report.kind == "WARNING" and "do this again" not in report.text
    assert report.text.startswith("5 hidden lines on 5 drawings, 4 in-betweens among them"), report.text
    (warning,) = report.warnings
    assert warning.startswith("1 drawing of yours was cut on frame 1, and in-betweens that are drawn anew come from what is left"), warning


def test_own_drawings_without_in_betweens_that_are_cut_are_said(addon):
    ob = covered(addon)
    bpy.ops.rototoon.clear_in_betweens()
    without_hidden(addon, ob)
    report = said(addon)
    assert report.kind == "INFO" and report.text.endswith("1 drawing of yours among them, on frame 1"), report.text


def test_what_the_artist_changed_before_stays_the_artists(addon):
    ob = between(addon)
    move(addon, ob, 5, by=0.4)
    fitted(addon, ob)
    bpy.ops.rototoon.update_in_betweens()
    assert "1 drawing that you had changed is a key now: frame 5" in said(addon).text
    assert frames(addon, ob)[5] == "BREAKDOWN"


def test_strokes_that_give_way_to_others_half_way_are_counted(addon):
    exchanged = addon("tween.between")._exchanged
    stands = np.array([[0, 0], [1, -1], [2, -1], [-1, 1], [-1, 2], [3, -1]])
    half = [1, 1, 1, 0, 0, 0.75], [1, 0, 1, 1, 1, 0.25]
    # The stroke 2 of the earlier key shrinks, and stroke 3 fades.
    assert exchanged(stands, np.array(half)) == (1, 2)
    assert exchanged(stands[:1], np.ones((2, 1))) == (0, 0)


def test_strokes_that_give_way_to_others_are_a_warning_with_their_frames(addon, monkeypatch):
    ob = keyed(addon, (1, 5, 9))
    monkeypatch.setattr(addon("tween.between"), "_exchanged", lambda *_: (2, 3))
    assert bpy.ops.rototoon.in_between(frames="ALL") == {"FINISHED"}
    report = said(addon)
    assert report.kind == "WARNING" and report.text.startswith("6 in-betweens in 2 spans")
    assert report.warnings[0].startswith("frames 1 to 5 (3 strokes), 5 to 9 (3 strokes): strokes of one drawing give way"), report.warnings
    assert len(frames(addon, ob)) == 9

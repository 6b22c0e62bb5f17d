"""Answers that panels get from what was asked last, and looks at drawings that Blender finds slowly."""

import bpy
import pytest
import shots
from test_strokes import add, drawing_object


@pytest.fixture
def memo(addon, monkeypatch):
    """As in a window."""
    found = addon("blender.memo")
    monkeypatch.setattr(found, "bpy", type("Blender", (), {"app": type("App", (), {"background": False}), "types": bpy.types}))
    found.clear()
    yield found
    found.clear()


def asking(answers):
    """A question with these answers, one after the other."""

    def ask(_ob):
        return next(answers)

    return ask


def test_an_answer_holds_until_the_object_changes(addon, memo):
    ob = drawing_object(addon)
    ask = asking(iter([True, False, True, False]))
    assert [memo.kept(ob, ask) for _ in range(3)] == [True] * 3
    ob.data.update_tag()
    bpy.context.view_layer.update()
    assert [memo.kept(ob, ask) for _ in range(2)] == [False] * 2
    ob.rototoon.contours_layer = "Outline"
    assert memo.kept(ob, ask) is True, "other layers are looked at now"
    memo.clear()
    assert memo.kept(ob, ask) is False


def test_objects_and_questions_are_told_apart(addon, memo):
    one, other = drawing_object(addon), drawing_object(addon)

    def first(ob):
        return ob == one

    def second(ob):
        return ob == other

    assert [memo.kept(ob, ask) for ob in (one, other) for ask in (first, second)] == [True, False, False, True]


def test_scripts_in_background_get_what_is_there_now(addon):
    memo = addon("blender.memo")
    assert [memo.kept(drawing_object(addon), ask) for ask in [asking(iter([True, False]))] * 2] == [True, False]


def test_polls_follow_what_is_drawn(addon, memo):
    gp, ob = addon("blender.grease_pencil"), drawing_object(addon)
    handle = add(addon, ob, "Lines", 1, [[(0, 0), (1, 0)]])
    polls = [bpy.ops.rototoon.match_lines.poll, bpy.ops.rototoon.clear_lines.poll, bpy.ops.rototoon.clear_in_betweens.poll]
    assert [poll() for poll in polls] == [False, False, False]
    gp.put(handle, gp.LINE, [1, 1])
    gp.put(handle, gp.TWEENED, [True])
    ob.data.update_tag()
    bpy.context.view_layer.update()
    assert [poll() for poll in polls] == [True, False, True], "the artist's drawing is no traced one"
    gp.set_keyframe_type(ob.data.layers["Lines"], {1: gp.GENERATED})
    ob.data.update_tag()
    bpy.context.view_layer.update()
    assert [poll() for poll in polls] == [True, True, True]


def test_what_a_layer_shows(addon, tmp_path):
    gp, ob = addon("blender.grease_pencil"), shots.set_up(tmp_path)
    layer = shots.layer_of(ob)
    assert gp.shown(layer, 4) is None
    shots.draw(addon, ob, 2, [shots.square(0)])
    gp.make_frames(layer, [6], gp.GENERATED)
    assert gp.shown(layer, 1) is None
    assert [gp.shown(layer, frame)[::2] for frame in (2, 5, 6, 99)] == [(2, gp.KEYFRAME)] * 2 + [(6, gp.GENERATED)] * 2
    assert gp.shown(layer, 5)[1] == gp.drawings(layer)[2][0]
    assert [len(gp.offsets(handle)) - 1 for handle in gp.handles(layer)] == [1, 0]
    assert [len(gp.offsets(handle)) - 1 for handle in gp.handles(layer, gp.GENERATED)] == [0]

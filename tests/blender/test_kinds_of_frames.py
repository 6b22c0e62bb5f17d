"""Frames that are more than a drawing on a number: those on which a drawing ends by itself, those that share a drawing, and curves on keys."""

import json

import bpy
import numpy as np
import pytest
import shots
from test_strokes import add, drawing_object

# Only Blenders before 5.3 make drawings that end by themselves. Files have them.
pytestmark = pytest.mark.every_version


def types(drawing):
    """The curve type of each stroke."""
    return [stroke.curve_type for stroke in drawing.strokes]


def frames(layer):
    """The frames of a layer, and whether each has a drawing."""
    return {frame.frame_number: frame.drawing is not None for frame in layer.frames}


def blank(ob, frame, duration):
    """Blender's Insert Blank Keyframe."""
    bpy.ops.object.mode_set(mode="PAINT_GREASE_PENCIL")
    bpy.context.scene.frame_set(frame)
    bpy.ops.grease_pencil.insert_blank_frame(all_layers=True, duration=duration)
    bpy.ops.object.mode_set(mode="OBJECT")
    if duration and bpy.app.version >= (5, 3, 0):
        pytest.skip("Insert Blank Keyframe of Blender 5.3 says of its duration that it has no effect")


@pytest.fixture
def ended(addon, tmp_path):
    """Footage with contours on frame 1, which end on frame 5; the empty drawing there ends on frame 7."""
    ob = shots.set_up(tmp_path)
    shots.draw(addon, ob, 1, [shots.square(0), shots.diamond(0)])
    blank(ob, 5, 2)
    assert frames(shots.layer_of(ob)) == {1: True, 5: True, 7: False}
    return ob


def test_a_drawing_that_ends_by_itself_is_read(addon, ended):
    gp, st, layer = addon("blender.grease_pencil"), addon("blender.strokes"), shots.layer_of(ended)
    assert gp.frame_numbers(layer) == list(gp.drawings(layer)) == [1, 5]
    assert [st.shown_frame(layer, frame) for frame in (0, 1, 5, 6, 7, 8)] == [None, 1, 5, 5, None, None]
    assert addon("capture.stand").read(ended).keys == {1: 2}
    assert addon("capture.contours").read(ended).layer_names == ["Contours"]


CALLS = {
    "new_key": {},
    "trace_drawing": {},
    "track": {},
    "match_contours": {},
    "make_part": {},
    "fit_strokes": {},
    "paint_bucket": {"place": (30, 30)},
    "in_between": {},
}


@pytest.mark.parametrize("name", CALLS)
def test_what_would_lose_the_end_says_so_and_changes_nothing(addon, ended, name):
    layer = shots.layer_of(ended)
    before = frames(layer)
    bpy.context.scene.frame_set(9)
    with pytest.raises(RuntimeError, match='"Contours" a drawing ends by itself before frame 7.*Insert Blank Keyframe'):
        getattr(bpy.ops.rototoon, name)(**CALLS[name])
    assert frames(layer) == before and [part.name for part in ended.rototoon.parts] == []


def test_scripts_get_the_same_text(addon, ended):
    with pytest.raises(RuntimeError, match="ends by itself before frame 7"):
        addon("scripting").set_key(ended, 1, {"square": shots.square(0)})


def test_new_contours_beside_such_a_drawing_wait(addon, ended):
    assert not addon("capture.arrivals").look(ended)
    assert frames(shots.layer_of(ended)) == {1: True, 5: True, 7: False}


def test_after_the_advice_work_goes_on(addon, ended):
    blank(ended, 7, 0)
    bpy.context.scene.frame_set(9)
    assert bpy.ops.rototoon.new_key() == {"FINISHED"}
    assert frames(shots.layer_of(ended)) == dict.fromkeys((1, 5, 7, 9), True)


def test_an_ended_drawing_is_not_exported_on_later_frames(addon, fake, tmp_path):
    ob = shots.set_up(tmp_path)
    ob.data.layers.new("Lines")
    blank(ob, 5, 2)
    add(addon, ob, "Lines", 5, [[(0, 1), (1, 1.5)]])
    ob.data.layers.new("Other")
    for frame in (1, 6, 8):
        add(addon, ob, "Other", frame, [[(0, 0), (1, 0.5)]])
    assert frames(ob.data.layers["Lines"]) == {5: True, 7: False}
    bpy.ops.rototoon.export_document(filepath=str(tmp_path / "out.json"), layers="ALL")
    document = json.loads((tmp_path / "out.json").read_text())
    assert {each["frame"]: len(each["strokes"]) for each in document["drawings"]} == {1: 1, 5: 2, 6: 2, 8: 1}


def test_frames_that_share_a_drawing_are_written_apart(addon):
    gp, ob = addon("blender.grease_pencil"), drawing_object(addon)
    add(addon, ob, "Lines", 1, [[(0, 0), (1, 0), (1, 1)]])
    layer = ob.data.layers["Lines"]
    for number in (5, 9):
        layer.frames.copy(1, number, instance_drawing=True)
    gp.set_keyframe_type(layer, {5: gp.GENERATED, 9: "BREAKDOWN"})
    gp.make_frames(layer, [5, 7], gp.GENERATED)
    rows = addon("blender.stroke_rows").Rows(np.array([2], np.int32), {"position": np.zeros((2, 3), np.float32), gp.MADE: np.array([True])})
    addon("blender.stroke_rows").replace_made(gp.drawings(layer)[5][0], rows)
    found = gp.drawings(layer)
    assert {frame: len(gp.offsets(handle)) - 1 for frame, (handle, _) in found.items()} == {1: 1, 5: 2, 7: 0, 9: 1}
    assert [kind for _, kind in found.values()] == [gp.KEYFRAME, gp.GENERATED, gp.GENERATED, "BREAKDOWN"]
    gp.make_own(layer, [1, 9])
    assert all(handle.user_count == 1 for handle, _ in gp.drawings(layer).values())


def test_a_key_from_several_frames_keeps_its_curves(addon, tmp_path):
    ob = shots.set_up(tmp_path)
    scripting, gp = addon("scripting"), addon("blender.grease_pencil")
    scripting.set_key(ob, 1, {"square": shots.square(0)})
    scripting.set_key(ob, 3, {"diamond": shots.diamond(2), "third": shots.diamond(2) + 20})
    first = gp.drawings(shots.layer_of(ob))[1][0]
    first.set_types(type="BEZIER", indices=[0])
    handles = gp.positions(first, 4) + np.float32(0.25)
    for side in ("handle_left", "handle_right"):
        attribute = first.attributes.get(side) or first.attributes.new(side, "FLOAT_VECTOR", "POINT")
        attribute.data.foreach_set("vector", handles.ravel())
    bpy.context.scene.frame_set(9)
    assert bpy.ops.rototoon.new_key() == {"FINISHED"}
    made = gp.drawings(shots.layer_of(ob))[9][0]
    numbers, kinds = gp.value(made, gp.PART, 3).tolist(), types(made)
    starts = gp.offsets(made)
    place = numbers.index(1)
    assert [kind == types(first)[0] for kind in kinds] == [number == 1 for number in numbers]
    assert gp.get(made, "handle_left", 12)[starts[place] : starts[place + 1]] == pytest.approx(handles)


@pytest.mark.parametrize("kind", ["BEZIER", "NURBS", "CATMULL_ROM", "POLY"])
def test_tracked_contours_are_polylines_whatever_the_weights(addon, tmp_path, kind):
    gp, st, weights = addon("blender.grease_pencil"), addon("blender.strokes"), addon("capture.weights")
    ob = shots.set_up(tmp_path)
    ob.vertex_groups.new(name="Soft")
    addon("scripting").set_key(ob, 1, {"square": shots.square(0)})
    layer = shots.layer_of(ob)
    gp.drawings(layer)[1][0].set_types(type=kind, indices=[0])
    keys = weights.Keys(layer)
    gp.make_frames(layer, [4], gp.GENERATED)
    keys.begin(layer, 4, addon("blender.stroke_rows").Rows(np.array([4], np.int32), {gp.PART: np.array([1], np.int32)}))
    key, made = (st.read(gp.drawings(layer)[frame][0]) for frame in (1, 4))
    assert (made.types.tolist(), made.sizes.tolist()) == ([st.POLY], [4])
    assert made.point["position"] == pytest.approx(key.point["position"])

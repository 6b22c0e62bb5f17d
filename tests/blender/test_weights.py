"""Weights of vertex groups stay with strokes: through Track, corrections, New Key Here and In-between."""

import bpy
import numpy as np
import pytest
import shots

if "set_vertex_weights" not in bpy.types.GreasePencilDrawing.bl_rna.functions:
    pytest.skip("this Blender lets no script set weights", allow_module_level=True)

WEIGHTED, PLAIN = [5] * 4, [0] * 4


def lifted(ob, frame):
    """By point how far a modifier moves it that looks at the weights: 5 where the weight is 1."""
    bpy.context.scene.frame_set(frame)
    moved = ob.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    return [round(point.vector[1]) for point in moved.layers[0].current_frame().drawing.attributes["position"].data]


@pytest.fixture
def ob(addon, fake, tmp_path):
    """Square and diamond on two keys. The square has weights, and a modifier looks at them."""
    ob = shots.set_up(tmp_path)
    ob.vertex_groups.new(name="arm")
    for frame in (1, 9):
        drawing = shots.draw(addon, ob, frame, [shots.square(frame - 1), shots.diamond(frame - 1)])
        drawing.set_vertex_weights("arm", [0, 1, 2, 3], [1.0] * 4, assign_mode="REPLACE")
    modifier = ob.modifiers.new("lift", "GREASE_PENCIL_OFFSET")
    modifier.location, modifier.vertex_group_name = (0, 5, 0), "arm"
    bpy.ops.rototoon.match_contours()
    return ob


def test_tracked_contours_have_the_weights_of_the_keys(addon, ob):
    bpy.ops.rototoon.track()
    assert [lifted(ob, frame) for frame in (1, 2, 5, 8, 9)] == [WEIGHTED + PLAIN] * 5
    shots.move(addon, ob, 5, 1, (4, 4))
    bpy.ops.rototoon.track()
    bpy.context.scene.frame_set(6)
    bpy.ops.rototoon.new_key()
    bpy.ops.rototoon.track()
    assert [lifted(ob, frame) for frame in range(1, 10)] == [WEIGHTED + PLAIN] * 9
    kinds = [kind for _, kind in addon("blender.grease_pencil").drawings(shots.layer_of(ob)).values()]
    assert kinds == ["KEYFRAME", *["GENERATED"] * 4, "KEYFRAME", *["GENERATED"] * 2, "KEYFRAME"]


def test_the_result_is_the_same_as_without_weights(addon, ob):
    bpy.ops.rototoon.track()
    with_weights = shots.snapshot(ob)
    bpy.ops.rototoon.clear_generated(corrected=True)
    ob.vertex_groups.clear()
    bpy.ops.rototoon.track()
    assert shots.snapshot(ob) == with_weights


def test_in_betweens_have_the_weights_of_the_earlier_key(addon, library, tmp_path):
    gp = addon("blender.grease_pencil")
    data = gp.datablocks().new("ink")
    ob = bpy.data.objects.new("ink", data)
    bpy.context.scene.collection.objects.link(ob)
    bpy.context.view_layer.objects.active = ob
    layer = data.layers.new("ink")
    ob.vertex_groups.new(name="arm")
    for frame in (1, 9):
        drawing = layer.frames.new(frame).drawing
        drawing.add_strokes([4])
        gp.put(drawing, "position", np.array([[x + 0.3 * frame, 0, 0.3 * x] for x in range(4)], np.float32))
        drawing.set_vertex_weights("arm", [2, 3], [1.0] * 2, assign_mode="REPLACE")
    modifier = ob.modifiers.new("lift", "GREASE_PENCIL_OFFSET")
    modifier.location, modifier.vertex_group_name = (0, 5, 0), "arm"
    bpy.ops.rototoon.in_between(frames="ALL")
    assert [lifted(ob, frame) for frame in range(1, 10)] == [[0, 0, 5, 5]] * 9


@pytest.mark.parametrize("group", [True, False])
def test_strokes_that_get_other_points_are_said_to_lose_weights(addon, library, group):
    from test_strokes import add, circle, drawing_object, wave

    ob = drawing_object(addon, ("Lines", "Cover"))
    add(addon, ob, "Lines", 1, [wave(200)])
    add(addon, ob, "Cover", 1, [circle((1.0, 0), 0.5)], cyclic=True)
    if group:
        ob.vertex_groups.new(name="arm")
    reports = addon("scripting").take_reports
    reports()
    bpy.ops.rototoon.fit_strokes(unit="WORLD", tolerance=0.01)
    bpy.ops.rototoon.hidden_lines(covers="CLOSED")
    said = [report.text for report in reports()]
    assert len(said) == 2 and "fitted" in said[0] and "hidden line" in said[1]
    assert all(("has 1 vertex group, and weights do not follow" in text) == group for text in said)

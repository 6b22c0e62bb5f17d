"""In-betweens of strokes that were traced or carried: their numbers say which is which."""

import bpy
import numpy as np
import pytest
from test_strokes import add, content, drawing, drawing_object
from test_tween import limb, tracks

pytestmark = pytest.mark.usefixtures("library")


def crossing(addon, carried=True):
    """Two limbs of the same shape that change places between the keys 1 and 5. With `carried`, their numbers are those of tracing."""
    ob = drawing_object(addon)
    gp, drawings, marks = addon("blender.grease_pencil"), addon("lines.drawings"), addon("blender.marks")
    for frame, numbers in ((1, [1, 2]), (5, [2, 1])):
        handle = add(addon, ob, "Lines", frame, [limb(0, 0, 0.5), limb(4, 0, 0.5)])
        gp.put(handle, gp.TRACK, np.array(numbers, np.int32))
        if carried:
            found = content(addon, ob, "Lines", frame)
            drawings.mark(found, marks.Slots(ob.data))
            gp.put(handle, gp.LINE, found.point[gp.LINE])
    bpy.context.scene.frame_set(1)
    return ob


def middles(addon, ob, frame):
    """Where the strokes of a frame are, from left to right, by number."""
    found = content(addon, ob, "Lines", frame)
    points = np.split(found.point["position"][:, 0], found.starts[1:-1])
    return dict(zip(found.curve["rototoon_track"].tolist(), [float(each.mean()) for each in points]))


def test_carried_strokes_are_pairs(addon):
    ob = crossing(addon)
    assert bpy.ops.rototoon.in_between(spacing="LINEAR", arcs=0.0) == {"FINISHED"}
    assert tracks(addon, ob, 5) == [2, 1], "they keep their numbers"
    first, middle, last = (middles(addon, ob, frame) for frame in (1, 3, 5))
    assert all(middle[n] == pytest.approx((first[n] + last[n]) / 2, abs=0.1) for n in (1, 2))
    bpy.ops.rototoon.update_in_betweens()
    assert addon("common.reports").take()[-1].text == "Nothing had changed"


def test_numbers_of_in_between_itself_are_found_anew(addon):
    ob = crossing(addon, carried=False)
    bpy.ops.rototoon.in_between()
    assert tracks(addon, ob, 5) == [1, 2]


def test_strokes_that_are_probably_others_are_matched(addon):
    ob = crossing(addon)
    gp = addon("blender.grease_pencil")
    gp.put(drawing(addon, ob, "Lines", 5), gp.CONFIDENCE, np.full(48, 0.2))
    bpy.ops.rototoon.in_between()
    assert tracks(addon, ob, 5) == [1, 2]


def test_a_pair_by_hand_wins_and_can_be_undone(addon):
    ob = crossing(addon)
    module = addon("tween.pairing")
    found = module.Pairing(ob, [ob.data.layers["Lines"]], 1)

    def pairs():
        found.take(found.match())
        return {(row.earlier, row.later, row.by_hand) for row in found.pairs}

    assert pairs() == {(0, 1, False), (1, 0, False)}
    left, right = module.Item(0, 0, 0), module.Item(0, 1, 0)
    assert not found.click(left) and found.click(right)
    assert (0, 0, True) in pairs()
    assert found.undo() and pairs() == {(0, 1, False), (1, 0, False)}
    assert found.free(left)
    assert (0, -1, True) in pairs(), "the pair of the numbers is taken apart"

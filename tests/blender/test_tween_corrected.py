"""An in-between that the artist corrects becomes a breakdown, and its strokes stay the strokes that they were."""

import bpy
import numpy as np
import pytest
from test_strokes import add, content, drawing, drawing_object
from test_tween import figure, frames, limb, move, scribble, tracks
from test_tween_pairs import pairing_of

pytestmark = pytest.mark.usefixtures("library")


def swapped(addon, rows=((0, 1), (1, 0))):
    """The figure on two keys. The artist paired its strokes crosswise, which the library would not."""
    ob = drawing_object(addon)
    for k, frame in enumerate((1, 9)):
        add(addon, ob, "Lines", frame, figure(1.5 * k, 0.3 * k))
    bpy.context.scene.frame_set(1)
    decide(addon, ob, 1, rows)
    bpy.ops.rototoon.in_between(spacing="LINEAR")
    return ob


def decide(addon, ob, frame, rows):
    module, found = pairing_of(addon, ob, frame)
    for i, j in rows:
        if j is None:
            found.free(module.Item(0, 0, i))
        else:
            found.click(module.Item(0, 0, i))
            found.click(module.Item(0, 1, j))
    found.take(found.match())
    found.store()


def points_of(addon, ob, frame, index):
    starts = content(addon, ob, "Lines", frame).starts
    return slice(starts[index], starts[index + 1])


def correct(addon, ob, frame, index=0, by=0.2):
    move(addon, ob, frame, index=points_of(addon, ob, frame, index), by=by)


def draw_new(addon, ob, frame, line):
    """One more stroke, as a hand draws it."""
    kind = frames(addon, ob)[frame]
    add(addon, ob, "Lines", frame, [line])
    addon("blender.grease_pencil").set_keyframe_type(ob.data.layers["Lines"], {frame: kind})


def paired(addon, ob, frame):
    """The pairs between the keys around a frame, by index, and which of them are the artist's."""
    _, found = pairing_of(addon, ob, frame)
    return {(row.earlier, row.later): row.by_hand for row in found.pairs}


def test_pairs_by_hand_hold_on_both_sides_of_a_corrected_in_between(addon):
    ob = swapped(addon)
    before = tracks(addon, ob, 5)
    correct(addon, ob, 5)
    bpy.ops.rototoon.update_in_betweens()
    assert frames(addon, ob)[5] == "BREAKDOWN" and tracks(addon, ob, 5) == before == tracks(addon, ob, 1)
    assert tracks(addon, ob, 9) == [before[k] for k in (1, 0, 2)]
    assert paired(addon, ob, 2) == {(0, 0): True, (1, 1): True, (2, 2): False}
    assert paired(addon, ob, 6) == {(0, 1): True, (1, 0): True, (2, 2): False}


def test_they_hold_after_later_edits_of_keys_and_a_second_correction(addon):
    ob = swapped(addon)
    before = tracks(addon, ob, 1)
    for frame in (5, 3, 7):
        correct(addon, ob, frame)
    bpy.ops.rototoon.update_in_betweens()
    correct(addon, ob, 6)
    correct(addon, ob, 1)
    correct(addon, ob, 9)
    bpy.ops.rototoon.update_in_betweens()
    assert [frame for frame, kind in frames(addon, ob).items() if kind == "BREAKDOWN"] == [3, 5, 6, 7]
    assert all(tracks(addon, ob, frame) == before for frame in range(1, 9))
    assert tracks(addon, ob, 9) == [before[k] for k in (1, 0, 2)]
    assert paired(addon, ob, 8) == {(0, 1): True, (1, 0): True, (2, 2): False}


def test_found_pairs_hold_too_whatever_the_correction_looks_like(addon):
    ob = drawing_object(addon)
    for k, frame in enumerate((1, 9)):
        add(addon, ob, "Lines", frame, figure(1.5 * k, 0.3 * k))
    bpy.context.scene.frame_set(1)
    bpy.ops.rototoon.in_between(spacing="LINEAR")
    before = tracks(addon, ob, 1)
    # Two strokes change places: matched anew, each would be the other one.
    for index, by in ((0, 3.0), (1, -3.0)):
        correct(addon, ob, 5, index, by)
    bpy.ops.rototoon.update_in_betweens()
    assert all(tracks(addon, ob, frame) == before for frame in range(1, 10))


def test_strokes_that_are_new_or_gone_are_matched(addon):
    ob = swapped(addon)
    before = tracks(addon, ob, 1)
    line = content(addon, ob, "Lines", 5).point["position"][points_of(addon, ob, 5, 2)][:, [0, 2]]
    addon("blender.grease_pencil").remove_strokes(drawing(addon, ob, "Lines", 5), [2])
    draw_new(addon, ob, 5, line[::-1] + 0.05)
    bpy.ops.rototoon.update_in_betweens()
    assert tracks(addon, ob, 5) == before, "the new stroke is found in the place of the old one"
    assert paired(addon, ob, 6) == {(0, 1): True, (1, 0): True, (2, 2): False}


def test_a_stroke_without_counterpart_goes_on_up_to_the_breakdown(addon):
    ob = swapped(addon, rows=((0, None),))
    correct(addon, ob, 5)
    bpy.ops.rototoon.update_in_betweens()
    mine, later = tracks(addon, ob, 5), tracks(addon, ob, 9)
    own = mine.index(tracks(addon, ob, 1)[0])
    assert paired(addon, ob, 2)[0, own] is False, "it goes on to the breakdown"
    rows = paired(addon, ob, 6)
    assert rows[own, -1] is True and mine[own] not in later
    assert rows[mine.index(later[0]), 0] is False, "the stroke that appears comes from the breakdown"


def test_decisions_on_a_breakdown_win(addon):
    ob = swapped(addon)
    correct(addon, ob, 5)
    bpy.ops.rototoon.update_in_betweens()
    decide(addon, ob, 6, ((0, 0), (1, 1)))
    bpy.ops.rototoon.update_in_betweens()
    assert tracks(addon, ob, 9) == tracks(addon, ob, 5) == tracks(addon, ob, 1)


def test_match_strokes_knows_a_corrected_in_between_before_an_update(addon):
    ob = swapped(addon)
    correct(addon, ob, 5)
    assert paired(addon, ob, 6) == {(0, 1): True, (1, 0): True, (2, 2): False}
    bpy.ops.rototoon.update_in_betweens()
    assert paired(addon, ob, 6) == {(0, 1): True, (1, 0): True, (2, 2): False}


def test_a_correction_does_not_make_a_guess_sure(addon):
    ob = drawing_object(addon)
    for seed, frame in enumerate((1, 9)):
        add(addon, ob, "Lines", frame, scribble(seed))
    bpy.context.scene.frame_set(1)
    bpy.ops.rototoon.in_between()
    assert "can be believed" in addon("common.reports").take()[-1].text
    correct(addon, ob, 5, by=0.05)
    bpy.ops.rototoon.update_in_betweens()
    (said,) = addon("common.reports").take()[-1].warnings
    assert said.startswith("frames 5 to 9"), said
    numbers = content(addon, ob, "Lines", 5).curve["rototoon_sides"]
    assert set(numbers.tolist()) == {1}


def test_in_betweens_of_earlier_versions_are_taken_by_their_numbers(addon):
    ob = swapped(addon)
    for frame, kind in frames(addon, ob).items():
        if kind == "GENERATED":
            attributes = drawing(addon, ob, "Lines", frame).attributes
            attributes.remove(attributes["rototoon_sides"])
    correct(addon, ob, 5)
    bpy.ops.rototoon.update_in_betweens()
    assert tracks(addon, ob, 5) == tracks(addon, ob, 1)
    assert paired(addon, ob, 6) == {(0, 1): True, (1, 0): True, (2, 2): False}


def test_a_doubled_stroke_has_its_counterpart_once(addon):
    ob = swapped(addon)
    line = limb(4, 4, 0.5)
    draw_new(addon, ob, 5, line)
    handle = drawing(addon, ob, "Lines", 5)
    for name in ("rototoon_track", "rototoon_sides"):
        values = content(addon, ob, "Lines", 5).curve[name].copy()
        values[3] = values[0]
        addon("blender.grease_pencil").put(handle, name, values)
    bpy.ops.rototoon.update_in_betweens()
    found = tracks(addon, ob, 5)
    assert found[:3] == tracks(addon, ob, 1) and found[3] not in found[:3]
    assert np.isfinite(content(addon, ob, "Lines", 7).point["position"]).all()

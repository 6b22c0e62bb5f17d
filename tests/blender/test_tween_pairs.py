"""Pairs of strokes that the artist decides, in Match Strokes, and what becomes of them."""

import bpy
import numpy as np
import pytest
from test_strokes import add, content, drawing
from test_tween import KEYS, drawn_again, figure, keyed, mark, tracks

pytestmark = pytest.mark.usefixtures("library")


def pairing_of(addon, ob, frame=1):
    module = addon("tween.pairing")
    found = module.Pairing(ob, list(ob.data.layers), frame)
    found.take(found.match())
    return module, found


def test_pairs_made_by_hand_are_kept_through_a_file(addon, tmp_path):
    ob = keyed(addon)
    bpy.context.scene.frame_set(4)
    bpy.ops.rototoon.match_strokes()
    assert tracks(addon, ob, 1) == tracks(addon, ob, 9)
    module, found = pairing_of(addon, ob, 4)
    assert not found.click(module.Item(0, 0, 0))
    assert found.click(module.Item(0, 1, 1))
    found.take(found.match())
    assert found.row_of(module.Item(0, 0, 0)).later == 1 and found.row_of(module.Item(0, 0, 0)).by_hand
    found.store()
    path = str(tmp_path / "pairs.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    ob = bpy.data.objects["Drawing"]
    bpy.context.view_layer.objects.active = ob
    bpy.ops.rototoon.in_between()
    numbers = tracks(addon, ob, 1)
    assert tracks(addon, ob, 9)[1] == numbers[0]
    # The pair goes with the strokes, whatever their order.
    handle = drawing(addon, ob, "Lines", 9)
    handle.reorder_strokes([2, 1, 0]) if hasattr(handle, "reorder_strokes") else None
    addon("blender.grease_pencil").remove_frames(ob.data.layers["Lines"], range(2, 9))
    before = content(addon, ob, "Lines", 9).curve["rototoon_before"]
    bpy.ops.rototoon.in_between()
    assert tracks(addon, ob, 9)[int(np.flatnonzero(before)[0])] == numbers[0]


def test_pairs_touch_their_span_alone(addon):
    ob = keyed(addon, KEYS)
    bpy.ops.rototoon.in_between(frames="ALL", spacing="LINEAR")
    mark(addon, ob)
    module, found = pairing_of(addon, ob, 20)
    found.click(module.Item(0, 1, 2))
    assert found.click(module.Item(0, 0, 0))
    bpy.ops.rototoon.update_in_betweens()
    assert drawn_again(addon, ob) == list(range(18, 25))
    # Behind it strokes have the numbers of those that they follow from now on.
    for first, last in zip(KEYS[3:], KEYS[4:]):
        assert all(tracks(addon, ob, f) == tracks(addon, ob, first) for f in range(first, last + 1))


def test_strokes_are_freed_and_decisions_taken_back(addon):
    ob = keyed(addon)
    module, found = pairing_of(addon, ob)
    item = module.Item(0, 0, 1)
    assert found.free(item)
    found.take(found.match())
    row = found.row_of(item)
    assert (row.later, row.by_hand) == (-1, True)
    assert [m.label for m in found.marks()].count("–") == 2
    assert found.free(item)
    found.take(found.match())
    assert found.row_of(item).later == 1 and not found.row_of(item).by_hand
    found.click(item)
    found.click(module.Item(0, 1, 0))
    assert found.free(module.Item(0, 1, 2))
    found.take(found.match())
    assert "2 decided by hand" in found.summary()
    assert found.undo() and found.undo() and found.undo() and found.undo() and not found.undo()
    found.take(found.match())
    assert found.summary() == "3 pairs"
    assert found.free(None) is False and found.click(None) is False


def test_clicks_find_strokes(addon):
    ob = keyed(addon)
    module, found = pairing_of(addon, ob)
    # The front view, 100 pixels a unit, (0, 0) in the middle of 800 by 600.
    view = np.array([[0.25, 0, 0, 0], [0, 0, 1 / 3, 0], [0, 0, 0, 0], [0, 0, 0, 1]])
    size = (800, 600)
    at = lambda p: (400 + 100 * p[0], 300 + 100 * p[1])  # noqa: E731
    first, second = figure(0, 0), figure(1.5, 0.3)
    assert found.pick(at(first[1][9] + [0.05, 0]), view, size) == module.Item(0, 0, 1)
    assert found.pick(at(second[0][20]), view, size) == module.Item(0, 1, 0)
    assert found.pick((5, 5), view, size) is None
    found.click(module.Item(0, 1, 0))
    assert found.marks()[[m.side for m in found.marks()].index(1)].colour == module.PICKED
    # With a stroke of the later key picked, one of the earlier key is looked for first.
    across = found.pick(at(second[0][3]), view, size)
    assert across is None or across.side == 0 or across == module.Item(0, 1, 0)


def test_match_strokes_names_what_in_between_does_not_carry_out(addon, monkeypatch):
    ob = keyed(addon)
    doubted = addon("tween.doubted")
    match = doubted.match

    def doubting(drawings, progress=None):
        found = match(drawings, progress)
        # The first stroke of the earlier key, and the third one of the later key.
        found.strokes = {0, 5}
        return found

    monkeypatch.setattr(doubted, "match", doubting)
    bpy.ops.rototoon.match_strokes()
    report = addon("scripting").take_reports()[-1]
    assert report.kind == "WARNING" and report.text.startswith("3 pairs; ")
    assert report.warnings[0].startswith("doubtful, so that In-between does not carry them out: frames 1 to 9: 2 of 3 pairs, numbers 1 and 3")
    module, found = pairing_of(addon, ob)
    assert sorted(mark.label for mark in found.marks()) == ["1?", "1?", "2", "2", "3?", "3?"]
    found.click(module.Item(0, 0, 0))
    found.click(module.Item(0, 1, 0))
    found.take(found.match())
    assert sorted(mark.label for mark in found.marks()) == ["1", "1", "2", "2", "3?", "3?"], "what was paired by hand is beyond doubt"


def test_doubts_are_those_of_in_between(addon):
    from test_strokes import drawing_object
    from test_tween import scribble

    ob = drawing_object(addon)
    for seed, frame in enumerate((1, 9)):
        add(addon, ob, "Lines", frame, scribble(seed))
    bpy.context.scene.frame_set(1)
    bpy.ops.rototoon.match_strokes()
    said = addon("scripting").take_reports()[-1]
    assert said.kind == "WARNING", said
    bpy.ops.rototoon.in_between()
    assert "can be believed" in addon("scripting").take_reports()[-1].text
    other = keyed(addon)
    bpy.ops.rototoon.match_strokes()
    assert addon("scripting").take_reports()[-1].kind == "INFO" and len(other.data.layers) == 1


def test_scripts_pair_strokes_by_their_numbers(addon):
    ob = keyed(addon)
    bpy.ops.rototoon.match_strokes()
    assert tracks(addon, ob, 1) == tracks(addon, ob, 9) == [1, 2, 3]
    bpy.ops.rototoon.match_strokes(earlier=1, later=2)
    assert addon("scripting").take_reports()[-1].text.startswith("3 pairs, 1 decided by hand")
    assert tracks(addon, ob, 1) == [1, 2, 3] and tracks(addon, ob, 9)[1] == 1
    bpy.ops.rototoon.in_between()
    assert tracks(addon, ob, 9)[1] == 1


def test_pairs_of_other_keys_do_not_meet_when_a_key_between_is_deleted(addon):
    ob = keyed(addon, (1, 9, 17))
    for frame in (1, 9):
        bpy.context.scene.frame_set(frame)
        bpy.ops.rototoon.match_strokes()
    for frame, number in ((1, 1), (9, 2)):
        bpy.context.scene.frame_set(frame)
        bpy.ops.rototoon.match_strokes(earlier=number, later=number)
    addon("blender.grease_pencil").remove_frames(ob.data.layers["Lines"], [9])
    _, found = pairing_of(addon, ob)
    assert [(row.earlier, row.later, row.by_hand) for row in found.pairs] == [(k, k, False) for k in range(3)]


@pytest.mark.parametrize("side", (0, 1))
def test_scripts_say_that_a_stroke_has_no_counterpart(addon, side):
    ob = keyed(addon)
    bpy.ops.rototoon.match_strokes()
    bpy.ops.rototoon.match_strokes(**dict(zip(("earlier", "later"), (2, -1) if side == 0 else (-1, 2))))
    assert "1 decided by hand" in (text := addon("scripting").take_reports()[-1].text) and "2 without counterpart" in text
    numbers = tracks(addon, ob, 1), tracks(addon, ob, 9)
    assert 2 not in numbers[1] and numbers[0] == [1, 2, 3]
    marks = content(addon, ob, "Lines", (1, 9)[side]).curve[("rototoon_next", "rototoon_before")[side]].tolist()
    (key,) = set(content(addon, ob, "Lines", (9, 1)[side]).curve["rototoon_key"].tolist())
    assert marks == [0, -1 - key, 0] and key > 0


@pytest.mark.parametrize("side", (0, 1))
def test_no_counterpart_is_said_of_one_key(addon, side):
    """A key that is drawn between the two later has the stroke."""
    ob = keyed(addon, (1, 9, 17))
    bpy.ops.rototoon.match_strokes()
    bpy.ops.rototoon.match_strokes(**dict(zip(("earlier", "later"), (1, -1) if side == 0 else (-1, 1))))
    add(addon, ob, "Lines", 5, figure(0.7, 0.1))

    def decided(frame):
        return [(row.earlier, row.later) for row in pairing_of(addon, ob, frame)[1].pairs if row.by_hand]

    assert decided(1) == decided(5) == decided(9) == []
    addon("blender.grease_pencil").remove_frames(ob.data.layers["Lines"], [5])
    assert decided(1) == [(0, -1) if side == 0 else (-1, 0)] and decided(9) == []
    # A decision of an earlier version counts for every neighbour.
    handle, name = drawing(addon, ob, "Lines", (1, 9)[side]), ("rototoon_next", "rototoon_before")[side]
    addon("blender.grease_pencil").put(handle, name, np.array([-1, 0, 0], np.int32))
    add(addon, ob, "Lines", 5, figure(0.7, 0.1))
    assert decided((1, 5)[side]) == [(0, -1) if side == 0 else (-1, 0)]


@pytest.mark.parametrize(
    ("pair", "message"),
    [
        ({"earlier": 1}, "later: found 0, expected the number of a stroke on the later key, or -1 for no counterpart of stroke 1"),
        ({"later": 1}, "earlier: found 0, expected the number"),
        ({"earlier": -1, "later": -1}, "found -1 for both"),
        ({"earlier": 1, "later": 7}, "Frames 1 to 9: no layer has the stroke 1 on the earlier key and the stroke 7 on the later key"),
        ({"earlier": 7, "later": -1}, "no layer has the stroke 7 on the earlier key. Strokes get their numbers"),
    ],
)
def test_a_pair_that_no_layer_has_is_named(addon, pair, message):
    ob = keyed(addon)
    bpy.ops.rototoon.match_strokes()
    before = content(addon, ob, "Lines", 1)
    with pytest.raises(RuntimeError, match=message):
        bpy.ops.rototoon.match_strokes(**pair)
    assert content(addon, ob, "Lines", 1).equals(before)

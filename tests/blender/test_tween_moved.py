"""Keys that are moved in time, alone or with their in-betweens, as in the dope sheet: Update In-betweens draws every span of theirs again."""

import json

import bpy
import numpy as np
import pytest
from test_strokes import add, content, drawing_object
from test_tween import figure, frames, move

pytestmark = pytest.mark.usefixtures("library")
KEYS = (1, 9, 17, 25)
PLACES = (0.0, 1.0, 3.0, 7.0)


def said(addon):
    return addon("scripting").take_reports()[-1]


def drawn(addon, places, spacing="SMOOTH", step=1, by_span=()):
    """A figure at the same places on these frames, with in-betweens."""
    ob = drawing_object(addon)
    for frame, x in places.items():
        add(addon, ob, "Lines", frame, figure(x, 0.05 * x))
    bpy.context.scene.frame_set(min(places))
    bpy.ops.rototoon.in_between(frames="ALL", spacing=spacing, step=step)
    for frame, other in by_span:
        bpy.context.scene.frame_set(frame)
        bpy.ops.rototoon.in_between(frames="CURRENT", spacing=other, step=step)
    addon("scripting").take_reports()
    return ob


def put_on(ob, moves):
    """Gives frames other numbers, all at once, in the place of what lies there."""
    layer = ob.data.layers["Lines"]
    for number in sorted(set(moves.values()) - moves.keys()):
        if any(frame.frame_number == number for frame in layer.frames):
            layer.frames.remove(number)
    for number, away in [(number, number + 1000) for number in moves] + [(number + 1000, to) for number, to in moves.items()]:
        layer.frames.move(number, away)


def places(addon, ob):
    return {frame: content(addon, ob, "Lines", frame).point["position"] for frame in sorted(frames(addon, ob))}


def same(one, other):
    assert list(one) == list(other)
    assert all(np.array_equal(one[frame], other[frame]) for frame in one)


MOVES = {
    "two keys later": {17: 20, 25: 28},
    "three keys later": {9: 12, 17: 20, 25: 28},
    "two keys earlier": {17: 12, 25: 20},
    "by just a span": {17: 25, 25: 33},
    "far away": {17: 117, 25: 125},
    "all keys": {1: 4, 9: 12, 17: 20, 25: 28},
    "one key": {17: 14},
    "the last key": {25: 22},
}


@pytest.mark.parametrize("moves", MOVES.values(), ids=MOVES)
@pytest.mark.parametrize(("spacing", "step"), [("SMOOTH", 1), ("LINEAR", 2)])
def test_spans_of_moved_keys_are_as_if_drawn_there(addon, moves, spacing, step):
    ob = drawn(addon, dict(zip(KEYS, PLACES)), spacing, step)
    put_on(ob, moves)
    bpy.ops.rototoon.update_in_betweens()
    report = said(addon)
    assert report.kind == "INFO" and "key" not in report.text, report.text
    found = places(addon, ob)
    other = drawn(addon, {moves.get(frame, frame): x for frame, x in zip(KEYS, PLACES)}, spacing, step)
    same(found, places(addon, other))


@pytest.mark.parametrize("by", (3, -3, 8, 100))
@pytest.mark.parametrize("first", (9, 17))
def test_in_betweens_that_move_with_their_keys_stay_in_betweens(addon, first, by):
    ob = drawn(addon, dict(zip(KEYS, PLACES)))
    put_on(ob, {frame: frame + by for frame in frames(addon, ob) if frame >= first})
    bpy.ops.rototoon.update_in_betweens()
    assert "changed" not in (report := said(addon)).text and report.kind == "INFO", report.text
    moved = {frame + by * (frame >= first): x for frame, x in zip(KEYS, PLACES)}
    found = places(addon, ob)
    other = drawn(addon, moved)
    same(found, places(addon, other))


def test_in_betweens_on_other_frames_go_on_following(addon):
    ob = drawn(addon, dict(zip(KEYS, PLACES)))
    put_on(ob, {frame: frame + 3 for frame in frames(addon, ob) if frame >= 17})
    bpy.ops.rototoon.update_in_betweens()
    before = places(addon, ob)
    move(addon, ob, 28, index=slice(None), by=2.0)
    bpy.ops.rototoon.update_in_betweens()
    after = places(addon, ob)
    assert all(not np.array_equal(before[frame], after[frame]) for frame in range(21, 29))


def test_spans_keep_their_own_choices_on_other_frames(addon):
    ob = drawn(addon, dict(zip(KEYS, PLACES)), by_span=((10, "EASE_IN"), (20, "LINEAR")))
    put_on(ob, {17: 12, 25: 14})
    bpy.ops.rototoon.update_in_betweens()
    spans = json.loads(ob.data["rototoon_tween"])["Lines"]["spans"]
    assert {k: (v["last"], v["choices"]["spacing"]) for k, v in spans.items()} == {"1": (9, "SMOOTH"), "9": (12, "EASE_IN"), "12": (14, "LINEAR")}


def test_a_copy_of_a_key_is_a_new_key(addon):
    ob = drawn(addon, dict(zip(KEYS, PLACES)), "EASE_IN")
    ob.data.layers["Lines"].frames.remove(12)
    ob.data.layers["Lines"].frames.copy(9, 12)
    bpy.ops.rototoon.update_in_betweens()
    spans = json.loads(ob.data["rototoon_tween"])["Lines"]["spans"]
    assert {int(k): v["last"] for k, v in spans.items()} == {1: 9, 9: 12, 12: 17, 17: 25}


def test_poses_of_a_cycle_are_told_apart_by_their_neighbours(addon):
    ob = drawn(addon, dict(zip((1, 9, 17, 25), (0.0, 2.0, 0.0, 2.0))), "LINEAR", by_span=((18, "EASE_IN"),))
    put_on(ob, {frame: frame + 16 for frame in (9, 17, 25)})
    bpy.ops.rototoon.update_in_betweens()
    spans = json.loads(ob.data["rototoon_tween"])["Lines"]["spans"]
    found = {int(k): (v["last"], v["choices"]["spacing"]) for k, v in spans.items()}
    assert found == {1: (25, "LINEAR"), 25: (33, "LINEAR"), 33: (41, "EASE_IN")}


def test_a_moved_key_that_was_changed_too_keeps_its_spans(addon):
    ob = drawn(addon, dict(zip(KEYS, PLACES)))
    put_on(ob, {17: 20, 25: 28})
    for frame in (20, 28):
        move(addon, ob, frame, index=slice(None), by=0.3)
    bpy.ops.rototoon.update_in_betweens()
    found = places(addon, ob)
    assert list(found) == list(range(1, 29))
    bpy.ops.rototoon.clear_in_betweens()
    bpy.ops.rototoon.in_between(frames="ALL")
    same(found, places(addon, ob))


def test_what_a_moved_key_leaves_behind_goes_and_holds_stay_held(addon):
    ob = drawing_object(addon)
    for frame, x in zip(KEYS, PLACES):
        add(addon, ob, "Lines", frame, figure(x, 0.05 * x))
    bpy.context.scene.frame_set(1)
    bpy.ops.rototoon.in_between(frames="CURRENT")
    put_on(ob, {9: 6})
    bpy.ops.rototoon.update_in_betweens()
    assert list(frames(addon, ob)) == [1, 2, 3, 4, 5, 6, 17, 25]


def test_a_changed_in_between_on_another_frame_is_the_artists(addon):
    ob = drawn(addon, dict(zip(KEYS, PLACES)))
    move(addon, ob, 20, by=0.4)
    put_on(ob, {frame: frame + 3 for frame in frames(addon, ob) if frame >= 17})
    bpy.ops.rototoon.update_in_betweens()
    assert "1 drawing that you had changed is a key now: frame 23" in said(addon).text
    assert frames(addon, ob)[23] == "BREAKDOWN"


@pytest.mark.parametrize("by", (0, 8, 3))
def test_clearing_around_the_playhead_forgets_the_span_that_lies_there(addon, by):
    ob = drawn(addon, dict(zip(KEYS, PLACES)), "LINEAR")
    put_on(ob, {frame: frame + by for frame in range(1, 26)})
    bpy.context.scene.frame_set(4 + by)
    bpy.ops.rototoon.clear_in_betweens(frames="CURRENT")
    assert said(addon).text == "7 in-betweens removed"
    move(addon, ob, 25 + by, by=0.4)
    bpy.ops.rototoon.update_in_betweens()
    there = [frame - by for frame in frames(addon, ob)]
    assert there == [1, *range(9, 26)], "what was cleared does not come back"
    # Spans of moved keys are drawn again in any case.
    assert said(addon).text.startswith("14 in-betweens in 2 spans" if by else "7 in-betweens in 1 span")


def test_a_new_key_in_a_span_that_was_moved_divides_what_is_cleared(addon):
    ob = drawn(addon, dict(zip(KEYS, PLACES)), "LINEAR")
    put_on(ob, {frame: frame + 8 for frame in range(1, 26)})
    move(addon, ob, 13, by=0.4)
    bpy.context.scene.frame_set(10)
    bpy.ops.rototoon.clear_in_betweens(frames="CURRENT")
    assert list(frames(addon, ob)) == [9, *range(13, 34)]
    bpy.ops.rototoon.update_in_betweens()
    assert list(frames(addon, ob)) == [9, *range(13, 34)]


def test_records_of_earlier_versions_follow_by_what_lies_there(addon):
    ob = drawn(addon, dict(zip(KEYS, PLACES)), "LINEAR")
    kept = json.loads(ob.data["rototoon_tween"])
    for span in kept["Lines"]["spans"].values():
        del span["ends"]
    ob.data["rototoon_tween"] = json.dumps(kept)
    put_on(ob, {17: 20, 25: 28})
    bpy.ops.rototoon.update_in_betweens()
    found = places(addon, ob)
    other = drawn(addon, {1: 0.0, 9: 1.0, 20: 3.0, 28: 7.0}, "LINEAR")
    same(found, places(addon, other))

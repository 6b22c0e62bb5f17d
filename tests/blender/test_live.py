"""The live mode: edits are tracked by themselves. In background no timer runs, so the tests call its step."""

import math
import time

import bpy
import numpy as np
import pytest
import shots
from live_stage import drawings, hold, session, settle, switched_on, work_off

RESTING = ("Follows your edits", "CHECKMARK")


def test_toggle_tracks_what_is_there_and_then_rests(addon, fake, live, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    assert not ob.rototoon.live
    assert live.step(math.inf) is None
    ob.rototoon.live = True
    settle(live)
    assert sorted(drawings(ob)) == list(range(1, 10))
    assert np.abs(dict(shots.pixels(addon, ob, 5))[2] - shots.square(4)).max() < 1e-3
    before = shots.snapshot(ob)
    assert settle(live) == 0
    ob.data.update_tag()
    assert settle(live) == 0 and shots.snapshot(ob) == before


def test_moved_point_is_a_pin_and_only_its_span_is_solved(addon, fake, live, tmp_path):
    ob = switched_on(addon, live, tmp_path)
    solve = fake.solve

    def spread(part, first, last):
        """The stand-in leaves a pin's neighbours; a tracker doesn't."""
        found = solve(part, first, last)
        for frame, pins in part.get("pins", {}).items():
            if first < int(frame) < last:
                for near in range(first + 1, last):
                    for index, place in pins.items():
                        away = np.array(place) - found[near][int(index)]
                        found[near][int(index)] += away / (1 + abs(near - int(frame)))
        return found

    fake.solve = spread
    try:
        before = drawings(ob)
        shots.move(addon, ob, 3, 2, (5.0, -3.0), which=[1])
        moved = dict(shots.pixels(addon, ob, 3))[2]
        settle(live)
    finally:
        fake.solve = solve
    after = drawings(ob)
    assert session(addon, ob).solved == [("Part 2", 1, 5)]
    assert [frame for frame in after if after[frame] != before[frame]] == [2, 3, 4]
    assert {after[f][0] for f in (2, 3, 4)} == {"GENERATED"}
    assert np.array_equal(dict(shots.pixels(addon, ob, 3))[2], moved)
    gp = addon("blender.grease_pencil")
    handle = gp.drawings(shots.layer_of(ob))[3][0]
    assert list(np.flatnonzero(gp.value(handle, gp.PIN, 8))) == [5]
    # What was written is not taken for an edit.
    assert settle(live) == 0


def test_own_writing_is_not_taken_for_an_edit(addon, fake, live, tmp_path, monkeypatch):
    ob = switched_on(addon, live, tmp_path)
    document, reads = addon("capture.document"), []
    reading = document.reading
    monkeypatch.setattr(document, "reading", lambda *args, **options: (reads.append(1), reading(*args, **options))[1])
    shots.move(addon, ob, 3, 2, (5.0, -3.0), which=[1])
    settle(live)
    assert len(reads) == 2, "at the beginning and at the end"
    bpy.context.view_layer.update()
    assert live.step(math.inf) is None and len(reads) == 2


@pytest.mark.parametrize(("meaning", "field"), [("KEEP", "pins"), ("SETTLE", "centers")])
def test_moved_line_holds_as_the_setting_says(addon, fake, live, tmp_path, meaning, field):
    ob = switched_on(addon, live, tmp_path)
    ob.rototoon.moved_line = meaning
    shots.move(addon, ob, 7, 1, (9.0, 4.0))
    settle(live)
    assert session(addon, ob).solved == [("Part 1", 5, 9)]
    assert list(session(addon, ob).state["parts"][0][field]) == ["7"]


def test_keys_new_moved_and_deleted(addon, fake, live, tmp_path):
    ob = switched_on(addon, live, tmp_path)
    bpy.context.scene.frame_set(7)
    bpy.ops.rototoon.new_key()
    settle(live)
    assert drawings(ob)[7][0] == "KEYFRAME"
    assert session(addon, ob).solved == [(part, a, b) for part in ("Part 1", "Part 2") for a, b in ((5, 7), (7, 9))]
    before = drawings(ob)
    shots.move(addon, ob, 7, 2, (4.0, 0.0))
    key = dict(shots.pixels(addon, ob, 7))[2]
    settle(live)
    after = drawings(ob)
    assert session(addon, ob).solved == [("Part 2", 5, 7), ("Part 2", 7, 9)]
    assert [frame for frame in after if after[frame] != before[frame]] == [6, 7, 8]
    assert np.array_equal(dict(shots.pixels(addon, ob, 7))[2], key)
    shots.layer_of(ob).frames.remove(7)
    settle(live)
    assert drawings(ob)[7][0] == "GENERATED"
    assert np.abs(dict(shots.pixels(addon, ob, 7))[2] - shots.square(6)).max() < 1e-3


def test_depth_and_method_count_as_edits(addon, fake, live, tmp_path):
    ob = switched_on(addon, live, tmp_path)
    ob.rototoon.parts[0].depth = 7.0
    settle(live)
    assert session(addon, ob).state["parts"][0]["depth"] == 7.0
    # Nearer parts are drawn last.
    assert [number for number, _ in shots.pixels(addon, ob, 3)] == [2, 1]
    ob.rototoon.preset = "zhou2011"
    settle(live)
    assert len(session(addon, ob).solved) == 4


def test_waits_until_the_artist_is_still(addon, fake, live, tmp_path):
    ob = switched_on(addon, live, tmp_path)
    shots.move(addon, ob, 3, 2, (5.0, 0.0), which=[1])
    bpy.context.view_layer.update()
    noted = time.monotonic()
    before = shots.snapshot(ob)
    assert live.step(noted) is not None
    assert shots.snapshot(ob) == before and live.status(ob) == RESTING
    shots.move(addon, ob, 3, 2, (5.0, 0.0), which=[1])
    settle(live)
    pins = session(addon, ob).state["parts"][1]["pins"]
    assert pins["3"]["1"] == pytest.approx(shots.square(2)[1] + (10, 0), abs=1e-3)


def test_two_quick_edits_give_what_one_track_gives(addon, fake, live, tmp_path, monkeypatch):
    ob = switched_on(addon, live, tmp_path)
    go = hold(addon, monkeypatch)
    shots.move(addon, ob, 3, 2, (5.0, -3.0), which=[1])
    bpy.context.view_layer.update()
    live.step(math.inf)
    assert live.status(ob)[0].startswith("Tracking")
    first = live._run
    shots.move(addon, ob, 7, 1, (9.0, 4.0))
    bpy.context.view_layer.update()
    live.step(math.inf)
    assert first.worker.cancelled and live._run is first
    go.set()
    settle(live)
    found = shots.snapshot(ob)
    addon("capture.sessions").clear()
    ob.rototoon.live = False
    bpy.ops.rototoon.track()
    assert shots.snapshot(ob) == found
    state = session(addon, ob).state["parts"]
    assert list(state[1]["pins"]) == ["3"] and list(state[0]["pins"]) == ["7"]


def test_edit_that_was_not_reported_drops_the_result(addon, fake, live, tmp_path, monkeypatch):
    ob = switched_on(addon, live, tmp_path)
    go = hold(addon, monkeypatch)
    shots.move(addon, ob, 3, 2, (5.0, -3.0), which=[1])
    bpy.context.view_layer.update()
    live.step(math.inf)
    shots.move(addon, ob, 3, 2, (1.0, 0.0), which=[1])
    place = dict(shots.pixels(addon, ob, 3))[2][1]
    go.set()
    work_off(live)
    assert session(addon, ob).state["parts"][1]["pins"]["3"]["1"] == pytest.approx(place, abs=1e-6)


def test_switched_off_it_stops(addon, fake, live, tmp_path, monkeypatch):
    ob = switched_on(addon, live, tmp_path)
    go = hold(addon, monkeypatch)
    shots.move(addon, ob, 3, 2, (5.0, -3.0), which=[1])
    bpy.context.view_layer.update()
    live.step(math.inf)
    before = shots.snapshot(ob)
    go.set()
    ob.rototoon.live = False
    assert settle(live) == 0
    shots.move(addon, ob, 7, 2, (5.0, -3.0), which=[1])
    ob.rototoon.parts[0].depth = 7.0
    assert settle(live) == 0
    assert drawings(ob)[2] == before[0]["Contours", 2]
    # On again, what was missed is tracked.
    ob.rototoon.live = True
    settle(live)
    assert sorted(session(addon, ob).state["parts"][1]["pins"]) == ["3", "7"]


def test_held_off_while_a_tool_runs(addon, fake, live, tmp_path, monkeypatch):
    ob = switched_on(addon, live, tmp_path)
    shots.move(addon, ob, 3, 2, (5.0, -3.0), which=[1])
    bpy.context.view_layer.update()
    before = shots.snapshot(ob)
    monkeypatch.setattr(live, "held_off", lambda: True)
    assert live.step(math.inf) is not None
    assert shots.snapshot(ob) == before and live._run is None
    monkeypatch.undo()
    settle(live)
    assert session(addon, ob).solved == [("Part 2", 1, 5)]


def test_which_tools_it_minds(addon, live):
    assert live._minds("TRANSFORM_OT_translate") and live._minds("GREASE_PENCIL_OT_brush_stroke")
    assert live._minds("ROTOTOON_OT_track")

    class Other(bpy.types.Operator):
        bl_idname = "other.addon"
        bl_label = "Of another add-on"

    bpy.utils.register_class(Other)
    try:
        assert not live._minds("OTHER_OT_addon")
    finally:
        bpy.utils.unregister_class(Other)


@pytest.mark.parametrize("mode", ["OBJECT", "EDIT"])
def test_one_undo_takes_back_the_edit_and_its_result(addon, fake, live, tmp_path, mode):
    ob = switched_on(addon, live, tmp_path)
    bpy.ops.object.mode_set(mode=mode)
    bpy.ops.ed.undo_push(message="before")
    states = [drawings(ob)]
    for frame, part in ((3, 2), (7, 1)):
        shots.move(addon, ob, frame, part, (5.0, -3.0), which=[1])
        ob.data.update_tag()
        bpy.context.view_layer.update()
        # As Blender does at the end of a drag.
        bpy.ops.ed.undo_push(message="Move")
        settle(live)
        states.append(drawings(ob))

    def now():
        settle(live)
        return drawings(bpy.context.object)

    bpy.ops.ed.undo()
    assert now() == states[1]
    bpy.ops.ed.undo()
    assert now() == states[0]
    # Looking at it cost nothing: redo is still there.
    bpy.ops.ed.redo()
    assert now() == states[1]
    bpy.ops.ed.redo()
    assert now() == states[2]
    assert settle(live) == 0


@pytest.mark.parametrize("mode", ["OBJECT", "EDIT"])
def test_step_that_holds_no_result_gets_it_again(addon, fake, live, tmp_path, mode):
    ob = switched_on(addon, live, tmp_path)
    bpy.ops.object.mode_set(mode=mode)
    bpy.ops.ed.undo_push(message="before")
    shots.move(addon, ob, 3, 2, (9.0, 4.0))
    ob.data.update_tag()
    bpy.context.view_layer.update()
    # Of a moved part, the strokes of the step itself hold only the shift; the pins are written with the result.
    bpy.ops.ed.undo_push(message="Move")
    settle(live)
    result = drawings(ob)
    bpy.ops.ed.undo_push(message="something else")
    bpy.ops.ed.undo()
    assert drawings(bpy.context.object) != result
    settle(live)
    assert drawings(bpy.context.object) == result


def test_undo_while_tracking(addon, fake, live, tmp_path, monkeypatch):
    ob = switched_on(addon, live, tmp_path)
    bpy.ops.ed.undo_push(message="before")
    before = drawings(ob)
    shots.move(addon, ob, 3, 2, (5.0, -3.0), which=[1])
    bpy.ops.ed.undo_push(message="Move")
    go = hold(addon, monkeypatch)
    bpy.context.view_layer.update()
    live.step(math.inf)
    assert live._run is not None
    bpy.ops.ed.undo()
    go.set()
    settle(live)
    assert drawings(bpy.context.object) == before


def test_object_deleted_while_tracking(addon, fake, live, tmp_path, monkeypatch):
    ob = switched_on(addon, live, tmp_path)
    uid = ob.session_uid
    go = hold(addon, monkeypatch)
    shots.move(addon, ob, 3, 2, (5.0, -3.0), which=[1])
    bpy.context.view_layer.update()
    live.step(math.inf)
    bpy.data.objects.remove(ob)
    go.set()
    settle(live)
    assert live._run is None and uid not in addon("capture.sessions")._entries


def test_layer_deleted_while_tracking(addon, fake, live, tmp_path, monkeypatch):
    ob = switched_on(addon, live, tmp_path)
    go = hold(addon, monkeypatch)
    shots.move(addon, ob, 3, 2, (5.0, -3.0), which=[1])
    bpy.context.view_layer.update()
    live.step(math.inf)
    ob.data.layers.remove(shots.layer_of(ob))
    go.set()
    settle(live)
    text, icon = live.status(ob)
    assert "has no layer" in text and icon == "ERROR"
    assert ob.rototoon.live


def test_failure_is_told_once_and_leaves_it_on(addon, fake, live, tmp_path, monkeypatch):
    ob = switched_on(addon, live, tmp_path)
    error = addon("rototoon").RototoonError
    track = fake.Session.track

    def fail(*_args, **_options):
        raise error("frame 3: no file\nand more")

    monkeypatch.setattr(fake.Session, "track", fail)
    shots.move(addon, ob, 3, 2, (5.0, -3.0), which=[1])
    before = shots.snapshot(ob)
    settle(live)
    assert live.status(ob) == ("frame 3: no file", "ERROR") and ob.rototoon.live
    assert shots.snapshot(ob) == before
    ob.data.update_tag()
    assert settle(live) == 0, "not tried again for the same document"
    monkeypatch.setattr(fake.Session, "track", track)
    shots.move(addon, ob, 3, 2, (1.0, 0.0), which=[1])
    settle(live)
    assert live.status(ob) == RESTING
    assert session(addon, ob).solved == [("Part 2", 1, 5)]


def test_track_pressed_while_tracking(addon, fake, live, tmp_path, monkeypatch):
    ob = switched_on(addon, live, tmp_path)
    shots.move(addon, ob, 3, 2, (5.0, -3.0), which=[1])
    bpy.context.view_layer.update()
    live.step(math.inf)
    assert bpy.ops.rototoon.track() == {"FINISHED"}
    before = shots.snapshot(ob)
    settle(live)
    assert shots.snapshot(ob) == before and session(addon, ob).solved == []


def test_cleared_frames_stay_cleared_until_the_next_edit(addon, fake, live, tmp_path):
    ob = switched_on(addon, live, tmp_path)
    bpy.ops.rototoon.clear_generated()
    settle(live)
    assert sorted(drawings(ob)) == [1, 5, 9]
    shots.move(addon, ob, 9, 2, (2.0, 0.0))
    settle(live)
    assert sorted(drawings(ob)) == list(range(1, 10))


def test_opened_file_is_tracked_from_the_first_edit(addon, fake, live, tmp_path):
    ob = switched_on(addon, live, tmp_path)
    made = len(fake.Session.made)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "shot.blend"))
    ob = bpy.context.object
    assert ob.rototoon.live
    before = shots.snapshot(ob)
    # Blender reports everything of a new file as changed.
    ob.data.update_tag()
    settle(live)
    assert shots.snapshot(ob) == before and len(fake.Session.made) == made
    shots.move(addon, ob, 3, 2, (5.0, -3.0), which=[1])
    settle(live)
    assert list(session(addon, ob).state["parts"][1]["pins"]) == ["3"]
    assert len(fake.Session.made) == made + 1


def test_one_key_only_is_not_an_error(addon, fake, live, tmp_path):
    ob = shots.set_up(tmp_path)
    shots.draw(addon, ob, 1, [shots.square(0)])
    ob.rototoon.preset = "zhou2011"
    ob.rototoon.live = True
    settle(live)
    assert live.status(ob) == RESTING and sorted(drawings(ob)) == [1]
    ob.rototoon.preset = "rototoon"
    settle(live)
    assert sorted(drawings(ob)) == [1, 2, 3, 4], "followed outward, and ended"


def test_unregistering_leaves_nothing(addon, fake, live, tmp_path):
    ob = switched_on(addon, live, tmp_path)
    hooks = bpy.app.handlers
    try:
        addon("handlers").unregister()
        assert live.changed not in hooks.depsgraph_update_post[:] and live.undone not in hooks.undo_post[:]
        shots.move(addon, ob, 3, 2, (5.0, -3.0), which=[1])
        assert settle(live) == 0
    finally:
        addon("handlers").register()


def test_native_result_is_that_of_track(addon, library, live, tmp_path):
    ob = switched_on(addon, live, tmp_path)
    before = drawings(ob)
    shots.move(addon, ob, 3, 2, (4.0, -3.0), which=[1])
    pinned = dict(shots.pixels(addon, ob, 3))[2][1]
    settle(live)
    after = drawings(ob)
    changed = [frame for frame in after if after[frame] != before[frame]]
    assert set(changed) <= {2, 3, 4} and 3 in changed
    assert np.array_equal(dict(shots.pixels(addon, ob, 3))[2][1], pinned)
    shots.move(addon, ob, 7, 1, (3.0, 2.0))
    settle(live)
    found = shots.snapshot(ob)
    addon("capture.sessions").clear()
    ob.rototoon.live = False
    bpy.ops.rototoon.track()
    assert shots.snapshot(ob) == found

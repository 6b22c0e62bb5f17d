"""Keys, tracking, corrections, snapping: the artist's main job, in background."""

import bpy
import numpy as np
import pytest
import shots


def kinds(addon, ob, name=None):
    gp = addon("blender.grease_pencil")
    return {f: kind for f, (_, kind) in gp.drawings(ob.data.layers[name or ob.rototoon.contours_layer]).items()}


def solved(addon, ob):
    return addon("capture.sessions").known(ob).session.solved


def test_new_key_copies_and_keeps_who_is_who(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    assert kinds(addon, ob) == {1: "KEYFRAME", 9: "KEYFRAME"}
    bpy.ops.rototoon.track()
    assert [p.name for p in ob.rototoon.parts] == ["Part 1", "Part 2"]
    assert ob.rototoon.parts[1].depth > ob.rototoon.parts[0].depth
    assert all(p.closed for p in ob.rototoon.parts)
    bpy.context.scene.frame_set(5)
    before = shots.pixels(addon, ob, 5)
    bpy.ops.rototoon.new_key()
    assert kinds(addon, ob)[5] == "KEYFRAME"
    for (number, points), (again, same) in zip(before, shots.pixels(addon, ob, 5), strict=True):
        assert number == again and np.array_equal(points, same)
    with pytest.raises(RuntimeError, match="key already"):
        bpy.ops.rototoon.new_key()
    # The new key halves the spans.
    bpy.ops.rototoon.track()
    assert len(solved(addon, ob)) == 4


def test_key_for_one_part_only(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    bpy.context.scene.frame_set(4)
    ob.rototoon.active_part = 1
    bpy.ops.rototoon.new_key(parts="ACTIVE")
    found = addon("capture.contours").read(ob)
    assert sorted(found.part(2).keys) == [1, 4, 9] and sorted(found.part(1).keys) == [1, 9]
    bpy.ops.rototoon.track()
    assert sorted(place[0] for place in solved(addon, ob)) == ["Part 2", "Part 2"]
    found = addon("capture.contours").read(ob)
    assert 4 in found.part(1).made and 4 in found.part(2).keys
    assert kinds(addon, ob)[4] == "KEYFRAME"
    assert bpy.ops.rototoon.clear_generated() == {"FINISHED"}
    assert kinds(addon, ob) == {1: "KEYFRAME", 4: "KEYFRAME", 9: "KEYFRAME"}
    assert [number for number, _ in shots.pixels(addon, ob, 4)] == [2]


def test_track_writes_generated_frames_and_leaves_keys(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    keys = {frame: shots.pixels(addon, ob, frame) for frame in (1, 9)}
    assert bpy.ops.rototoon.track() == {"FINISHED"}
    assert kinds(addon, ob) == {f: "KEYFRAME" if f in (1, 9) else "GENERATED" for f in range(1, 10)}
    for frame, strokes in keys.items():
        for (_, points), (_, same) in zip(strokes, shots.pixels(addon, ob, frame), strict=True):
            assert np.array_equal(points, same)
    for frame in range(2, 9):
        by_part = dict(shots.pixels(addon, ob, frame))
        assert np.abs(by_part[1] - shots.diamond(frame - 1)).max() < 1e-3
        assert np.abs(by_part[2] - shots.square(frame - 1)).max() < 1e-3


def test_style_follows_the_keys(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    gp = addon("blender.grease_pencil")
    drawings = gp.drawings(shots.layer_of(ob))
    for frame, radius in ((1, 0.01), (9, 0.05)):
        handle = drawings[frame][0]
        gp.put(handle, "radius", np.full(8, radius))
        gp.put(handle, "material_index", np.array([0, 2]))
        gp.put(handle, "opacity", np.linspace(0.2, 0.9, 8))
        gp.put(handle, "fill_id", np.array([0, 4]))
    bpy.ops.rototoon.track()
    handle = gp.drawings(shots.layer_of(ob))[5][0]
    assert gp.value(handle, "radius", 8) == pytest.approx(np.full(8, 0.03))
    assert gp.value(handle, "opacity", 8) == pytest.approx(np.linspace(0.2, 0.9, 8))
    assert list(gp.value(handle, "material_index", 2)) == [0, 2]
    assert list(gp.value(handle, "cyclic", 2)) == [True, True]
    assert list(gp.value(handle, "fill_id", 2) != 0) == [False, True]


def test_moved_points_become_pins_and_only_their_span_is_solved(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    assert len(solved(addon, ob)) == 2
    bpy.ops.rototoon.track()
    assert solved(addon, ob) == []
    shots.move(addon, ob, 4, 2, (5.0, -3.0), which=[1])
    moved = dict(shots.pixels(addon, ob, 4))[2][1]
    bpy.ops.rototoon.track()
    assert solved(addon, ob) == [("Part 2", 1, 9)]
    state = addon("capture.sessions").known(ob).session.state
    pins = state["parts"][1]["pins"]
    assert list(pins) == ["4"] and list(pins["4"]) == ["1"]
    assert "pins" not in state["parts"][0]
    assert pins["4"]["1"] == pytest.approx(moved, abs=1e-6)
    assert np.array_equal(dict(shots.pixels(addon, ob, 4))[2][1], moved)
    # The pin stays, and nothing is solved again for it.
    bpy.ops.rototoon.track()
    assert solved(addon, ob) == []
    marks = addon("ui.overlay").gather(ob, 4)
    assert [len(mark.points) for mark in marks] == [1]


@pytest.mark.parametrize("moved_line", ["KEEP", "SETTLE"])
@pytest.mark.parametrize(("degrees", "scale"), [(125, 1.0), (10, 1.0), (0, 1.5)])
def test_a_line_that_was_turned_or_scaled_is_named_and_keeps_its_shape(addon, fake, tmp_path, degrees, scale, moved_line):
    ob = shots.two_keys(addon, tmp_path)
    ob.rototoon.moved_line = moved_line
    bpy.ops.rototoon.track()
    before, turn = dict(shots.pixels(addon, ob, 6))[1], np.radians(degrees)
    around = before - before.mean(0)
    placed = before.mean(0) + scale * around @ [[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]]
    shots.move(addon, ob, 6, 1, placed - before)
    reports = addon("common.reports")
    reports.take()
    for _ in range(2):
        bpy.ops.rototoon.track()
    assert ['; kept as you moved it: "Part 1" on 6' in report.text for report in reports.take()] == [True, False]
    assert dict(shots.pixels(addon, ob, 6))[1] == pytest.approx(placed, abs=1e-3)


def test_a_line_that_settles_is_named_as_looked_for(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    ob.rototoon.moved_line = "SETTLE"
    bpy.ops.rototoon.track()
    shots.move(addon, ob, 6, 1, (9.0, 4.0))
    addon("common.reports").take()
    bpy.ops.rototoon.track()
    (report,) = addon("common.reports").take()
    assert '; looked for where you moved it: "Part 1" on 6' in report.text and "kept as" not in report.text


@pytest.mark.parametrize("shift", [(0.6, 0.2), (9.0, 4.0), (60.0, 20.0)])
def test_a_line_moved_as_a_whole_keeps_its_shape(addon, fake, tmp_path, shift):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    bpy.context.scene.frame_set(6)
    shots.move(addon, ob, 6, 1, shift)
    (blue,) = addon("ui.overlay").gather(ob, 6)
    assert len(blue.points) == 4, "the view shows at once what will hold"
    assert "it stays as it is here" in addon("ui.start").next_of(addon("ui.start").steps_of(ob)).hint
    placed = dict(shots.pixels(addon, ob, 6))[1]
    assert placed == pytest.approx(shots.diamond(5) + shift, abs=1e-3)
    reports = addon("common.reports")
    reports.take()
    for times in (1, 2):
        bpy.ops.rototoon.track()
        assert np.array_equal(dict(shots.pixels(addon, ob, 6))[1], placed), times
        state = addon("capture.sessions").known(ob).session.state["parts"][0]
        assert list(state["pins"]["6"]) == ["0", "1", "2", "3"] and "centers" not in state
    assert ['kept as you moved it: "Part 1" on 6' in report.text for report in reports.take()] == [True, False]
    assert addon("ui.panels").said_of_held(bpy.context) == "Held here: 1 whole line"
    bpy.ops.rototoon.release_pins(which="ALL")
    bpy.ops.rototoon.track()
    assert np.abs(dict(shots.pixels(addon, ob, 6))[1] - shots.diamond(5)).max() < 1e-3


def test_an_older_centre_gives_way_to_the_whole_line(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    ob.rototoon.moved_line = "SETTLE"
    bpy.ops.rototoon.track()
    shots.move(addon, ob, 6, 1, (9.0, 4.0))
    bpy.ops.rototoon.track()
    ob.rototoon.moved_line = "KEEP"
    bpy.ops.rototoon.track()
    state = addon("capture.sessions").known(ob).session.state["parts"][0]
    assert list(state["centers"]) == ["6"] and "pins" not in state, "what the file has stays"
    shots.move(addon, ob, 6, 1, (0.0, 6.0))
    bpy.ops.rototoon.track()
    state = addon("capture.sessions").known(ob).session.state["parts"][0]
    assert "centers" not in state and len(state["pins"]["6"]) == 4


def test_part_moved_as_a_whole_becomes_a_centre_where_it_settles(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    ob.rototoon.moved_line = "SETTLE"
    bpy.ops.rototoon.track()
    shots.move(addon, ob, 6, 1, (9.0, 4.0))
    bpy.ops.rototoon.track()
    state = addon("capture.sessions").known(ob).session.state
    assert solved(addon, ob) == [("Part 1", 1, 9)]
    assert "pins" not in state["parts"][0]
    wanted = shots.diamond(5).mean(0) + (9, 4)
    assert state["parts"][0]["centers"]["6"] == pytest.approx(wanted, abs=1e-3)
    assert dict(shots.pixels(addon, ob, 6))[1].mean(0) == pytest.approx(wanted, abs=1e-3)
    bpy.ops.rototoon.track()
    assert solved(addon, ob) == []
    # A pin beside it, later: both hold.
    shots.move(addon, ob, 6, 1, (0.0, 6.0), which=[2])
    bpy.ops.rototoon.track()
    state = addon("capture.sessions").known(ob).session.state
    assert state["parts"][0]["centers"]["6"] == pytest.approx(wanted, abs=1e-3)
    assert list(state["parts"][0]["pins"]["6"]) == ["2"]


def test_released_pins_are_tracked_again(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    shots.move(addon, ob, 4, 2, (5.0, -3.0), which=[1])
    shots.move(addon, ob, 6, 1, (9.0, 4.0))
    bpy.ops.rototoon.track()
    bpy.context.scene.frame_set(4)
    bpy.ops.rototoon.release_pins(which="FRAME")
    bpy.ops.rototoon.track()
    assert solved(addon, ob) == [("Part 2", 1, 9)]
    assert np.abs(dict(shots.pixels(addon, ob, 4))[2] - shots.square(3)).max() < 1e-3
    bpy.ops.rototoon.release_pins(which="ALL")
    bpy.ops.rototoon.track()
    assert np.abs(dict(shots.pixels(addon, ob, 6))[1] - shots.diamond(5)).max() < 1e-3


def test_release_selected_points_only(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    shots.move(addon, ob, 4, 2, (5.0, -3.0), which=[1])
    shots.move(addon, ob, 4, 2, (5.0, -3.0), which=[2])
    bpy.ops.rototoon.track()
    gp = addon("blender.grease_pencil")
    handle = gp.drawings(shots.layer_of(ob))[4][0]
    pinned = gp.value(handle, gp.PIN, 8)
    assert pinned.sum() == 2
    chosen = np.zeros(8, bool)
    chosen[np.flatnonzero(pinned)[0]] = True
    attribute = handle.attributes.get(".selection") or handle.attributes.new(".selection", "BOOLEAN", "POINT")
    attribute.data.foreach_set("value", chosen)
    bpy.context.scene.frame_set(4)
    bpy.ops.rototoon.release_pins(which="SELECTED")
    assert np.array_equal(gp.value(handle, gp.PIN, 8), pinned & ~chosen)


def test_drawn_afresh_in_any_way_is_matched(addon, fake, tmp_path):
    ob = shots.set_up(tmp_path)
    shots.draw(addon, ob, 1, [shots.diamond(0), shots.square(0)])
    # Other order, other direction, other starting point, more points.
    square = np.roll(shots.square(8)[::-1], 1, 0)
    dense = np.concatenate([np.linspace(a, b, 6)[:-1] for a, b in zip(square, np.roll(square, -1, 0))])
    shots.draw(addon, ob, 9, [dense, np.roll(shots.diamond(8), 2, 0)])
    drawn = [points for _, points in shots.pixels(addon, ob, 9)]
    bpy.ops.rototoon.match_contours()
    assert [number for number, _ in shots.pixels(addon, ob, 9)] == [2, 1]
    bpy.ops.rototoon.track()
    for points, (_, same) in zip(drawn, shots.pixels(addon, ob, 9), strict=True):
        assert np.array_equal(points, same)
    state = addon("capture.sessions").known(ob).session.state
    assert np.abs(np.array(state["parts"][1]["keys"]["9"]) - shots.square(8)).max() < 1e-3
    assert np.abs(np.array(state["parts"][0]["keys"]["9"]) - shots.diamond(8)).max() < 1e-3
    assert np.abs(dict(shots.pixels(addon, ob, 5))[2] - shots.square(4)).max() < 1e-3
    # What was matched stays matched: editing the drawn key moves the control points with it.
    shots.move(addon, ob, 9, 2, (3.0, 2.0))
    bpy.ops.rototoon.track()
    state = addon("capture.sessions").known(ob).session.state
    assert np.abs(np.array(state["parts"][1]["keys"]["9"]) - shots.square(8) - (3, 2)).max() < 1e-3


def test_new_stroke_on_a_later_key_is_a_new_part(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    shots.draw(addon, ob, 9, [np.array([[10.0, 80.0], [30.0, 84.0], [50.0, 80.0]])], cyclic=False)
    bpy.ops.rototoon.track()
    part = ob.rototoon.parts[2]
    assert (part.closed, part.count) == (False, 3)
    assert part.depth == max(p.depth for p in ob.rototoon.parts)
    assert part.number == 3


def test_stroke_redrawn_on_a_generated_frame_is_a_key_and_stays(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    drawn = shots.square(4)[::-1] + (6, 0)
    shots.draw(addon, ob, 5, [drawn])
    bpy.ops.rototoon.track()
    found = addon("capture.contours").read(ob)
    assert sorted(found.part(2).keys) == [1, 5, 9] and 5 in found.part(1).made
    strokes = shots.pixels(addon, ob, 5)
    assert sorted(number for number, _ in strokes) == [1, 2]
    assert np.abs(dict(strokes)[2] - drawn).max() < 1e-3


def test_keyframe_type_set_by_the_artist_makes_a_key(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    addon("blender.grease_pencil").set_keyframe_type(shots.layer_of(ob), {5: "EXTREME"})
    shots.move(addon, ob, 5, 2, (7.0, 0.0))
    bpy.ops.rototoon.track()
    found = addon("capture.contours").read(ob)
    assert sorted(found.part(2).keys) == [1, 5, 9]
    assert kinds(addon, ob)[5] == "EXTREME"


def test_stopped_tracking_changes_nothing(addon, fake, tmp_path, monkeypatch):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    shots.move(addon, ob, 4, 2, (5.0, -3.0), which=[1])
    shots.draw(addon, ob, 6, [shots.diamond(5)])
    before = shots.snapshot(ob)
    jobs = addon("common.jobs")
    monkeypatch.setattr(jobs.Worker, "start", lambda self: (self.cancel(), self._thread.start()))
    assert bpy.ops.rototoon.track() == {"CANCELLED"}
    assert shots.snapshot(ob) == before


def test_failed_tracking_changes_nothing(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    before = shots.snapshot(ob)
    error = addon("rototoon").RototoonError

    def fail(*_args, **_options):
        raise error("frame 3: no file")

    addon("capture.sessions").make = lambda document, folder: type("Broken", (), {"track": fail})()
    with pytest.raises(RuntimeError, match="frame 3: no file"):
        bpy.ops.rototoon.track()
    assert shots.snapshot(ob) == before


def test_track_needs_two_keys(addon, fake, tmp_path):
    ob = shots.set_up(tmp_path)
    assert not bpy.ops.rototoon.track.poll()
    shots.draw(addon, ob, 1, [shots.square(0)])
    ob.rototoon.preset = "zhou2011"
    with pytest.raises(RuntimeError, match="New Key Here"):
        bpy.ops.rototoon.track()


def test_snap_layer(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    gp = addon("blender.grease_pencil")
    for frame in (1, 9):
        gp.put(gp.drawings(shots.layer_of(ob))[frame][0], "radius", np.linspace(0.01, 0.04, 8))
    bpy.ops.rototoon.track()
    assert bpy.ops.rototoon.snap() == {"FINISHED"}
    assert kinds(addon, ob, "Snapped") == {f: "GENERATED" for f in range(1, 10)}
    handle = gp.drawings(ob.data.layers["Snapped"])[5][0]
    starts = gp.offsets(handle)
    assert list(np.diff(starts)) == [16, 16]
    assert list(gp.value(handle, "cyclic", 2)) == [True, True]
    radius = gp.value(handle, "radius", 32)
    assert radius[[0, 4, 8, 12]] == pytest.approx(np.linspace(0.01, 0.04, 8)[:4])
    assert radius[2] == pytest.approx((radius[0] + radius[4]) / 2)
    assert (gp.value(handle, "opacity", 32) == 1).all()
    curves = addon("capture.snapping").read(ob)
    assert np.abs(curves[2, 5][1] - np.linspace(*shots.square(4)[1:3], 5)).max() < 1e-3
    # A frame of that layer which the artist took over stays.
    gp.set_keyframe_type(ob.data.layers["Snapped"], {5: "KEYFRAME"})
    gp.put(handle, "radius", np.full(32, 0.5))
    bpy.ops.rototoon.snap()
    assert (gp.value(gp.drawings(ob.data.layers["Snapped"])[5][0], "radius", 32) == 0.5).all()


def test_clear_generated_keeps_keys_and_corrections(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    keys = {frame: shots.pixels(addon, ob, frame) for frame in (1, 9)}
    bpy.ops.rototoon.track()
    bpy.ops.rototoon.snap()
    shots.move(addon, ob, 4, 2, (5.0, -3.0), which=[1])
    bpy.ops.rototoon.clear_generated()
    assert sorted(kinds(addon, ob)) == [1, 4, 9]
    bpy.ops.rototoon.track()
    assert list(addon("capture.sessions").known(ob).session.state["parts"][1]["pins"]) == ["4"]
    bpy.ops.rototoon.clear_generated(corrected=True)
    assert sorted(kinds(addon, ob)) == [1, 9] and kinds(addon, ob, "Snapped") == {}
    for frame, strokes in keys.items():
        for (_, points), (_, same) in zip(strokes, shots.pixels(addon, ob, frame), strict=True):
            assert np.array_equal(points, same)


def test_weakest_frame_and_confidence(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    gp = addon("blender.grease_pencil")
    gp.put(gp.drawings(shots.layer_of(ob))[6][0], gp.CONFIDENCE, np.full(8, 0.1))
    bpy.ops.rototoon.weakest_frame()
    assert bpy.context.scene.frame_current == 6
    assert addon("ui.overlay").gather(ob, 6) == []
    bpy.ops.rototoon.show_confidence()
    (marks,) = addon("ui.overlay").gather(ob, 6)
    assert len(marks.points) == 8 and (marks.colours[:, 0] > 0.9).all()


def test_undo_is_one_step(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.ed.undo_push(message="before")
    before = shots.snapshot(ob)
    bpy.ops.rototoon.track("EXEC_DEFAULT", True)
    assert len(kinds(addon, ob)) == 9
    bpy.ops.ed.undo()
    ob = bpy.context.object
    assert shots.snapshot(ob) == before
    bpy.ops.rototoon.track()
    assert len(kinds(addon, ob)) == 9


def test_contours_on_two_layers(addon, fake, tmp_path):
    ob = shots.set_up(tmp_path)
    upper = ob.data.layers.new("Contours.front")
    shots.draw(addon, ob, 1, [shots.diamond(0)])
    shots.draw(addon, ob, 9, [shots.diamond(8)])
    ob.rototoon.contours_layer = "Contours.front"
    shots.draw(addon, ob, 1, [shots.square(0)])
    shots.draw(addon, ob, 9, [shots.square(8)])
    ob.rototoon.contours_layer = "Contours"
    bpy.ops.rototoon.track()
    parts = {part.number: part for part in addon("capture.contours").read(ob).parts}
    assert [(parts[n].layer, parts[n].depth) for n in (1, 2)] == [(0, 0.0), (1, 1.0)]
    assert len(upper.frames) == 9 and len(ob.data.layers["Contours"].frames) == 9
    assert len(shots.pixels(addon, ob, 5)) == 1


def test_moving_camera(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    camera = bpy.context.scene.camera
    for frame, x in ((1, 0.0), (9, 2.0)):
        camera.location.x = x
        camera.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_set(3)
    bpy.ops.rototoon.track()
    assert bpy.context.scene.frame_current == 3
    bpy.context.scene.frame_set(9)
    bpy.context.view_layer.update()
    state = addon("capture.sessions").known(ob).session.state
    # The camera went 2 units right at 16 pixels a unit: the strokes went left in the picture.
    assert np.abs(np.array(state["parts"][0]["keys"]["9"]) - shots.diamond(8) + (32, 0)).max() < 1e-2

"""The property Closed of a part closes and opens its lines."""

import bpy
import numpy as np
import pytest
import shots


def flags(addon, ob, number=1) -> dict[int, bool]:
    """By frame whether the part's line is closed."""
    gp, found = addon("blender.grease_pencil"), {}
    for frame, (handle, _) in gp.drawings(shots.layer_of(ob)).items():
        count = len(gp.offsets(handle)) - 1
        (index,) = np.flatnonzero(gp.value(handle, gp.PART, count) == number)
        found[frame] = bool(gp.value(handle, "cyclic", count)[index])
    return found


@pytest.fixture
def tracked(addon, fake, tmp_path):
    """Two closed parts, tracked from frame 1 to 9."""
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    return ob


@pytest.mark.parametrize("hidden", [False, True])
@pytest.mark.parametrize("mode", ["OBJECT", "EDIT"])
def test_lines_follow_on_all_frames(addon, tracked, hidden, mode):
    shots.layer_of(tracked).hide = hidden
    bpy.ops.object.mode_set(mode=mode)
    before = shots.snapshot(tracked)
    every = list(flags(addon, tracked))
    assert len(every) == 9
    tracked.rototoon.parts[0].closed = False
    assert flags(addon, tracked) == dict.fromkeys(every, False)
    assert flags(addon, tracked, 2) == dict.fromkeys(every, True), "the other part stays"
    tracked.rototoon.parts[0].closed = True
    assert shots.snapshot(tracked) == before


def test_an_open_line_of_the_artist_becomes_closed_and_stays_so(addon, fake, tmp_path):
    ob = shots.set_up(tmp_path)
    for frame in (1, 9):
        shots.draw(addon, ob, frame, [shots.square(frame - 1)], cyclic=False)
    bpy.ops.rototoon.track()
    assert not any(flags(addon, ob).values()) and not ob.rototoon.parts[0].closed
    ob.rototoon.parts[0].closed = True
    assert all(flags(addon, ob).values())
    bpy.ops.rototoon.track()
    assert all(flags(addon, ob).values()) and len(flags(addon, ob)) == 9
    assert addon("capture.sessions").known(ob).session.state["parts"][0]["closed"]


def test_track_leaves_the_ends_of_a_line_as_they_were_drawn(addon, fake, tmp_path):
    """A line whose ends nearly meet is a closed part. Track itself does not join the artist's line."""
    ob = shots.set_up(tmp_path)
    turn = np.linspace(0, 2 * np.pi, 60)
    ring = 20 * np.stack([np.cos(turn), np.sin(turn)], 1) + (60, 45)
    for frame in (1, 9):
        shots.draw(addon, ob, frame, [ring + frame], cyclic=False)
    bpy.ops.rototoon.track()
    found = flags(addon, ob)
    assert ob.rototoon.parts[0].closed and not found[1] and not found[9] and found[5]


def test_undo_and_redo_take_lines_and_property_together(addon, tracked):
    bpy.ops.ed.undo_push(message="before")
    tracked.rototoon.parts[0].closed = False
    bpy.ops.ed.undo_push(message="Closed")
    bpy.ops.ed.undo()
    ob = bpy.context.object
    assert ob.rototoon.parts[0].closed and all(flags(addon, ob).values())
    bpy.ops.ed.redo()
    ob = bpy.context.object
    assert not ob.rototoon.parts[0].closed and not any(flags(addon, ob).values())


@pytest.mark.parametrize("group", [False, True])
def test_a_locked_layer_is_not_written(addon, tracked, group):
    layer, closing = shots.layer_of(tracked), addon("capture.closing")
    if group:
        holder = tracked.data.layer_groups.new("holder")
        tracked.data.layers.move_to_layer_group(layer, holder)
        holder.lock = True
    else:
        layer.lock = True
    before = shots.snapshot(tracked)[0]
    tracked.rototoon.parts[0].closed = False
    assert shots.snapshot(tracked)[0] == before
    assert closing.write(tracked, 1, False) == 'left as it was: the layer "Contours" is locked'


def test_shared_drawings_are_not_written(addon, tracked):
    bpy.context.scene.collection.objects.link(tracked.copy())
    before = shots.snapshot(tracked)[0]
    tracked.rototoon.parts[0].closed = False
    assert shots.snapshot(tracked)[0] == before


def test_live_tracks_after_it(addon, tracked):
    live = addon("capture.live")
    tracked.rototoon.live = True
    try:
        tracked.rototoon.parts[0].closed = False
        bpy.context.view_layer.update()
        while live.step(float("inf")) is not None:
            pass
        assert not addon("capture.sessions").known(tracked).session.state["parts"][0]["closed"]
        assert not any(flags(addon, tracked).values())
    finally:
        live.reset()

"""The live mode writes in slices: what the artist does between two of them is kept."""

import math
import time

import bpy
import pytest
import shots
from live_stage import settle, switched_on, work_off


@pytest.fixture
def sliced(addon, live, monkeypatch):
    """Live reads and writes one drawing in a step."""
    for name in ("capture.live", "capture.contours", "capture.writing"):
        monkeypatch.setattr(addon(name), "SLICE", -1.0)
    monkeypatch.setattr(addon("capture.writing"), "AT_ONCE", 1)


def written_by_track(addon, live, ob):
    """What a fresh Track writes."""
    live.reset()
    ob.rototoon.live = False
    addon("capture.sessions").clear()
    bpy.ops.rototoon.track()
    return shots.snapshot(ob)


def until_writing(live, drawings=2):
    """Steps until some drawings are written, and no more."""
    bpy.context.view_layer.update()
    for _ in range(5000):
        assert live.step(math.inf) is not None
        if live._slices is not None and live._slices.wrote:
            drawings -= live._slices.steps.gi_running is False
        if drawings < 0:
            return
        time.sleep(0.0005)
    raise AssertionError("live never writes")


def test_slices_give_what_one_track_gives(addon, fake, live, sliced, tmp_path):
    ob = switched_on(addon, live, tmp_path)
    shots.move(addon, ob, 3, 2, (5.0, -3.0), which=[1])
    assert settle(live) > 20, "the work was not cut into slices"
    found = shots.snapshot(ob)
    assert written_by_track(addon, live, ob) == found


@pytest.mark.parametrize("steps", range(1, 60, 7))
@pytest.mark.parametrize("reported", [True, False])
def test_an_edit_between_slices_is_kept(addon, fake, live, sliced, tmp_path, steps, reported):
    """Whenever the artist or a script moves a point: it stays where it was put, and all else fits it in the end."""
    ob = switched_on(addon, live, tmp_path)
    shots.move(addon, ob, 3, 2, (5.0, -3.0), which=[1])
    bpy.context.view_layer.update()
    for _ in range(steps):
        live.step(math.inf)
        time.sleep(0.0005)
    shots.move(addon, ob, 7, 1, (9.0, 4.0), which=[0])
    place = dict(shots.pixels(addon, ob, 7))[1][0]
    (settle if reported else work_off)(live)
    settle(live)
    found = shots.snapshot(ob)
    assert dict(shots.pixels(addon, ob, 7))[1][0] == pytest.approx(place, abs=1e-4)
    assert written_by_track(addon, live, ob) == found


def test_undo_between_slices(addon, fake, live, sliced, tmp_path):
    ob = switched_on(addon, live, tmp_path)
    bpy.ops.ed.undo_push(message="before")
    before = shots.snapshot(ob)
    name = ob.name
    shots.move(addon, ob, 3, 2, (5.0, -3.0), which=[1])
    bpy.ops.ed.undo_push(message="moved")
    until_writing(live)
    bpy.ops.ed.undo()
    ob = bpy.data.objects[name]
    settle(live)
    assert shots.snapshot(ob) == before
    gp = addon("blender.grease_pencil")
    assert len(gp.datablocks()) == 1, "a copy was left in the file"


def test_a_layer_deleted_between_slices(addon, fake, live, sliced, tmp_path):
    ob = switched_on(addon, live, tmp_path)
    shots.move(addon, ob, 3, 2, (5.0, -3.0), which=[1])
    until_writing(live)
    ob.data.layers.remove(ob.data.layers["Contours"])
    work_off(live)
    assert live.status(ob)[1] == "ERROR" and 'no layer "Contours"' in live.status(ob)[0]


def test_track_pressed_between_slices(addon, fake, live, sliced, tmp_path):
    ob = switched_on(addon, live, tmp_path)
    shots.move(addon, ob, 3, 2, (5.0, -3.0), which=[1])
    until_writing(live)
    assert bpy.ops.rototoon.track() == {"FINISHED"}
    settle(live)
    found = shots.snapshot(ob)
    assert written_by_track(addon, live, ob) == found


@pytest.mark.parametrize("steps", [0, 1, 4, 30])
def test_an_edit_waits_while_another_scene_is_shown(addon, fake, live, sliced, tmp_path, steps):
    """Whether it is noted, read, tracked or written when the artist goes to the other scene."""
    ob, scene = switched_on(addon, live, tmp_path), bpy.context.scene
    shots.move(addon, ob, 3, 2, (5.0, -3.0), which=[1])
    bpy.context.view_layer.update()
    for _ in range(steps):
        live.step(math.inf)
        time.sleep(0.0005)
    bpy.context.window.scene = bpy.data.scenes.new("Other")
    for _ in range(50):
        assert live.step(math.inf) is not None
        time.sleep(0.001)
    bpy.context.window.scene = scene
    settle(live)
    found = shots.snapshot(ob)
    assert addon("capture.sessions").known(ob).inputs == addon("capture.document").read(ob).document
    assert written_by_track(addon, live, ob) == found


def test_a_deleted_object_is_forgotten(addon, fake, live, tmp_path):
    ob = switched_on(addon, live, tmp_path)
    shots.move(addon, ob, 3, 2, (5.0, -3.0), which=[1])
    live.note(ob)
    bpy.data.objects.remove(ob)
    assert live.step(math.inf) is None and not live._due

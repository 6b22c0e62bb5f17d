"""What the page on background Blender promises beside its functions: Ctrl-C, refusals, warnings, Live, Match Strokes."""

import bpy
import numpy as np
import pytest
import shots
import studio
from test_guard import closed_by_itself, closed_by_its_group, file, linked_file, opened, overridden  # noqa: F401 - fixtures

WRITERS = {
    "set_key": (studio.CONTOURS, lambda s, ob: s.set_key(ob, 5, {"new": shots.square(4)})),
    "track": (studio.CONTOURS, lambda s, ob: s.track(ob)),
    "trace_drawing": (studio.LINES, lambda s, ob: s.trace_drawing(ob)),
    "fill_region": (studio.PAINT, lambda s, ob: s.fill_region(ob, 1, (90.0, 60.0), (0.1, 0.5, 0.2))),
    "fill_drawings": (studio.PAINT, lambda s, ob: s.fill_drawings(ob)),
    "carry_strokes": (studio.INK, lambda s, ob: s.carry_strokes(ob, [studio.INK])),
}
"""Functions that write, and the layer that each writes here."""


@pytest.fixture
def scripting(addon):
    return addon("scripting")


def prepared(addon, ob, name):
    """There is something to do for each function."""
    shots.move(addon, ob, 2, 3, (4.0, 2.0), which=[1])
    if name == "trace_drawing":
        bpy.ops.rototoon.trace_drawing(frames="CURRENT")
    if name.startswith("fill"):
        bpy.ops.rototoon.paint_bucket(place=(20.0, 20.0))


@pytest.mark.parametrize("name", WRITERS)
def test_functions_write_their_layer(addon, opened, scripting, name):  # noqa: F811
    layer, call = WRITERS[name]
    prepared(addon, opened, name)
    before = studio.digests(addon, opened)
    call(scripting, opened)
    after = studio.digests(addon, opened)
    assert {each for each in after if after[each] != before.get(each)} == {layer}


@pytest.mark.parametrize("close", [closed_by_itself, closed_by_its_group])
@pytest.mark.parametrize("name", WRITERS)
def test_functions_refuse_a_locked_layer(addon, opened, scripting, name, close):  # noqa: F811
    layer, call = WRITERS[name]
    prepared(addon, opened, name)
    close(opened, layer)
    before = studio.digests(addon, opened)
    with pytest.raises(RuntimeError, match=f'the layer "{layer}" is locked'):
        call(scripting, opened)
    assert studio.digests(addon, opened) == before


@pytest.mark.parametrize("make", [linked_file, overridden, "shared"])
@pytest.mark.parametrize("name", WRITERS)
def test_functions_refuse_drawings_that_are_not_the_objects_own(addon, opened, file, scripting, name, make):  # noqa: F811
    if make == "shared":
        bpy.context.scene.collection.objects.link(opened.copy())
        ob, text = opened, "shares its drawings"
    else:
        make(file)
        ob = studio.activate(bpy.context.scene.objects[studio.OBJECT])
        text = "linked from another file" if make is linked_file else "library override"
    before = studio.digests(addon, ob)
    with pytest.raises(RuntimeError, match=text):
        WRITERS[name][1](scripting, ob)
    assert studio.digests(addon, ob) == before


def test_reading_functions_read_drawings_of_another_file(addon, opened, file, scripting):  # noqa: F811
    def told(ob):
        return scripting.lost_frames(ob), scripting.ends(ob), scripting.weakest_frame(ob), scripting.wanted_keys(ob)

    wanted, known = scripting.tracks(opened)["Part 1"].pixels, told(opened)
    linked_file(file)
    ob = studio.activate(bpy.context.scene.objects[studio.OBJECT])
    assert scripting.tracks(ob)["Part 1"].pixels == pytest.approx(wanted, abs=1e-3)
    assert scripting.lines(ob, studio.INK) and scripting.parts(ob)
    assert known[2] and told(ob) == known


def test_ctrl_c_changes_nothing(addon, fake, tmp_path, monkeypatch):
    ob = shots.two_keys(addon, tmp_path)
    before, worker = shots.snapshot(ob), addon("common.jobs").Worker

    def interrupted(self):
        raise KeyboardInterrupt

    monkeypatch.setattr(worker, "wait", interrupted)
    monkeypatch.setattr(worker, "advance", lambda self: False)
    assert bpy.ops.rototoon.track() == {"CANCELLED"}
    assert shots.snapshot(ob) == before
    report = addon("scripting").take_reports()[-1]
    assert (report.kind, report.text) == ("WARNING", "Track: stopped, nothing was changed")


def test_a_layer_that_is_left_out_is_a_warning(addon, fake, tmp_path, scripting):
    ob = shots.set_up(tmp_path)
    scripting.set_key(ob, 1, {"square": shots.square(0)})
    scripting.set_key(ob, 9, {"square": shots.square(8)})
    scripting.set_key(ob, 1, {"diamond": shots.diamond(0)}, layer="Contours.far")
    scripting.set_key(ob, 9, {"diamond": shots.diamond(8)})
    ob.data.layers["Contours.far"].lock = True
    said = 'left as it was: the layer "Contours.far" is locked'
    assert scripting.track(ob).warnings == (said,)
    scripting.take_reports()
    bpy.ops.rototoon.track()
    assert [report.warnings for report in scripting.take_reports()] == [(said,)]


def test_spans_with_a_blank_key_are_a_warning(addon, opened, scripting):  # noqa: F811
    for name in (studio.INK, studio.FRONT):
        opened.data.layers[name].frames.new(5)
    for name in (studio.INK,):
        opened.data.layers[name].frames.remove(5)
    scripting.take_reports()
    bpy.ops.rototoon.in_between(frames="ALL")
    (report,) = scripting.take_reports()
    assert report.kind == "WARNING" and report.warnings == ("2 spans with a blank key were left out: frame 5 is blank",)


def test_live_does_nothing_in_background(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    live = addon("capture.live")
    ob.rototoon.live = True
    shots.move(addon, ob, 1, 1, (2.0, 0.0)) if ob.rototoon.parts else None
    bpy.context.view_layer.update()
    assert not bpy.app.timers.is_registered(live._tick) and len(shots.layer_of(ob).frames) == 2
    live.reset()


def test_match_strokes_stores_the_pairs(addon, opened):  # noqa: F811
    gp = addon("blender.grease_pencil")
    assert bpy.ops.rototoon.match_strokes() == {"FINISHED"}
    for handle, _ in gp.drawings(opened.data.layers[studio.INK]).values():
        assert (np.sort(gp.value(handle, gp.TRACK, 2)) > 0).all()


def test_names_of_keys_are_those_of_the_list(addon, fake, tmp_path):
    scripting, ob = addon("scripting"), shots.set_up(tmp_path)
    assert scripting.set_key(ob, 1, {"arm ": shots.square(0)}) == ["arm"]
    assert scripting.set_key(ob, 9, {" arm": shots.square(8)}) == []
    before = shots.snapshot(ob)
    with pytest.raises(RuntimeError, match='two contours of "leg"'):
        scripting.set_key(ob, 5, {"leg": shots.square(4), " leg": shots.diamond(4)})
    assert shots.snapshot(ob) == before


def test_a_part_without_contours_takes_another_number_of_points(addon, fake, tmp_path):
    scripting, ob, gp = addon("scripting"), shots.set_up(tmp_path), addon("blender.grease_pencil")
    scripting.set_key(ob, 1, {"arm": shots.square(0)})
    gp.remove_strokes(gp.drawings(shots.layer_of(ob))[1][0], [0])
    assert scripting.set_key(ob, 1, {"arm": np.concatenate([shots.square(0), [[15.0, 40.0], [17.0, 35.0]]])}) == []
    scripting.set_key(ob, 9, {"leg": shots.diamond(8)})
    scripting.track(ob)
    assert {part.name: sorted(part.keys) for part in addon("capture.contours").read(ob).parts} == {"arm": [1], "leg": [9]}
    assert [part.count for part in ob.rototoon.parts] == [6, 4]

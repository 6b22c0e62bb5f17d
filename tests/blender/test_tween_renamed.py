"""Layers with in-betweens that get another name, or are doubled: their records go along."""

import bpy
import pytest
from test_strokes import add
from test_tween import drawn_again, figure, frames, keyed, mark, move

pytestmark = pytest.mark.usefixtures("library")


def said(addon):
    return addon("scripting").take_reports()[-1]


def spans(addon, ob):
    return {name: list(each.spans) for name, each in addon("tween.records").read(ob.data).items() if each.spans}


def between(addon, layers=("Lines",)):
    ob = keyed(addon, (1, 9), layers=layers)
    bpy.ops.rototoon.in_between(spacing="LINEAR", frames="ALL")
    return ob


def test_a_layer_with_another_name_is_updated(addon):
    ob = between(addon, ("Lines", "Other"))
    ob.data.layers["Lines"].name = "Rough"
    assert spans(addon, ob) == {"Rough": [1], "Other": [1]}
    for layer in ("Rough", "Other"):
        move(addon, ob, 9, by=0.4, layer=layer)
        mark(addon, ob, layer)
    bpy.ops.rototoon.update_in_betweens()
    assert drawn_again(addon, ob, "Rough") == drawn_again(addon, ob, "Other") == list(range(2, 9))


def test_a_new_layer_of_the_old_name_gets_nothing(addon):
    ob = between(addon)
    ob.data.layers["Lines"].name = "Rough"
    ob.data.layers.new("Lines")
    for frame in (1, 9):
        add(addon, ob, "Lines", frame, figure(0.1 * frame, 0.2))
    assert spans(addon, ob) == {"Rough": [1]}
    bpy.ops.rototoon.update_in_betweens()
    assert list(frames(addon, ob)) == [1, 9], "nobody asked for in-betweens on the new layer"
    assert spans(addon, ob) == {"Rough": [1]}
    assert addon("tween.records").read(ob.data)["Rough"].spans[1].choices.spacing == "LINEAR"


def test_a_doubled_layer_has_the_records_too(addon):
    ob = between(addon)
    gp = addon("blender.grease_pencil")
    layer, double = ob.data.layers["Lines"], ob.data.layers.new("Double")
    for frame, (handle, kind) in gp.drawings(layer).items():
        gp.make_frames(double, [frame], kind)
        addon("blender.strokes").write(gp.drawings(double)[frame][0], addon("blender.strokes").read(handle))
    assert spans(addon, ob) == {"Lines": [1], "Double": [1]}
    move(addon, ob, 9, by=0.4, layer="Double")
    mark(addon, ob, "Double")
    bpy.ops.rototoon.update_in_betweens()
    assert drawn_again(addon, ob, "Double") == list(range(2, 9))


def test_in_betweens_that_nothing_is_known_of_are_named(addon):
    ob = between(addon, ("Lines", "Other"))
    for frame in range(2, 9):
        move(addon, ob, frame, by=0.1)
    gp, records = addon("blender.grease_pencil"), addon("tween.records")
    known = records.read(ob.data)
    del known["Lines"]
    records.write(ob.data, known)
    addon("blender.marks").note(ob.data, "Lines", range(2, 9))
    assert "Lines" not in spans(addon, ob) and gp.find_layer(ob, "Lines") is not None
    bpy.ops.rototoon.update_in_betweens()
    assert 'the in-betweens of "Lines" stay as they were, since it is not known' in said(addon).text
    ob.data.layers.remove(ob.data.layers["Other"])
    with pytest.raises(RuntimeError, match='the in-betweens of "Lines" stay as they were'):
        bpy.ops.rototoon.update_in_betweens()

"""The list of parts while contours come and go: no part leaves it unasked."""

import bpy
import numpy as np
import pytest
import shots


def listed(ob):
    return [(part.name, part.depth) for part in ob.rototoon.parts]


def delete(addon, ob, frame, part):
    gp = addon("blender.grease_pencil")
    handle, _ = gp.drawings(shots.layer_of(ob))[frame]
    numbers = gp.value(handle, gp.PART, len(gp.offsets(handle)) - 1)
    gp.remove_strokes(handle, np.flatnonzero(numbers == part).tolist())


def message(addon):
    return addon("scripting").take_reports()[-1].text


def name_parts(ob, *names):
    for part, name in zip(ob.rototoon.parts, names, strict=True):
        part.name, part.depth = name, part.depth + 5.0


@pytest.mark.parametrize("renamed", ["layer", "field"])
def test_parts_stay_while_no_layer_has_the_name_of_the_contours(addon, fake, tmp_path, renamed):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    name_parts(ob, "head", "near arm")
    shots.move(addon, ob, 5, 2, (3.0, 2.0), which=[0])
    bpy.ops.rototoon.track()
    before, pinned = shots.snapshot(ob), addon("capture.document").read(ob).document["parts"]
    assert any("pins" in part for part in pinned)
    if renamed == "layer":
        shots.layer_of(ob).name = "Roto"
    else:
        ob.rototoon.contours_layer = "Roto"
    addon("capture.arrivals").look(ob)
    assert listed(ob) == [("head", 5.0), ("near arm", 6.0)]
    if renamed == "layer":
        ob.data.layers["Roto"].name = "Contours"
    else:
        ob.rototoon.contours_layer = "Contours"
    bpy.ops.rototoon.match_contours()
    assert shots.snapshot(ob) == before and addon("capture.document").read(ob).document["parts"] == pinned


def test_a_contour_that_is_cut_and_pasted_elsewhere_is_its_part(addon, fake, tmp_path):
    ob, gp, look = shots.set_up(tmp_path), addon("blender.grease_pencil"), addon("capture.arrivals").look
    shots.draw(addon, ob, 1, [shots.diamond(0), shots.square(0)])
    assert look(ob)
    name_parts(ob, "head", "near arm")
    drawing = gp.drawings(shots.layer_of(ob))[1][0]
    bpy.ops.object.mode_set(mode="EDIT")
    drawing.attributes.new(".selection", "BOOLEAN", "POINT").data.foreach_set("value", np.arange(8) > 3)
    bpy.ops.grease_pencil.copy()
    bpy.ops.grease_pencil.delete()
    look(ob)
    assert listed(ob) == [("head", 5.0), ("near arm", 6.0)]
    shots.layer_of(ob).frames.new(5)
    bpy.context.scene.frame_set(5)
    bpy.ops.grease_pencil.paste()
    bpy.ops.object.mode_set(mode="OBJECT")
    look(ob)
    bpy.ops.rototoon.match_contours()
    assert {part.name: sorted(part.keys) for part in addon("capture.contours").read(ob).parts} == {"head": [1], "near arm": [5]}


@pytest.mark.parametrize("button", ["track", "match_contours"])
def test_a_button_names_the_parts_that_leave_the_list(addon, fake, tmp_path, button):
    ob, look = shots.set_up(tmp_path), addon("capture.arrivals").look
    shots.draw(addon, ob, 1, [shots.square(0), shots.diamond(0)])
    assert look(ob)
    delete(addon, ob, 1, 1)
    assert not look(ob) and len(ob.rototoon.parts) == 2
    getattr(bpy.ops.rototoon, button)()
    assert [part.name for part in ob.rototoon.parts] == ["Part 2"]
    assert '; without a contour, and so no longer in the list: "Part 1"' in message(addon)


def test_contours_are_matched_beside_a_part_that_has_none(addon, fake, tmp_path):
    ob, look = shots.set_up(tmp_path), addon("capture.arrivals").look
    shots.draw(addon, ob, 1, [shots.square(0), shots.diamond(0)])
    assert look(ob)
    delete(addon, ob, 1, 1)
    shots.draw(addon, ob, 9, [shots.diamond(8)])
    assert look(ob) and sorted(addon("capture.contours").read(ob).part(2).keys) == [1, 9]


def test_parts_stay_whose_contours_are_on_a_layer_of_another_name(addon, fake, tmp_path):
    ob = shots.set_up(tmp_path)
    shots.draw(addon, ob, 1, [shots.diamond(0)])
    ob.data.layers.new("Contours.arm")
    ob.rototoon.contours_layer = "Contours.arm"
    shots.draw(addon, ob, 1, [shots.square(0)])
    ob.rototoon.contours_layer = "Contours"
    bpy.ops.rototoon.match_contours()
    name_parts(ob, "head", "near arm")
    ob.data.layers["Contours.arm"].name = "Arm"
    bpy.ops.rototoon.track()
    assert [part.name for part in ob.rototoon.parts] == ["head", "near arm"]
    assert "no longer in the list" not in message(addon)


def test_the_chosen_part_stays_chosen(addon, fake, tmp_path):
    ob = shots.set_up(tmp_path)
    shots.draw(addon, ob, 1, [shots.diamond(0), shots.square(0), shots.square(0)[:3] + 30.0])
    bpy.ops.rototoon.match_contours()
    ob.rototoon.active_part = 1
    delete(addon, ob, 1, 1)
    bpy.ops.rototoon.match_contours()
    assert ob.rototoon.parts[ob.rototoon.active_part].name == "Part 2"

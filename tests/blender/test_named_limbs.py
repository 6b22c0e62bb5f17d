"""Limbs and marks name parts: they go with a part's new name, and with a part that is deleted."""

import json

import bpy
import numpy as np
import pytest
import shots
from test_style import figure, performer, second_drawing


@pytest.fixture(autouse=True)
def needs_library(library):
    """All tests here."""


@pytest.fixture
def doll(addon, tmp_path):
    """A drawing with limbs, beside a library with the clip "walk" by "plain"."""
    shelf = str(tmp_path / "clips")
    performer(addon, tmp_path)
    bpy.ops.rototoon.save_clip(character="plain", motion="walk", folder=shelf)
    hat = np.array([[100.0, 20], [110, 20], [110, 30], [100, 30]])
    return second_drawing(addon, tmp_path, shelf, [*figure(), hat])


def reshaped(addon, ob):
    """All contours after Reshape Drawing, by frame and number."""
    assert bpy.ops.rototoon.reshape_drawing(character="plain", motion="walk") == {"FINISHED"}
    return {frame: dict(shots.pixels(addon, ob, frame)) for frame in range(2, shots.COUNT + 2)}


def alike(one, other):
    return all(np.allclose(points, other[frame][number]) for frame, own in one.items() for number, points in own.items())


def exported(tmp_path):
    path = tmp_path / "out.json"
    bpy.ops.rototoon.export_document(filepath=str(path))
    return json.loads(path.read_text())


def test_limbs_and_marks_go_with_new_names(addon, doll, tmp_path):
    leg, body, arm, hat = doll.rototoon.parts
    bpy.ops.rototoon.depth_mark(front=leg.name, behind=body.name)
    extra = json.loads(doll.rototoon.extra)
    doll.rototoon.extra = json.dumps({**extra, "follows": [{"part": hat.name, "of": body.name}], "reshaped": {arm.name: {}}})
    before = reshaped(addon, doll)
    leg.name, body.name, arm.name, hat.name = "leg", "body", "body", "hat"
    assert [part.name for part in doll.rototoon.parts] == ["leg", "body", "body.001", "hat"]
    written = exported(tmp_path)
    assert written["depth_marks"] == [{"front": "leg", "behind": "body"}]
    assert written["follows"] == [{"part": "hat", "of": "body"}] and list(written["reshaped"]) == ["body.001"]
    assert {point["part"] for limb in written["limbs"] for point in limb["start"]["points"]} == {"leg", "body", "body.001"}
    assert alike(before, reshaped(addon, doll))


def test_two_parts_exchange_their_names(addon, doll):
    before = reshaped(addon, doll)
    leg, _, arm, _ = doll.rototoon.parts
    first, second = leg.name, arm.name
    leg.name, arm.name = "x", first
    leg.name = second
    assert alike(before, reshaped(addon, doll))


def test_parts_of_an_older_file_are_known_by_their_names(addon, doll, tmp_path):
    for part in doll.rototoon.parts:
        part.known_as = ""
    path = str(tmp_path / "older.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    ob = bpy.context.object
    ob.rototoon.parts[2].name = "arm"
    reshaped(addon, ob)


def test_parts_of_an_open_file_are_known_after_an_update(addon, doll):
    for part in doll.rototoon.parts:
        part.known_as = ""
    handlers = addon("handlers")
    handlers.unregister()
    handlers.register()
    (later,) = [each for each in vars(handlers).values() if callable(each) and bpy.app.timers.is_registered(each)]
    assert later() is None
    doll.rototoon.parts[2].name = "arm"
    reshaped(addon, doll)


def remove(addon, ob, index):
    handle, _ = addon("blender.grease_pencil").drawings(shots.layer_of(ob))[1]
    handle.remove_strokes(indices=[index])


def said_of(addon, run):
    scripting = addon("scripting")
    scripting.take_reports()
    run()
    return scripting.take_reports()[-1].text


def test_marks_leave_with_their_part(addon, doll, tmp_path):
    names = [part.name for part in doll.rototoon.parts]
    bpy.ops.rototoon.depth_mark(front=names[3], behind=names[1])
    bpy.ops.rototoon.depth_mark(front=names[0], behind=names[1])
    remove(addon, doll, 3)
    lost = f'since a part has no contours: "{names[3]}" in front of "{names[1]}"'
    assert f"left out, {lost}" in said_of(addon, lambda: exported(tmp_path))
    assert exported(tmp_path)["depth_marks"] == [{"front": names[0], "behind": names[1]}], "the document stays of use before Match Contours, too"
    told = said_of(addon, lambda: reshaped(addon, doll))
    assert f'without effect, since a part has no contours: "{names[3]}" in front of "{names[1]}"' in told
    told = said_of(addon, bpy.ops.rototoon.match_contours)
    assert f'no longer in the list: "{names[3]}"; gone with it: "{names[3]}" in front of "{names[1]}"' in told
    assert addon("style.limbs").marks(doll) == [{"front": names[0], "behind": names[1]}]
    assert "without effect" not in said_of(addon, lambda: reshaped(addon, doll))


def test_limbs_of_a_part_without_contours_are_named(addon, doll):
    arm = doll.rototoon.parts[2].name
    count = len(addon("style.limbs").defined(doll))
    remove(addon, doll, 2)
    with pytest.raises(RuntimeError, match="limb neck to r_shoulder.*on a part without contours; press Define Limbs"):
        bpy.ops.rototoon.reshape_drawing(character="plain", motion="walk")
    told = said_of(addon, bpy.ops.rototoon.match_contours)
    assert f'"{arm}"; gone with it: limb neck to r_shoulder, limb r_shoulder to r_elbow, limb r_elbow to r_wrist' in told
    assert len(addon("style.limbs").defined(doll)) == count - 3
    reshaped(addon, doll)


@pytest.mark.parametrize("field", ["limbs", "depth_marks", "follows"])
def test_a_damaged_list_is_no_error_of_python(addon, doll, tmp_path, field):
    doll.rototoon.extra = json.dumps({**json.loads(doll.rototoon.extra), field: [None, 3, [], "arm"]})
    doll.rototoon.parts[0].name = "leg"
    assert exported(tmp_path)[field] == [None, 3, [], "arm"]


def test_names_with_blanks_at_their_ends_keep_limbs_and_marks(addon, doll, tmp_path):
    """Other programs may give parts such names; Blender has them without the blanks."""
    leg, body, *_ = doll.rototoon.parts
    bpy.ops.rototoon.depth_mark(front=leg.name, behind=body.name)
    document = exported(tmp_path)
    blank = json.loads(json.dumps(document).replace(json.dumps(leg.name), json.dumps(f" {leg.name} ")))
    assert blank["parts"] != document["parts"] and blank["limbs"] != document["limbs"]
    (tmp_path / "blank.json").write_text(json.dumps(blank))
    assert bpy.ops.rototoon.import_document(filepath=str(tmp_path / "blank.json")) == {"FINISHED"}
    back = exported(tmp_path)
    assert [back[field] for field in ("limbs", "depth_marks")] == [document[field] for field in ("limbs", "depth_marks")]
    assert [part["name"] for part in back["parts"]] == [part["name"] for part in document["parts"]]


def test_a_part_with_blanks_in_its_name_keeps_its_look(addon, doll, tmp_path):
    looks = addon("exchange.looks")
    known = looks.Looks({"arm": looks.Look("Contours Arm", np.array([0]), {}, {})})
    assert [known.layer_of(name, "Contours") for name in ("arm", " arm ", "leg")] == ["Contours Arm", "Contours Arm", "Contours"]
    assert list(known.rows([(" arm ", 1, 3), ("leg", 2, 3)], 0)) == []

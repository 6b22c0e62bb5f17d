"""What an artist changes on a generated drawing is the artist's: in-betweens, traced and snapped lines. With the real library."""

import bpy
import looks
import numpy as np
import pytest
import shots
from line_stage import film, handle_of, kinds, number_of, pictures, said, traced  # noqa: F401 - fixtures
from test_strokes import add, content, drawing, wave
from test_tween import frames, keyed, move, points


def between(addon, keys=(1, 9)):
    """An object with in-betweens, and two materials."""
    ob = keyed(addon, keys)
    looks.second_material(ob)
    bpy.ops.rototoon.in_between(frames="ALL")
    return ob


def told(addon, ob, frame, layer="Lines"):
    """Whether a drawing counts as it was generated."""
    marks = addon("blender.marks")
    return marks.untouched(content(addon, ob, layer, frame), marks.Slots(ob.data))


def test_what_blender_does_by_itself_is_no_change(addon, tmp_path):
    ob = between(addon)
    gp = addon("blender.grease_pencil")
    assert all(told(addon, ob, frame) for frame in range(2, 9)) and told(addon, ob, 1) is None
    handle = drawing(addon, ob, "Lines", 5)
    for name, kind, domain, value in (("rotation", "FLOAT", "POINT", 0.0), ("aspect_ratio", "FLOAT", "CURVE", 1.0)):
        attribute = handle.attributes.new(name, kind, domain)
        attribute.data.foreach_set("value", np.full(len(attribute.data), value, np.float32))
    handle.attributes.new(".selection", "BOOLEAN", "CURVE")
    assert told(addon, ob, 5), "attributes with their defaults, and selections"
    ob.data.layers["Lines"].name = "Other"
    gp.copy_frame(ob.data.layers["Other"], 5, 30)
    assert told(addon, ob, 5, "Other") and told(addon, ob, 30, "Other")
    path = str(tmp_path / "kept.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    assert told(addon, bpy.context.object, 5, "Other")


def test_modes_and_undo_are_no_change(addon):
    ob = between(addon)
    ob.select_set(True)
    bpy.context.scene.frame_set(5)
    for mode in ("EDIT", "SCULPT_GREASE_PENCIL", "PAINT_GREASE_PENCIL", "VERTEX_GREASE_PENCIL", "WEIGHT_GREASE_PENCIL"):
        bpy.ops.object.mode_set(mode=mode)
        bpy.ops.object.mode_set(mode="OBJECT")
        assert told(addon, ob, 5), mode
    bpy.ops.ed.undo_push(message="before")
    looks.CHANGES["radius"](addon, drawing(addon, ob, "Lines", 5))
    bpy.ops.ed.undo_push(message="radius")
    assert told(addon, ob, 5) is False
    bpy.ops.ed.undo()
    assert told(addon, bpy.context.object, 5)
    bpy.ops.ed.redo()
    assert told(addon, bpy.context.object, 5) is False and told(addon, bpy.context.object, 6)


def test_other_numbers_of_materials_are_no_change(addon):
    ob = keyed(addon, (1, 9))
    for _ in range(3):
        looks.second_material(ob)
    gp = addon("blender.grease_pencil")
    for frame in (1, 9):
        gp.put(drawing(addon, ob, "Lines", frame), "material_index", np.array([0, 2, 3], np.int32))
    bpy.ops.rototoon.in_between()
    ob.data.materials[3].name = "A new name"
    ob.active_material_index = 1
    bpy.ops.object.material_slot_remove()
    assert content(addon, ob, "Lines", 5).curve["material_index"].tolist() == [0, 1, 2]
    ob.active_material_index = 2
    bpy.ops.object.material_slot_move(direction="UP")
    assert told(addon, ob, 5)
    looks.CHANGES["material"](addon, drawing(addon, ob, "Lines", 5))
    gp.put(drawing(addon, ob, "Lines", 6), "material_index", np.zeros(3, np.int32))
    assert told(addon, ob, 6) is False and told(addon, ob, 7)


def test_a_change_to_the_material_that_had_the_number_before_is_one(addon):
    ob, gp = keyed(addon, (1, 9)), addon("blender.grease_pencil")
    looks.second_material(ob)
    for frame in (1, 9):
        gp.put(drawing(addon, ob, "Lines", frame), "material_index", np.zeros(3, np.int32))
    bpy.ops.rototoon.in_between()
    ob.active_material_index = 1
    bpy.ops.object.material_slot_move(direction="UP")
    assert content(addon, ob, "Lines", 5).curve["material_index"].tolist() == [1, 1, 1] and told(addon, ob, 5)
    move(addon, ob, 9, by=0.4)
    bpy.ops.rototoon.update_in_betweens()
    gp.put(drawing(addon, ob, "Lines", 5), "material_index", np.zeros(3, np.int32))
    assert told(addon, ob, 5) is False and told(addon, ob, 6)


def test_another_material_in_a_slot_is_no_change(addon):
    ob = between(addon)
    assert "material_index" not in content(addon, ob, "Lines", 5).curve
    ob.active_material_index = 1
    bpy.ops.object.material_slot_move(direction="UP")
    assert told(addon, ob, 5), "Blender gives strokes without a number the material that is first now"
    ob.data.materials[0] = bpy.data.materials.new("Third")
    assert told(addon, ob, 5)
    ob.data.materials[1] = ob.data.materials[0]
    assert told(addon, ob, 5)


def test_a_drawing_of_an_earlier_blender_is_untouched_when_its_fills_become_attributes(addon, monkeypatch):
    marks, gp = addon("blender.marks"), addon("blender.grease_pencil")
    ob = keyed(addon, (1, 9))
    monkeypatch.setattr(gp, "FILL_BY_ID", False)
    bpy.ops.rototoon.in_between()
    monkeypatch.setattr(gp, "FILL_BY_ID", True)
    handle = drawing(addon, ob, "Lines", 5)
    gp.put(handle, "fill_id", np.array([1, 0, 2], np.int32))
    gp.put(handle, "hide_stroke", np.array([True, False, False]))
    assert told(addon, ob, 5)
    marks.note(ob.data, "Lines", [5])
    gp.put(handle, "hide_stroke", np.zeros(3, bool))
    assert told(addon, ob, 5) is False, "now they are a look like others"


def test_a_look_noted_by_an_earlier_blender_stays_when_fills_become_attributes(addon, monkeypatch):
    marks, gp = addon("blender.marks"), addon("blender.grease_pencil")
    ob = keyed(addon, (1, 9))
    handle, slots = drawing(addon, ob, "Lines", 1), marks.Slots(ob.data)
    monkeypatch.setattr(gp, "FILL_BY_ID", False)
    noted = marks.stroke_looks(st_of(addon, handle), slots.now)
    monkeypatch.setattr(gp, "FILL_BY_ID", True)
    at_first = marks.stroke_looks(st_of(addon, handle), slots.now)
    gp.put(handle, "fill_id", np.array([1, 0, 2], np.int32))
    found = st_of(addon, handle)
    assert marks.has_looks(found, noted, slots).tolist() == [True, True, True]
    assert marks.has_looks(found, at_first, slots).tolist() == [False, True, False], "noted here, a fill is a look"
    looks.CHANGES["radius"](addon, handle)
    assert marks.has_looks(st_of(addon, handle), noted, slots).tolist() == [True, True, False]


def st_of(addon, handle):
    return addon("blender.strokes").read(handle)


@pytest.mark.parametrize("change", looks.CHANGES)
def test_an_in_between_with_another_look_becomes_a_key(addon, change):
    ob = between(addon)
    looks.CHANGES[change](addon, drawing(addon, ob, "Lines", 5))
    kept = content(addon, ob, "Lines", 5)
    move(addon, ob, 9, by=0.4)
    bpy.ops.rototoon.update_in_betweens()
    assert "1 drawing that you had changed is a key now: frame 5" in said(addon).text
    assert frames(addon, ob)[5] == "BREAKDOWN" and frames(addon, ob)[4] == frames(addon, ob)[6] == "GENERATED"
    now = content(addon, ob, "Lines", 5)
    for side in ("point", "curve"):
        for name, values in getattr(kept, side).items():
            assert name.startswith("rototoon_") or np.array_equal(getattr(now, side)[name], values), name
    assert np.array_equal(now.types, kept.types)


def test_in_betweens_that_were_changed_are_not_cleared(addon):
    ob = between(addon, (1, 9, 17))
    gp = addon("blender.grease_pencil")
    move(addon, ob, 5)
    looks.CHANGES["radius"](addon, drawing(addon, ob, "Lines", 12))
    gp.remove_strokes(drawing(addon, ob, "Lines", 15), [1])
    kept = {frame: content(addon, ob, "Lines", frame).point["position"] for frame in (5, 12, 15)}
    bpy.ops.rototoon.clear_in_betweens()
    text = "11 in-betweens removed, the in-betweens that you had changed on frames 5, 12 and 15 stay, as keys"
    assert said(addon).text == text
    expected = {1: "KEYFRAME", 5: "BREAKDOWN", 9: "KEYFRAME", 12: "BREAKDOWN", 15: "BREAKDOWN", 17: "KEYFRAME"}
    assert frames(addon, ob) == expected
    for frame, before in kept.items():
        assert np.array_equal(content(addon, ob, "Lines", frame).point["position"], before)


def test_an_in_between_with_a_new_stroke_becomes_a_key_too(addon):
    ob = between(addon)
    add(addon, ob, "Lines", 5, [wave(20)])
    move(addon, ob, 9, by=0.4)
    bpy.ops.rototoon.update_in_betweens()
    assert "1 drawing that you had changed is a key now: frame 5" in said(addon).text
    assert frames(addon, ob)[5] == "BREAKDOWN" and len(content(addon, ob, "Lines", 5).sizes) == 4
    bpy.ops.rototoon.clear_in_betweens()
    assert list(frames(addon, ob)) == [1, 5, 9]


def test_clearing_around_the_playhead_ends_at_a_changed_in_between(addon):
    ob = between(addon, (1, 17))
    move(addon, ob, 9)
    bpy.context.scene.frame_set(4)
    bpy.ops.rototoon.clear_in_betweens(frames="CURRENT")
    assert said(addon).text == "7 in-betweens removed, the in-between that you had changed on frame 9 stays, as a key"
    assert list(frames(addon, ob)) == [1, *range(9, 18)] and frames(addon, ob)[9] == "BREAKDOWN"
    # Only what is left is drawn again.
    bpy.ops.rototoon.update_in_betweens()
    assert list(frames(addon, ob)) == [1, *range(9, 18)]
    assert np.linalg.norm(points(addon, ob, 10)[0][3] - points(addon, ob, 9)[0][3]) < 0.3


def test_a_copied_in_between_that_was_changed_is_the_artists(addon):
    ob = between(addon)
    gp, layer = addon("blender.grease_pencil"), ob.data.layers["Lines"]
    for frame in (15, 20):
        gp.copy_frame(layer, 5, frame)
        gp.set_keyframe_type(layer, {frame: "GENERATED"})
    move(addon, ob, 20)
    bpy.ops.rototoon.clear_in_betweens()
    assert frames(addon, ob) == {1: "KEYFRAME", 9: "KEYFRAME", 20: "BREAKDOWN"}


def test_in_betweens_of_a_version_without_marks_are_what_they_were(addon):
    ob = between(addon, (1, 9, 17))
    looks.without_marks(addon, ob)
    move(addon, ob, 12)
    move(addon, ob, 9, by=0.4)
    bpy.ops.rototoon.update_in_betweens()
    assert [frame for frame, kind in frames(addon, ob).items() if kind == "BREAKDOWN"] == [12]
    looks.CHANGES["opacity"](addon, drawing(addon, ob, "Lines", 14))
    bpy.ops.rototoon.clear_in_betweens()
    assert list(frames(addon, ob)) == [1, 9, 12, 14, 17], "what was drawn since has marks"


def test_marks_from_before_an_older_version_drew_anew_do_not_count(addon):
    ob = between(addon)
    gp = addon("blender.grease_pencil")
    stale = {frame: gp.value(drawing(addon, ob, "Lines", frame), gp.MARK, 3) + 1 for frame in range(2, 9)}
    looks.without_marks(addon, ob)
    for frame, values in stale.items():
        gp.put(drawing(addon, ob, "Lines", frame), gp.MARK, values)
    bpy.ops.rototoon.clear_in_betweens()
    assert list(frames(addon, ob)) == [1, 9]


@pytest.mark.parametrize("change", looks.CHANGES)
def test_a_traced_drawing_with_another_look_is_a_key(addon, traced, fake, change):  # noqa: F811
    looks.second_material(traced)
    handle = handle_of(addon, traced, "Lines", 3)
    looks.CHANGES[change](addon, handle)
    kept = content(addon, traced, "Lines", 3)
    bpy.ops.rototoon.carry_strokes()
    # The stand-in's picture shows other lines, which is said besides.
    assert "1 drawing that you had changed is a key now" in said(addon).text
    assert kinds(addon, traced, "Lines") == {frame: "KEYFRAME" if frame == 3 else "GENERATED" for frame in range(1, 7)}
    now = content(addon, traced, "Lines", 3)
    for side in ("point", "curve"):
        for name, values in getattr(kept, side).items():
            assert name.startswith("rototoon_") or np.array_equal(getattr(now, side)[name], values), name


def test_clear_lines_names_the_drawings_that_stay(addon, traced):  # noqa: F811
    looks.CHANGES["softness"](addon, handle_of(addon, traced, "Lines", 2))
    looks.CHANGES["vertex colour"](addon, handle_of(addon, traced, "Lines", 5))
    bpy.ops.rototoon.clear_lines()
    text = "4 traced drawings removed, the traced drawings that you had changed on frames 2 and 5 stay, as keys"
    assert said(addon).text == text
    assert kinds(addon, traced, "Lines") == {2: "KEYFRAME", 5: "KEYFRAME"}


def test_traced_drawings_of_a_version_without_marks_are_what_they_were(addon, traced, fake):  # noqa: F811
    looks.without_marks(addon, traced)
    gp, handle = addon("blender.grease_pencil"), handle_of(addon, traced, "Lines", 4)
    found = gp.positions(handle, int(gp.offsets(handle)[-1]))
    gp.put(handle, "position", found + np.float32(0.1))
    bpy.ops.rototoon.trace_drawing()
    assert [frame for frame, kind in kinds(addon, traced, "Lines").items() if kind == "KEYFRAME"] == [4]


@pytest.mark.parametrize("change", ["radius", "material", "softness", "start cap", "own attribute of a stroke"])
def test_a_look_on_all_frames_stays_when_the_film_is_traced_again(addon, traced, fake, change):  # noqa: F811
    looks.second_material(traced)
    bpy.context.scene.frame_set(3)
    handle = handle_of(addon, traced, "Lines", 3)
    looks.CHANGES[change](addon, handle)
    assert bpy.ops.rototoon.spread_edits() == {"FINISHED"}
    assert said(addon).text == "1 edited stroke, on 5 other frames"
    with pytest.raises(RuntimeError, match="No stroke on this frame differs"):
        bpy.ops.rototoon.spread_edits()
    spread = {frame: content(addon, traced, "Lines", frame) for frame in range(1, 7)}
    bpy.ops.rototoon.trace_drawing()
    assert set(kinds(addon, traced, "Lines").values()) == {"KEYFRAME"}
    for frame, kept in spread.items():
        now = content(addon, traced, "Lines", frame)
        for side in ("point", "curve"):
            for name, values in getattr(kept, side).items():
                assert name.startswith("rototoon_") or np.array_equal(getattr(now, side)[name], values), (frame, name)
    names = {"material": "material_index", "start cap": "start_cap", "own attribute of a stroke": "mine_curve"}
    name = names.get(change, change)
    of_curve = name in spread[3].curve
    last = [(each.curve if of_curve else each.point)[name][-1] for each in spread.values()]
    assert len(set(map(float, last))) == 1, "the look is on all frames"


def test_a_look_on_all_frames_stays_in_a_file_of_a_version_without_marks(addon, traced, fake):  # noqa: F811
    looks.without_marks(addon, traced)
    looks.CHANGES["radius"](addon, handle_of(addon, traced, "Lines", 1))
    bpy.ops.rototoon.spread_edits()
    assert said(addon).text == "1 edited stroke, on 5 other frames"
    bpy.ops.rototoon.clear_lines()
    assert list(kinds(addon, traced, "Lines")) == list(range(1, 7))


def snapped(addon, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    bpy.ops.rototoon.snap()
    return ob


def snapped_kinds(ob):
    return {frame.frame_number: frame.keyframe_type for frame in ob.data.layers["Snapped"].frames}


def test_a_snapped_drawing_that_was_changed_stays(addon, fake, tmp_path):
    ob = snapped(addon, tmp_path)
    move(addon, ob, 5, layer="Snapped")
    looks.CHANGES["opacity"](addon, drawing(addon, ob, "Snapped", 7))
    kept = {frame: content(addon, ob, "Snapped", frame) for frame in (5, 7)}
    bpy.ops.rototoon.snap()
    stay = "the drawings that you had changed on frames 5 and 7 stay, as keys"
    assert said(addon).text == f'14 lines on the layer "Snapped", {stay}'
    assert [frame for frame, kind in snapped_kinds(ob).items() if kind == "KEYFRAME"] == [5, 7]
    assert all(content(addon, ob, "Snapped", frame).equals(before) for frame, before in kept.items())
    bpy.ops.rototoon.snap()
    assert said(addon).text == '14 lines on the layer "Snapped"', "it is said once"


def test_clear_generated_leaves_changed_snapped_drawings_unless_asked(addon, fake, tmp_path):
    ob = snapped(addon, tmp_path)
    move(addon, ob, 5, layer="Snapped")
    bpy.ops.rototoon.clear_generated()
    assert said(addon).text.endswith("the snapped drawing that you had changed on frame 5 stays, as a key")
    assert snapped_kinds(ob) == {5: "KEYFRAME"}
    ob = snapped(addon, tmp_path)
    move(addon, ob, 5, layer="Snapped")
    bpy.ops.rototoon.clear_generated(corrected=True)
    assert snapped_kinds(ob) == {}


@pytest.mark.usefixtures("library")
def test_fitted_and_cut_snapped_lines_are_snapped_again(addon, fake, tmp_path):
    ob = snapped(addon, tmp_path)
    before = content(addon, ob, "Snapped", 5)
    bpy.ops.rototoon.fit_strokes(frames="ALL", tolerance=2.0)
    bpy.ops.rototoon.hidden_lines(frames="CURRENT", covers="CLOSED")
    assert not content(addon, ob, "Snapped", 5).equals(before)
    bpy.ops.rototoon.snap()
    assert set(snapped_kinds(ob).values()) == {"GENERATED"}
    assert np.array_equal(content(addon, ob, "Snapped", 5).point["position"], before.point["position"])


def test_track_says_where_it_sets_looks_back(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    looks.second_material(ob)
    bpy.ops.rototoon.track()
    name = shots.layer_of(ob).name
    looks.CHANGES["radius"](addon, drawing(addon, ob, name, 5))
    looks.CHANGES["opacity"](addon, drawing(addon, ob, name, 6))
    # The keys have no vertex colours, so this one stays.
    looks.CHANGES["vertex colour"](addon, drawing(addon, ob, name, 8))
    addon("common.reports").take()
    bpy.ops.rototoon.track()
    report = said(addon)
    assert report.warnings == ("tracked contours look like the keys again on 5 and 6: to change a part's look, change it on its keys",)
    assert not report.text.startswith("Nothing to track again")
    assert content(addon, ob, name, 8).point["vertex_color"][-1].any()
    bpy.ops.rototoon.track()
    assert said(addon).warnings == (), "it is said once"
    # A look of the keys goes to the tracked contours: that is what the artist wants.
    looks.CHANGES["radius"](addon, drawing(addon, ob, name, 1))
    bpy.ops.rototoon.track()
    assert said(addon).warnings == ()
    before = shots.snapshot(ob)
    bpy.ops.rototoon.track()
    assert shots.snapshot(ob) == before


def test_a_file_of_a_version_without_marks_has_them_once_it_is_opened(addon, traced, fake, tmp_path):  # noqa: F811
    gp = addon("blender.grease_pencil")
    other = between(addon, (1, 9, 17))
    move(addon, other, 5)
    looks.CHANGES["softness"](addon, drawing(addon, other, "Lines", 12))
    for ob in (traced, other):
        looks.without_marks(addon, ob)
    handle = handle_of(addon, traced, "Lines", 4)
    gp.put(handle, "position", gp.positions(handle, int(gp.offsets(handle)[-1])) + np.float32(0.1))
    names, path = (traced.name, other.name), str(tmp_path / "older.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    lines, other = (bpy.data.objects[name] for name in names)
    # What was changed before counts as that version saw it: moved points alone.
    looks.CHANGES["opacity"](addon, handle_of(addon, lines, "Lines", 2))
    looks.CHANGES["radius"](addon, drawing(addon, other, "Lines", 14))
    for ob in (lines, other):
        bpy.context.view_layer.objects.active = ob
        (bpy.ops.rototoon.clear_lines if ob == lines else bpy.ops.rototoon.clear_in_betweens)()
    assert list(kinds(addon, lines, "Lines")) == [2, 4]
    assert list(frames(addon, other)) == [1, 5, 9, 14, 17]


def test_snapped_lines_of_a_version_without_marks_are_kept_if_changed_after_opening(addon, fake, tmp_path):
    ob = snapped(addon, tmp_path)
    looks.without_marks(addon, ob)
    path = str(tmp_path / "older.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    ob = bpy.context.object
    move(addon, ob, 5, layer="Snapped")
    bpy.ops.rototoon.snap()
    assert [frame for frame, kind in snapped_kinds(ob).items() if kind == "KEYFRAME"] == [5]


def test_a_record_that_cannot_be_read_stays_when_the_file_is_opened(addon, tmp_path):
    ob = between(addon)
    for name in ("rototoon_tween", "rototoon_lines"):
        ob.data[name] = "{broken"
    path = str(tmp_path / "broken.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    assert [bpy.context.object.data[name] for name in ("rototoon_tween", "rototoon_lines")] == ["{broken"] * 2

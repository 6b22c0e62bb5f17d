"""Which contours on tracked frames are the artist's: copies, contours that were held, and those of other numbers of points are not mixed up."""

import bpy
import numpy as np
import pytest
import shots

# Blender 5.0 ends in its own operator, in an empty file too.
duplicates = pytest.mark.skipif(bpy.app.version[:2] == (5, 0), reason="Duplicate ends Blender 5.0 in background")


def octagon(frame):
    corners = shots.square(frame)
    return np.stack([corners, (corners + np.roll(corners, -1, 0)) / 2], 1).reshape(-1, 2)


def counted(addon, ob):
    """By part its number of points, its keys and its tracked frames."""
    return {part.name: (part.count, sorted(part.keys), sorted(part.made)) for part in addon("capture.contours").read(ob).parts}


def keys(addon, ob):
    return {name: own for name, (_, own, _) in counted(addon, ob).items()}


def kind(ob, frame):
    return next(each.keyframe_type for each in shots.layer_of(ob).frames if each.frame_number == frame)


def said(addon):
    return [report.text for report in addon("scripting").take_reports()][-1]


def in_edit_mode(addon, ob, frame, part, do, points=slice(None)):
    """Does something with points of a part's last stroke on a frame."""
    gp = addon("blender.grease_pencil")
    bpy.context.scene.frame_set(frame)
    bpy.ops.object.mode_set(mode="EDIT")
    handle = gp.drawings(shots.layer_of(ob))[frame][0]
    starts = gp.offsets(handle)
    index = np.flatnonzero(gp.value(handle, gp.PART, len(starts) - 1) == part)[-1]
    chosen = np.zeros(int(starts[-1]), bool)
    chosen[starts[index] : starts[index + 1]][points] = True
    selection = handle.attributes.get(".selection") or handle.attributes.new(".selection", "BOOLEAN", "POINT")
    selection.data.foreach_set("value", chosen)
    do()
    bpy.ops.object.mode_set(mode="OBJECT")


def last_moved(addon, ob, frame, shift):
    """Moves the last stroke of a frame by pixels."""
    gp, mapping = addon("blender.grease_pencil"), shots.mapping(addon, ob, frame)
    handle = gp.drawings(shots.layer_of(ob))[frame][0]
    starts = gp.offsets(handle)
    points = gp.positions(handle, int(starts[-1]))
    last = slice(int(starts[-2]), int(starts[-1]))
    points[last] = mapping.to_layer(mapping.to_pixels(points[last]) + shift)
    gp.put(handle, "position", points)


@duplicates
def test_a_tracked_contour_that_is_duplicated_is_the_artists(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    tracked = dict(shots.pixels(addon, ob, 5))[2]
    in_edit_mode(addon, ob, 5, 2, bpy.ops.grease_pencil.duplicate)
    last_moved(addon, ob, 5, (60.0, -20.0))
    bpy.ops.rototoon.track()
    assert keys(addon, ob) == {"Part 1": [1, 9], "Part 2": [1, 9], "Part 3": [5]}
    assert 'new parts: "Part 3" on 5' in said(addon)
    now = dict(shots.pixels(addon, ob, 5))
    assert now[3] == pytest.approx(tracked + (60.0, -20.0), abs=1e-3) and now[2] == pytest.approx(tracked, abs=1e-3)


@duplicates
def test_a_duplicate_in_its_place_is_no_part(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    in_edit_mode(addon, ob, 5, 2, bpy.ops.grease_pencil.duplicate)
    bpy.ops.rototoon.track()
    assert keys(addon, ob) == {"Part 1": [1, 9], "Part 2": [1, 9]} and len(shots.pixels(addon, ob, 5)) == 2


def test_a_tracked_contour_that_is_pasted_on_another_tracked_frame_is_the_artists(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    pasted = dict(shots.pixels(addon, ob, 4))[2]
    in_edit_mode(addon, ob, 4, 2, bpy.ops.grease_pencil.copy)
    bpy.context.scene.frame_set(5)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.grease_pencil.paste()
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.ops.rototoon.track()
    assert keys(addon, ob) == {"Part 1": [1, 9], "Part 2": [1, 5, 9]}
    assert dict(shots.pixels(addon, ob, 5))[2] == pytest.approx(pasted, abs=1e-3)


@pytest.mark.parametrize("moved", [True, False])
def test_a_tracked_contour_that_is_pasted_on_a_key_frame_is_a_key(addon, fake, tmp_path, moved):
    ob = shots.set_up(tmp_path)
    for frame in (1, 6):
        shots.draw(addon, ob, frame, [shots.diamond(frame - 1), shots.square(frame - 1)])
    bpy.ops.rototoon.match_contours()
    bpy.context.scene.frame_set(9)
    bpy.ops.rototoon.new_key(parts="ACTIVE")
    bpy.ops.rototoon.track()
    in_edit_mode(addon, ob, 3, 2, bpy.ops.grease_pencil.copy)
    bpy.context.scene.frame_set(9)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.grease_pencil.paste()
    bpy.ops.object.mode_set(mode="OBJECT")
    last_moved(addon, ob, 9, (10.0 * moved, 0.0))
    pasted = dict(shots.pixels(addon, ob, 9))[2]
    bpy.ops.rototoon.track()
    assert keys(addon, ob) == {"Part 1": [1, 6, 9], "Part 2": [1, 6, 9]}
    assert np.array_equal(dict(shots.pixels(addon, ob, 9))[2], pasted)


@pytest.mark.parametrize("button", ["match_contours", "new_key"])
def test_tracked_contours_stay_tracked_after_their_key_got_another_number_of_points(addon, fake, tmp_path, button):
    ob = shots.set_up(tmp_path)
    shots.draw(addon, ob, 1, [shots.diamond(0), octagon(0)])
    bpy.ops.rototoon.track()
    made = counted(addon, ob)["Part 2"][2]
    assert made
    in_edit_mode(addon, ob, 1, 2, lambda: bpy.ops.grease_pencil.dissolve(type="POINTS"), slice(1, 2))
    bpy.context.scene.frame_set(1 if button == "match_contours" else made[-1])
    getattr(bpy.ops.rototoon, button)()
    own = [1] if button == "match_contours" else [1, made[-1]]
    assert counted(addon, ob)["Part 2"] == (7, own, [])
    bpy.ops.rototoon.track()
    assert counted(addon, ob)["Part 2"] == (7, own, [frame for frame in made if frame not in own])
    assert all(kind(ob, frame) == "GENERATED" for frame in made if frame not in own)


def test_tracked_contours_stay_tracked_after_the_key_with_more_points_was_deleted(addon, fake, tmp_path):
    ob = shots.set_up(tmp_path)
    shots.draw(addon, ob, 1, [shots.diamond(0), octagon(0)])
    bpy.context.scene.frame_set(9)
    bpy.ops.rototoon.new_key()
    in_edit_mode(addon, ob, 9, 2, lambda: bpy.ops.grease_pencil.dissolve(type="POINTS"), slice(1, 2))
    bpy.ops.rototoon.track()
    in_edit_mode(addon, ob, 1, 2, bpy.ops.grease_pencil.delete)
    bpy.ops.rototoon.new_key()
    assert counted(addon, ob)["Part 2"] == (7, [1, 9], [])
    bpy.ops.rototoon.track()
    assert counted(addon, ob)["Part 2"] == (7, [1, 9], [2, 3, 4, 5, 6, 7, 8])


@pytest.mark.parametrize("point", [1, 7])
def test_a_point_less_on_a_tracked_frame_still_makes_a_key(addon, fake, tmp_path, point):
    ob = shots.set_up(tmp_path)
    for frame in (1, 9):
        shots.draw(addon, ob, frame, [octagon(frame - 1)])
    bpy.ops.rototoon.track()
    in_edit_mode(addon, ob, 5, 1, lambda: bpy.ops.grease_pencil.dissolve(type="POINTS"), slice(point, point + 1))
    bpy.ops.rototoon.track()
    assert counted(addon, ob)["Part 1"] == (8, [1, 5, 9], [2, 3, 4, 6, 7, 8])


def test_track_names_corrections_that_another_number_of_points_takes_away(addon, fake, tmp_path):
    ob = shots.set_up(tmp_path)
    shots.draw(addon, ob, 1, [shots.diamond(0), octagon(0)])
    bpy.ops.rototoon.track()
    shots.move(addon, ob, 2, 2, (6.0, 3.0), which=[0, 4])
    bpy.ops.rototoon.track()
    in_edit_mode(addon, ob, 1, 2, lambda: bpy.ops.grease_pencil.dissolve(type="POINTS"), slice(1, 2))
    bpy.ops.rototoon.track()
    assert 'your corrections of "Part 2" on 2 are gone, since its keys have another number of points' in said(addon)
    bpy.ops.rototoon.track()
    assert "are gone" not in said(addon)


@pytest.mark.parametrize("mistake", ["a stroke", "a key of one part"])
def test_what_is_left_on_a_frame_is_tracked_after_its_last_own_stroke_was_deleted(addon, fake, tmp_path, mistake):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    bpy.context.scene.frame_set(5)
    if mistake == "a stroke":
        shots.draw(addon, ob, 5, [np.array([[130.0, 5], [150, 5], [150, 10], [130, 12], [120, 9]])])
        bpy.ops.rototoon.match_contours()
    else:
        bpy.ops.rototoon.new_key(parts="ACTIVE")
    in_edit_mode(addon, ob, 5, 3 if mistake == "a stroke" else 1, bpy.ops.grease_pencil.delete)
    shots.move(addon, ob, 9, 2, (0.0, 20.0))
    before = dict(shots.pixels(addon, ob, 5))[2]
    bpy.ops.rototoon.track()
    assert keys(addon, ob) == {"Part 1": [1, 9], "Part 2": [1, 9]} and kind(ob, 5) == "GENERATED"
    assert dict(shots.pixels(addon, ob, 5))[2] == pytest.approx(before + (0.0, 10.0), abs=1e-3)


def test_clear_generated_takes_what_is_left_on_such_a_frame(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    bpy.context.scene.frame_set(5)
    bpy.ops.rototoon.new_key(parts="ACTIVE")
    in_edit_mode(addon, ob, 5, 1, bpy.ops.grease_pencil.delete)
    bpy.ops.rototoon.clear_generated()
    assert [frame.frame_number for frame in shots.layer_of(ob).frames] == [1, 9]


def test_a_drawing_that_the_artist_makes_a_key_stays_one_beside_a_new_stroke(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    next(frame for frame in shots.layer_of(ob).frames if frame.frame_number == 5).keyframe_type = "KEYFRAME"
    shots.draw(addon, ob, 5, [np.array([[130.0, 5], [150, 5], [150, 10], [130, 12], [120, 9]])])
    bpy.ops.rototoon.track()
    assert keys(addon, ob) == {"Part 1": [1, 5, 9], "Part 2": [1, 5, 9], "Part 3": [5]}


def test_mixed_frames_of_older_versions_stay_mixed(addon, fake, tmp_path):
    ob, gp = shots.two_keys(addon, tmp_path), addon("blender.grease_pencil")
    bpy.ops.rototoon.track()
    bpy.context.scene.frame_set(5)
    bpy.ops.rototoon.new_key(parts="ACTIVE")
    for frame in shots.layer_of(ob).frames:
        for name in (gp.BESIDE, gp.POINTS):
            if gp.has(frame.drawing, name):
                frame.drawing.attributes.remove(frame.drawing.attributes[name])
    assert keys(addon, ob) == {"Part 1": [1, 5, 9], "Part 2": [1, 9]}
    bpy.ops.rototoon.track()
    assert keys(addon, ob) == {"Part 1": [1, 5, 9], "Part 2": [1, 9]}


def test_a_line_that_is_held_beyond_a_new_key_becomes_a_key(addon, fake, tmp_path, monkeypatch):
    monkeypatch.setattr(fake, "REACH", 8)
    ob = shots.set_up(tmp_path)
    shots.draw(addon, ob, 1, [shots.diamond(0), shots.square(0)])
    bpy.ops.rototoon.track()
    shots.move(addon, ob, 8, 1, (5.0, 4.0))
    shots.move(addon, ob, 7, 2, (5.0, 4.0), which=[0])
    bpy.ops.rototoon.track()
    held = dict(shots.pixels(addon, ob, 8))[1]
    bpy.context.scene.frame_set(5)
    bpy.ops.rototoon.new_key()
    bpy.ops.rototoon.track()
    assert keys(addon, ob) == {"Part 1": [1, 5, 8], "Part 2": [1, 5]}
    assert np.array_equal(dict(shots.pixels(addon, ob, 8))[1], held)
    assert 'your corrections of "Part 2" on 7 are gone, since no key holds it there' in said(addon)


def made_active(ob):
    for each in bpy.context.view_layer.objects:
        each.select_set(each == ob)
    bpy.context.view_layer.objects.active = ob


@pytest.mark.parametrize("tracked", [False, True])
def test_a_contour_of_another_object_is_a_new_one(addon, fake, tmp_path, tracked):
    """A key, or a tracked contour, that is pasted beside the tracked contours of this object."""
    ob, other = shots.two_keys(addon, tmp_path), shots.two_keys(addon, tmp_path / "other")
    for each in (ob, other):
        made_active(each)
        bpy.ops.rototoon.track()
    in_edit_mode(addon, other, 3 if tracked else 1, 2, bpy.ops.grease_pencil.copy)
    made_active(ob)
    ob.data.layers.active = shots.layer_of(ob)
    bpy.context.scene.frame_set(5)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.grease_pencil.paste()
    bpy.ops.object.mode_set(mode="OBJECT")
    last_moved(addon, ob, 5, (90.0, -20.0))
    assert len(shots.pixels(addon, ob, 5)) == 3
    bpy.ops.rototoon.track()
    assert keys(addon, ob) == {"Part 1": [1, 9], "Part 2": [1, 9], "Part 3": [5]}
    assert ob.rototoon.stamp != other.rototoon.stamp
    # From now on it is a contour of this object.
    in_edit_mode(addon, ob, 5, 3, bpy.ops.grease_pencil.copy)
    bpy.context.scene.frame_set(9)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.grease_pencil.paste()
    bpy.ops.object.mode_set(mode="OBJECT")
    assert keys(addon, ob)["Part 3"] == [5, 9]


def test_a_copy_of_the_drawings_with_the_list_of_parts_keeps_its_parts(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    copy = shots.set_up(tmp_path / "copy")
    copy.data = ob.data.copy()
    for part in ob.rototoon.parts:
        item = copy.rototoon.parts.add()
        item.number, item.name, item.closed, item.depth, item.count = part.number, part.name, part.closed, part.depth, part.count
    bpy.ops.rototoon.track()
    assert keys(addon, copy) == {"Part 1": [1, 9], "Part 2": [1, 9]}
    assert copy.rototoon.stamp != ob.rototoon.stamp


def copy_of(ob):
    """A copy of an object with drawings of its own, as Duplicate makes it."""
    copy = ob.copy()
    copy.data = ob.data.copy()
    bpy.context.collection.objects.link(copy)
    return copy


def new_key(addon, ob, name, shape, by):
    """A part of its own on frame 1, by a script or drawn and matched."""
    if by == "script":
        addon("scripting").set_key(ob, 1, {name: shape})
        return
    made_active(ob)
    shots.draw(addon, ob, 1, [shape])
    bpy.ops.rototoon.match_contours()
    ob.rototoon.parts[-1].name = name


@pytest.mark.parametrize("by", ["script", "artist"])
@pytest.mark.parametrize("copy_first", [False, True])
def test_a_contour_of_a_copy_is_a_new_one(addon, fake, tmp_path, by, copy_first):
    """Both get a third part after the copy, with the same number."""
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    other = copy_of(ob)
    bag, hat = shots.square(0) * 0.5, np.array([[130.0, 5], [150, 5], [150, 10], [130, 12], [120, 9]])
    for each in (other, ob) if copy_first else (ob, other):
        new_key(addon, each, *(("bag", bag) if each == ob else ("hat", hat)), by)
    made_active(other)
    in_edit_mode(addon, other, 1, 3, bpy.ops.grease_pencil.copy)
    made_active(ob)
    ob.data.layers.active = shots.layer_of(ob)
    bpy.context.scene.frame_set(9)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.grease_pencil.paste()
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.ops.rototoon.match_contours()
    first = {"Part 1": [1, 9], "Part 2": [1, 9]}
    assert keys(addon, ob) == {**first, "bag": [1], "Part 4": [9]}
    assert keys(addon, other) == {**first, "hat": [1]}
    for each in (ob, other):
        made_active(each)
        bpy.ops.rototoon.track()
        assert [tracked for _, _, tracked in counted(addon, each).values()][:2] == [list(range(2, 9))] * 2


def test_a_copy_with_a_locked_layer_keeps_its_parts(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    other = copy_of(ob)
    made_active(other)
    shots.layer_of(other).lock = True
    addon("scripting").set_key(other, 1, {"hat": shots.square(0) * 0.5}, layer="Contours.hats")
    assert keys(addon, other) == {"Part 1": [1, 9], "Part 2": [1, 9], "hat": [1]}
    shots.layer_of(other).lock = False
    bpy.ops.rototoon.track()
    assert keys(addon, other) == {"Part 1": [1, 9], "Part 2": [1, 9], "hat": [1]} and other.rototoon.stamp != ob.rototoon.stamp


def test_a_contour_of_an_imported_document_is_a_new_one_elsewhere(addon, fake, tmp_path):
    other = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.export_document(filepath=str(tmp_path / "shot.json"))
    bpy.ops.rototoon.import_document(filepath=str(tmp_path / "shot.json"))
    imported, ob = bpy.context.object, shots.two_keys(addon, tmp_path / "other")
    assert imported not in (ob, other)
    bpy.ops.rototoon.track()
    made_active(imported)
    in_edit_mode(addon, imported, 1, 1, bpy.ops.grease_pencil.copy)
    made_active(ob)
    ob.data.layers.active = shots.layer_of(ob)
    bpy.context.scene.frame_set(5)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.grease_pencil.paste()
    bpy.ops.object.mode_set(mode="OBJECT")
    last_moved(addon, ob, 5, (20.0, -30.0))
    bpy.ops.rototoon.match_contours()
    assert keys(addon, ob) == {"Part 1": [1, 9], "Part 2": [1, 9], "Part 3": [5]}


def test_a_joined_object_brings_its_keys_as_new_parts(addon, fake, tmp_path):
    ob, other = shots.two_keys(addon, tmp_path), shots.two_keys(addon, tmp_path / "other")
    for each in (ob, other):
        made_active(each)
        bpy.ops.rototoon.track()
    for frame in (1, 9):
        for part in (1, 2):
            shots.move(addon, other, frame, part, (20.0, -15.0))
    made_active(ob)
    other.select_set(True)
    bpy.ops.object.join()
    assert sorted(layer.name for layer in ob.data.layers) == ["Contours", "Contours.001"]
    bpy.ops.rototoon.track()
    assert keys(addon, ob) == {f"Part {number}": [1, 9] for number in (1, 2, 3, 4)}


def test_a_traced_line_that_is_pasted_on_a_tracked_frame_is_a_new_contour(addon, fake, tmp_path):
    ob, gp = shots.two_keys(addon, tmp_path), addon("blender.grease_pencil")
    bpy.ops.rototoon.track()
    drawing = shots.draw(addon, ob, 5, [np.array([[130.0, 5], [150, 5], [150, 10], [130, 12], [120, 9]])])
    # Traced lines have the mark of generated strokes, and no part.
    gp.put(drawing, gp.MADE, np.ones(3, bool))
    bpy.ops.rototoon.track()
    assert keys(addon, ob) == {"Part 1": [1, 9], "Part 2": [1, 9], "Part 3": [5]}

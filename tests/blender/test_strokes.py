"""Fit Strokes and Remove Hidden Lines, in background, with the real library."""

import bpy
import numpy as np
import pytest

pytestmark = [pytest.mark.every_version, pytest.mark.usefixtures("library")]


def drawing_object(addon, layers=("Lines",), filled=False):
    """An object with empty layers and a material, seen from the front, 100 pixels a unit."""
    gp = addon("blender.grease_pencil")
    ob = gp.new_object("Drawing", bpy.context.collection)
    bpy.context.view_layer.objects.active = ob
    if filled:
        ob.data.materials[0].grease_pencil.show_fill = True
    for name in layers:
        ob.data.layers.new(name)
    return ob


def add(addon, ob, layer, frame, shapes, cyclic=False, **attributes):
    """Strokes through points (x, z) on a frame of a layer; attributes as arrays by name."""
    gp = addon("blender.grease_pencil")
    layer = ob.data.layers[layer]
    gp.make_frames(layer, [frame], gp.KEYFRAME)
    drawing = gp.drawings(layer)[frame][0]
    before = gp.offsets(drawing)
    drawing.add_strokes([len(shape) for shape in shapes])
    total = int(gp.offsets(drawing)[-1])
    points = gp.positions(drawing, total)
    flat = np.concatenate([np.asarray(shape, float) for shape in shapes])
    points[before[-1] :, 0], points[before[-1] :, 2] = flat[:, 0], flat[:, 1]
    gp.put(drawing, "position", points)
    flags = gp.value(drawing, "cyclic", len(before) - 1 + len(shapes))
    flags[len(before) - 1 :] = cyclic
    gp.put(drawing, "cyclic", flags)
    for name, usual in (("opacity", 1.0), ("radius", 0.02)):
        values = gp.value(drawing, name, total)
        values[before[-1] :] = usual
        gp.put(drawing, name, values)
    for name, values in attributes.items():
        gp.put(drawing, name, values)
    drawing.tag_positions_changed()
    return drawing


def drawing(addon, ob, layer, frame):
    return addon("blender.grease_pencil").drawings(ob.data.layers[layer])[frame][0]


def content(addon, ob, layer, frame):
    return addon("blender.strokes").read(drawing(addon, ob, layer, frame))


def wave(count=400, length=4.0):
    x = np.linspace(0, length, count)
    return np.stack([x, 0.4 * np.sin(2 * x)], 1)


def circle(centre, radius, count=64):
    turn = np.linspace(0, 2 * np.pi, count, endpoint=False)
    return np.asarray(centre) + radius * np.stack([np.cos(turn), np.sin(turn)], 1)


def evaluated(ob):
    """The polyline vertices (x, z) that Blender itself makes of the strokes that show."""
    for other in bpy.context.view_layer.objects:
        other.select_set(other == ob)
    bpy.context.view_layer.objects.active = ob
    bpy.context.view_layer.update()
    bpy.ops.object.convert(target="CURVES", keep_original=True)
    bpy.ops.object.convert(target="MESH", keep_original=False)
    made = bpy.context.object
    points = np.empty(3 * len(made.data.vertices))
    made.data.vertices.foreach_get("co", points)
    bpy.data.objects.remove(made)
    bpy.context.view_layer.objects.active = ob
    return points.reshape(-1, 3)[:, [0, 2]]


def distance(points, line, closed=False):
    """Largest distance of points to a polyline."""
    ends = np.vstack([line, line[:1]]) if closed else line
    a, b = ends[:-1], ends[1:]
    along = np.einsum("pij,ij->pi", points[:, None] - a, b - a) / np.maximum(((b - a) ** 2).sum(1), 1e-30)
    foot = a + np.clip(along, 0, 1)[..., None] * (b - a)
    return np.sqrt(((points[:, None] - foot) ** 2).sum(-1)).min(1).max()


# -- Fit Strokes ------------------------------------------------------------------------------------------------------


def test_fitted_strokes_are_light_and_within_the_tolerance(addon):
    ob = drawing_object(addon)
    add(addon, ob, "Lines", 1, [wave()])
    add(addon, ob, "Lines", 1, [circle((2, 2), 1, 300)], cyclic=True)
    assert bpy.ops.rototoon.fit_strokes(tolerance=1.0) == {"FINISHED"}
    found = content(addon, ob, "Lines", 1)
    assert list(found.types) == [3, 3] and list(found.curve["cyclic"]) == [False, True]
    assert (found.sizes < 20).all() and (found.sizes > 3).all()
    points = evaluated(ob)
    # 1 pixel is a hundredth of a unit in the front view; Blender's polyline may be a tenth farther off.
    of_wave = points[:, 1] < 0.9
    assert of_wave.any() and not of_wave.all()
    assert distance(points[of_wave], wave()) < 0.0112
    assert distance(wave(), points[of_wave]) < 0.0112
    assert distance(points[~of_wave], circle((2, 2), 1, 300), closed=True) < 0.0112
    assert distance(circle((2, 2), 1, 300), points[~of_wave], closed=True) < 0.0112


def test_what_strokes_carry_stays(addon):
    ob = drawing_object(addon)
    count = 400
    ramp = np.linspace(0.01, 0.05, count).astype(np.float32)
    handle = add(addon, ob, "Lines", 1, [wave(count)], radius=ramp, opacity=np.linspace(1, 0.2, count))
    gp = addon("blender.grease_pencil")
    gp.put(handle, "vertex_color", np.tile([0.2, 0.4, 0.6, 1.0], (count, 1)))
    gp.put(handle, gp.PART, np.array([7]))
    handle.attributes.new("mine", "INT", "POINT").data.foreach_set("value", np.arange(count, dtype=np.int32))
    handle.attributes.new("heat", "FLOAT", "POINT").data.foreach_set("value", ramp * 100)
    handle.attributes.new("tag", "INT", "CURVE").data.foreach_set("value", np.array([42], np.int32))
    bpy.ops.rototoon.fit_strokes(tolerance=0.5)
    found = content(addon, ob, "Lines", 1)
    n = int(found.sizes[0])
    assert n < 30
    assert found.curve["tag"][0] == 42 and found.curve[gp.PART][0] == 7
    share = found.point["mine"] / (count - 1)
    assert share[0] == 0 and share[-1] == 1 and (np.diff(share) > 0).all()
    assert found.point["radius"] == pytest.approx(0.01 + 0.04 * share, abs=0.003)
    assert found.point["heat"] == pytest.approx(100 * found.point["radius"], abs=0.05)
    assert found.point["opacity"] == pytest.approx(1 - 0.8 * share, abs=0.06)
    assert found.point["vertex_color"] == pytest.approx(np.tile([0.2, 0.4, 0.6, 1.0], (n, 1)), abs=1e-4)


def along(corners, closed=False, step=0.01):
    """Points along straight sides, a hundredth of a unit apart."""
    ends = np.vstack([corners, corners[:1]]) if closed else np.asarray(corners, float)
    sides = []
    for a, b in zip(ends[:-1], ends[1:]):
        share = np.arange(0, 1, step / np.hypot(*(b - a)))[:, None]
        sides.append(a + share * (b - a))
    return np.vstack(sides + ([] if closed else [ends[-1:]]))


def test_strokes_with_straight_sides_get_a_point_at_each_corner(addon):
    ob = drawing_object(addon)
    zigzag = np.array([[0, 0], [0.5, 1], [1, 0], [1.5, 1], [2, 0.2]])
    star = np.array([[3.0 + r * np.cos(k * np.pi / 5), r * np.sin(k * np.pi / 5)] for k, r in enumerate([1, 0.5] * 5)])
    add(addon, ob, "Lines", 1, [along(zigzag)])
    add(addon, ob, "Lines", 1, [along(star, closed=True)], cyclic=True)
    assert bpy.ops.rototoon.fit_strokes(tolerance=1.0) == {"FINISHED"}
    found = content(addon, ob, "Lines", 1)
    assert list(found.types) == [1, 1] and list(found.sizes) == [len(zigzag), len(star)]
    assert list(found.curve["cyclic"]) == [False, True]
    assert found.point["radius"] == pytest.approx(0.02) and found.point["opacity"] == pytest.approx(1)
    points = evaluated(ob)
    left = points[:, 0] < 2.1
    for drawn, wanted, closed in ((points[left], along(zigzag), False), (points[~left], along(star, True), True)):
        assert distance(drawn, wanted, closed) < 0.01 and distance(wanted, drawn, closed) < 0.01


def test_what_bends_between_corners_or_changes_its_width_there_is_a_curve(addon):
    ob = drawing_object(addon)
    zigzag = along(np.array([[0, 0], [0.5, 1], [1, 0], [1.5, 1], [2, 0.2]]))
    bulge = 0.01 + 0.04 * np.sin(np.linspace(0, 9, len(zigzag))) ** 2
    add(addon, ob, "Lines", 1, [zigzag], radius=bulge.astype(np.float32))
    turn = np.linspace(0, np.pi, 200)
    cap = np.stack([4 + np.cos(turn), np.sin(turn)], 1)
    add(addon, ob, "Lines", 2, [np.vstack([cap, along(np.array([[3, 0], [3, -1], [5, -1], [5, 0]]))[1:-1]])], cyclic=True)
    assert bpy.ops.rototoon.fit_strokes(tolerance=1.0, frames="ALL") == {"FINISHED"}
    for frame in (1, 2):
        assert list(content(addon, ob, "Lines", frame).types) == [3]


def test_strokes_that_cannot_be_fitted_stay(addon):
    ob = drawing_object(addon)
    shapes = [wave(50)[:1], wave(50)[:2], np.full((20, 2), 0.5), wave(200), wave(200) + 1]
    add(addon, ob, "Lines", 1, shapes)
    handle = drawing(addon, ob, "Lines", 1)
    gp = addon("blender.grease_pencil")
    points = gp.positions(handle, 423)
    points[300] = np.nan
    gp.put(handle, "position", points)
    handle.set_types(type="BEZIER", indices=[3])
    before = content(addon, ob, "Lines", 1)
    assert bpy.ops.rototoon.fit_strokes(tolerance=1.0) == {"FINISHED"}
    found = content(addon, ob, "Lines", 1)
    # Points on one place become one.
    assert list(found.sizes) == [1, 2, 1, 200, 200]
    assert list(found.types) == [1, 1, 1, 2, 1]
    assert np.isnan(found.point["position"]).any()
    assert np.array_equal(found.point["position"][-200:], before.point["position"][-200:], equal_nan=True)
    # A second time nothing is left to do.
    bpy.ops.rototoon.fit_strokes(tolerance=1.0)
    assert content(addon, ob, "Lines", 1).equals(found)


def test_frames_layers_and_locks_are_respected(addon):
    ob = drawing_object(addon, ("Low", "High"))
    gp = addon("blender.grease_pencil")
    for layer in ("Low", "High"):
        for frame in (1, 5, 9):
            add(addon, ob, layer, frame, [wave()])
    gp.set_keyframe_type(ob.data.layers["High"], {5: "BREAKDOWN"})
    light = lambda layer, frame: content(addon, ob, layer, frame).sizes[0] < 100  # noqa: E731
    bpy.context.scene.frame_set(7)
    ob.data.layers["Low"].lock = True
    bpy.ops.rototoon.fit_strokes()
    assert [light("High", f) for f in (1, 5, 9)] == [False, True, False]
    assert not any(light("Low", f) for f in (1, 5, 9))
    assert gp.drawings(ob.data.layers["High"])[5][1] == "BREAKDOWN"
    for frame in ob.data.layers["High"].frames:
        frame.select = frame.frame_number == 9
    bpy.ops.rototoon.fit_strokes(frames="SELECTED")
    assert [light("High", f) for f in (1, 5, 9)] == [False, True, True]
    ob.data.layers["Low"].lock = False
    bpy.ops.rototoon.fit_strokes(frames="ALL")
    assert all(light(layer, f) for layer in ("Low", "High") for f in (1, 5, 9))


def test_the_tolerance_may_be_in_world_units(addon):
    ob = drawing_object(addon)
    ob.scale = (2.0, 2.0, 2.0)
    bpy.context.view_layer.update()
    add(addon, ob, "Lines", 1, [wave()])
    bpy.ops.rototoon.fit_strokes(tolerance=0.02, unit="WORLD")
    ob.scale = (1.0, 1.0, 1.0)
    assert distance(evaluated(ob), wave()) < 0.0112
    with pytest.raises(RuntimeError, match="too small"):
        ob2 = drawing_object(addon)
        add(addon, ob2, "Lines", 1, [wave()])
        bpy.ops.rototoon.fit_strokes(tolerance=1e-6, unit="WORLD")
        ob2.scale = (1e6, 1e6, 1e6)
        bpy.context.view_layer.update()
        bpy.ops.rototoon.fit_strokes(tolerance=1e-6, unit="WORLD")


def test_only_selected_strokes_in_edit_mode(addon):
    ob = drawing_object(addon)
    add(addon, ob, "Lines", 1, [wave(), wave() + [0, 1]])
    bpy.ops.object.mode_set(mode="EDIT")
    try:
        handle = drawing(addon, ob, "Lines", 1)
        attribute = handle.attributes.get(".selection") or handle.attributes.new(".selection", "BOOLEAN", "POINT")
        chosen = np.zeros(len(attribute.data), bool)
        chosen[-1] = True
        attribute.data.foreach_set("value", chosen)
        bpy.ops.rototoon.fit_strokes(selected=True)
    finally:
        bpy.ops.object.mode_set(mode="OBJECT")
    sizes = content(addon, ob, "Lines", 1).sizes
    assert sizes[0] == 400 and sizes[1] < 30


def test_fitting_is_undone_in_one_step(addon):
    ob = drawing_object(addon)
    add(addon, ob, "Lines", 1, [wave()])
    bpy.ops.ed.undo_push(message="drawn")
    name = ob.name
    bpy.ops.rototoon.fit_strokes("EXEC_DEFAULT", True)
    assert content(addon, bpy.data.objects[name], "Lines", 1).sizes[0] < 30
    bpy.ops.ed.undo()
    assert content(addon, bpy.data.objects[name], "Lines", 1).sizes[0] == 400


def test_empty_drawings_and_objects(addon):
    ob = drawing_object(addon)
    for operator in (bpy.ops.rototoon.fit_strokes, bpy.ops.rototoon.hidden_lines):
        with pytest.raises(RuntimeError, match="No drawings"):
            operator()
    ob.data.layers["Lines"].frames.new(1)
    for operator in (bpy.ops.rototoon.fit_strokes, bpy.ops.rototoon.hidden_lines):
        assert operator() == {"FINISHED"}
    assert len(content(addon, ob, "Lines", 1).sizes) == 0


# -- Remove Hidden Lines ----------------------------------------------------------------------------------------------


def fills(addon, ob, layer, frame, values):
    """Marks strokes as filled, as the version of Blender wants it."""
    gp = addon("blender.grease_pencil")
    if gp.FILL_BY_ID:
        gp.put(drawing(addon, ob, layer, frame), "fill_id", np.array(values))
        return
    if len(ob.data.materials) < 2:
        ob.data.materials.append(ob.data.materials[0].copy())
        ob.data.materials[1].grease_pencil.show_fill = True
    gp.put(drawing(addon, ob, layer, frame), "material_index", (np.array(values) != 0).astype(int))


def scene(addon, at=(2.0, 0.0)):
    """A line behind a filled disc on a layer above."""
    ob = drawing_object(addon, ("Back", "Front"))
    x = np.linspace(0, 4, 41)
    add(addon, ob, "Back", 1, [np.stack([x, 0 * x], 1)], radius=0.01 + 0.01 * x)
    add(addon, ob, "Front", 1, [circle(at, 1.0, 400)], cyclic=True)
    fills(addon, ob, "Front", 1, [1])
    return ob


def test_a_covered_line_is_cut_exactly(addon):
    ob = scene(addon)
    gp = addon("blender.grease_pencil")
    gp.put(drawing(addon, ob, "Back", 1), gp.PART, np.array([3]))
    front = content(addon, ob, "Front", 1)
    assert bpy.ops.rototoon.hidden_lines() == {"FINISHED"}
    found = content(addon, ob, "Back", 1)
    x, starts = found.point["position"][:, 0], found.starts
    assert list(found.sizes) == [11, 11]
    ends = [x[starts[0]], x[starts[1] - 1], x[starts[1]], x[-1]]
    assert ends == pytest.approx([0.0, 1.0, 3.0, 4.0], abs=1e-5)
    assert found.point["radius"] == pytest.approx(0.01 + 0.01 * x, abs=1e-6)
    assert list(found.curve[gp.STROKE]) == [1, 1] and list(found.curve[gp.PART]) == [3, 3]
    assert found.curve[gp.INTERVAL] == pytest.approx(np.array([[0, 10], [30, 40]]), abs=1e-3)
    assert content(addon, ob, "Front", 1).equals(front)
    # What is done stays as it is.
    bpy.ops.rototoon.hidden_lines()
    assert content(addon, ob, "Back", 1).equals(found)


def test_hidden_parts_move_to_a_layer(addon):
    ob = scene(addon)
    bpy.ops.rototoon.hidden_lines(action="MOVE")
    assert [layer.name for layer in ob.data.layers] == ["Back", "Front", "Back Hidden"]
    found = content(addon, ob, "Back Hidden", 1)
    x = found.point["position"][:, 0]
    assert len(found.sizes) == 1 and (x[0], x[-1]) == pytest.approx((1.0, 3.0), abs=1e-5)
    assert found.point["opacity"] == pytest.approx(np.ones(len(x)))
    bpy.ops.rototoon.hidden_lines(action="MOVE")
    assert content(addon, ob, "Back Hidden", 1).equals(found)


def test_order_of_strokes_and_which_of_them_cover(addon):
    def build():
        ob = drawing_object(addon)
        add(addon, ob, "Lines", 1, [[(0, 0), (4, 0)]])
        add(addon, ob, "Lines", 1, [circle((2, 0), 1)], cyclic=True)
        add(addon, ob, "Lines", 1, [[(0, 0.5), (4, 0.5)]])
        return ob

    ob = build()
    bpy.ops.rototoon.hidden_lines()
    assert len(content(addon, ob, "Lines", 1).sizes) == 3
    bpy.ops.rototoon.hidden_lines(covers="CLOSED", order="LAYERS")
    assert len(content(addon, ob, "Lines", 1).sizes) == 3
    bpy.ops.rototoon.hidden_lines(covers="CLOSED")
    found = content(addon, ob, "Lines", 1)
    # The two parts of the first line take its place, below the circle.
    assert list(found.sizes) == [2, 2, 64, 2]
    ob = build()
    fills(addon, ob, "Lines", 1, [0, 5, 0])
    bpy.ops.rototoon.hidden_lines()
    assert list(content(addon, ob, "Lines", 1).sizes) == [2, 2, 64, 2]


def test_a_cut_stroke_keeps_its_fill(addon):
    ob = drawing_object(addon)
    add(addon, ob, "Lines", 1, [circle((0, 0), 1), circle((1.2, 0), 1)], cyclic=True)
    fills(addon, ob, "Lines", 1, [1, 2])
    bpy.ops.rototoon.hidden_lines()
    found = content(addon, ob, "Lines", 1)
    carrier, line, front = range(3)
    assert len(found.sizes) == 3
    assert list(found.curve["cyclic"]) == [True, False, True]
    assert list(addon("blender.strokes").filled(ob, found) != 0) == [True, False, True]
    starts = found.starts
    opacity = found.point["opacity"]
    assert (opacity[: starts[1]] == 0).all() and (opacity[starts[1] :] == 1).all()
    seen = found.point["position"][starts[line] : starts[front]][:, [0, 2]]
    assert (np.linalg.norm(seen - [1.2, 0], axis=1) > 0.998).all()
    bpy.ops.rototoon.hidden_lines()
    assert content(addon, ob, "Lines", 1).equals(found)


def test_fitted_curves_are_cut_as_curves(addon):
    ob = scene(addon)
    add(addon, ob, "Back", 1, [wave() + [0, 0.1]])
    bpy.ops.rototoon.fit_strokes(tolerance=0.2, layers="ALL")
    before = content(addon, ob, "Back", 1)
    assert before.types[1] == 3
    bpy.ops.rototoon.hidden_lines()
    found = content(addon, ob, "Back", 1)
    curves = found.types == 3
    assert curves.sum() == 2 and (found.curve["nurbs_order"][curves] == 3).all()
    assert found.sizes[curves].sum() < 60
    ob.data.layers["Front"].hide = True
    points = evaluated(ob)
    of_wave = points[np.abs(points[:, 1]) > 1e-4]
    assert distance(of_wave, wave() + [0, 0.1]) < 0.004
    assert (np.linalg.norm(of_wave - [2, 0], axis=1) > 0.99).all()


def test_held_drawings_get_new_frames_where_they_look_another_way(addon):
    ob = scene(addon)
    scene_ = bpy.context.scene
    scene_.frame_start, scene_.frame_end = 1, 12
    for frame, at in ((5, (10.0, 0.0)), (9, (3.0, 0.0))):
        add(addon, ob, "Front", frame, [circle(at, 1.0, 400)], cyclic=True)
        fills(addon, ob, "Front", frame, [1])
    gp = addon("blender.grease_pencil")
    gp.set_keyframe_type(ob.data.layers["Back"], {1: "BREAKDOWN"})
    bpy.ops.rototoon.hidden_lines(frames="RANGE")
    kinds = {f: kind for f, (_, kind) in gp.drawings(ob.data.layers["Back"]).items()}
    assert kinds == {1: "BREAKDOWN", 5: "GENERATED", 9: "GENERATED"}
    assert [len(content(addon, ob, "Back", f).sizes) for f in (1, 5, 9)] == [2, 1, 1]
    x = content(addon, ob, "Back", 9).point["position"][:, 0]
    assert (x[0], x[-1]) == pytest.approx((0.0, 2.0), abs=1e-4)
    assert content(addon, ob, "Back", 5).point["position"][:, 0] == pytest.approx(np.linspace(0, 4, 41), abs=1e-6)
    assert scene_.frame_current == 1


def test_strokes_that_are_no_places_neither_cover_nor_go(addon):
    ob = scene(addon)
    gp = addon("blender.grease_pencil")
    handle = add(addon, ob, "Back", 1, [[(2, 0.2)], [(1.8, 0.3), (2.2, 0.3)], [(1.9, 0.1), (2.1, 0.1), (2.0, 0.2)]])
    points = gp.positions(handle, 47)
    points[-1] = np.nan
    gp.put(handle, "position", points)
    front = drawing(addon, ob, "Front", 1)
    bpy.ops.rototoon.hidden_lines()
    found = content(addon, ob, "Back", 1)
    # The point and the short line are hidden; the stroke with a point that is no place stays.
    assert list(found.sizes) == [11, 11, 3]
    every = gp.positions(front, 400)
    every[7] = np.nan
    gp.put(front, "position", every)
    before = content(addon, ob, "Back", 1)
    bpy.ops.rototoon.hidden_lines()
    after = content(addon, ob, "Back", 1)
    assert list(after.sizes) == list(before.sizes)


def test_hidden_lines_through_a_camera(addon):
    ob = scene(addon)
    data = bpy.data.cameras.new("Camera")
    data.type, data.ortho_scale = "ORTHO", 10.0
    camera = bpy.data.objects.new("Camera", data)
    bpy.context.collection.objects.link(camera)
    bpy.context.scene.camera = camera
    # From the front, but shifted in depth: the disc's layer lies nearer to a perspective camera.
    camera.location, camera.rotation_euler = (2.0, -10.0, 0.0), (np.pi / 2, 0, 0)
    data.type, data.lens, data.sensor_width = "PERSP", 50.0, 36.0
    ob.data.layers["Front"].translation = (0.0, -5.0, 0.0)
    bpy.context.view_layer.update()
    bpy.ops.rototoon.hidden_lines()
    found = content(addon, ob, "Back", 1)
    # At half the distance the disc covers twice as much: the whole line.
    assert len(found.sizes) == 0


def test_contours_cover_and_are_not_cut(addon):
    ob = scene(addon)
    ob.rototoon.contours_layer = "Front"
    bpy.ops.rototoon.hidden_lines()
    assert len(content(addon, ob, "Back", 1).sizes) == 2
    ob = scene(addon)
    ob.rototoon.contours_layer = "Back"
    assert bpy.ops.rototoon.hidden_lines() == {"FINISHED"}
    assert len(content(addon, ob, "Back", 1).sizes) == 1
    bpy.ops.rototoon.fit_strokes()
    assert content(addon, ob, "Back", 1).sizes[0] == 41


def test_hidden_lines_of_one_drawing_do_not_show_on_the_next(addon):
    ob = scene(addon)
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 1, 12
    add(addon, ob, "Back", 6, [[(0, 3), (4, 3)]])
    bpy.ops.rototoon.hidden_lines(frames="RANGE", action="MOVE")
    assert [len(content(addon, ob, "Back Hidden", f).sizes) for f in (1, 6)] == [1, 0]
    # More is hidden later: it joins what is there.
    add(addon, ob, "Back", 1, [[(0, 0.5), (4, 0.5)]])
    bpy.ops.rototoon.hidden_lines(frames="RANGE", action="MOVE")
    assert [len(content(addon, ob, "Back Hidden", f).sizes) for f in (1, 6)] == [2, 0]
    assert len(content(addon, ob, "Back", 1).sizes) == 4


def test_a_layer_under_a_parent_keeps_its_place(addon):
    ob = scene(addon)
    empty = bpy.data.objects.new("Empty", None)
    bpy.context.collection.objects.link(empty)
    empty.location, empty.scale = (0.5, 0.0, 0.25), (2.0, 2.0, 2.0)
    back = ob.data.layers["Back"]
    back.parent = empty
    back.translation = (-0.1, 0.0, 0.0)
    bpy.context.view_layer.update()
    bpy.ops.rototoon.hidden_lines(action="MOVE")
    bpy.context.view_layer.update()
    place = addon("blender.camera").layer_to_world
    assert place(ob, ob.data.layers["Back Hidden"]) == pytest.approx(place(ob, back), abs=1e-5)

"""Traced lines corrected: wrong identities, parts from strokes, and edits that go to all frames. With the real library."""

import bpy
import line_shots as ls
import numpy as np
import pytest
import shots
from line_stage import film, pictures, traced  # noqa: F401 - fixtures
from line_stage import attribute, away, handle_of, kinds, number_of, said


def test_a_wrong_identity_is_mended_from_a_frame_on(addon, traced):
    eyes = [number_of(addon, traced, 1), number_of(addon, traced, 2)]
    before = {frame: ls.strokes(addon, traced, "Lines", frame) for frame in range(1, 7)}
    bpy.context.scene.frame_set(3)
    assert bpy.ops.rototoon.match_lines(earlier=eyes[0], later=eyes[1]) == {"FINISHED"}
    assert said(addon).text == "6 strokes are the same"
    for frame in range(1, 7):
        now = ls.strokes(addon, traced, "Lines", frame)
        other = eyes if frame < 4 else eyes[::-1]
        assert np.array_equal(now[eyes[0]], before[frame][other[0]]) and np.array_equal(now[eyes[1]], before[frame][other[1]])
    bpy.ops.rototoon.carry_strokes()
    assert kinds(addon, traced, "Lines")[4] == "KEYFRAME" and kinds(addon, traced, "Lines")[5] == "GENERATED"
    now = ls.strokes(addon, traced, "Lines", 6)
    assert away(now[eyes[0]], ls.lines(5)[2][0]) < 1.5 and away(now[eyes[1]], ls.lines(5)[1][0]) < 1.5


@pytest.mark.parametrize("shared", [(5, 6), (3, 4), (3, 6)])
def test_an_identity_on_frames_that_share_a_drawing_is_mended_once(addon, traced, shared):
    gp, layer = addon("blender.grease_pencil"), traced.data.layers["Lines"]
    gp.remove_frames(layer, [shared[1]])
    layer.frames.copy(*shared, instance_drawing=True)
    eyes = [number_of(addon, traced, 1), number_of(addon, traced, 2)]
    before = {frame: ls.strokes(addon, traced, "Lines", frame) for frame in range(1, 7)}
    bpy.context.scene.frame_set(3)
    assert bpy.ops.rototoon.match_lines(earlier=eyes[0], later=eyes[1]) == {"FINISHED"}
    for frame in range(1, 7):
        now = ls.strokes(addon, traced, "Lines", frame)
        other = eyes if frame < 4 else eyes[::-1]
        assert np.array_equal(now[eyes[0]], before[frame][other[0]]) and np.array_equal(now[eyes[1]], before[frame][other[1]]), frame


def test_clicks_swap_free_and_undo(addon, traced):
    pairing = addon("lines.pairing")
    gp = addon("blender.grease_pencil")
    found = pairing.LinePairing(traced, [gp.find_layer(traced, "Lines")], 2)
    found.take()
    item = addon("tween.pairing").Item
    assert not found.click(item(0, 0, 1)) and found.click(item(0, 1, 2))
    found.take()
    assert [row.later for row in found.pairs][:3] == [0, 2, 1] and found.pairs[1].by_hand
    assert found.free(item(0, 1, 0))
    found.take()
    assert found.summary() == "5 strokes are the same, 1 end, 1 begin"
    assert found.undo() and found.undo() and not found.undo()
    found.take()
    assert found.summary() == "6 strokes are the same" and len(found.marks()) == 12


def test_strokes_around_a_part_become_its_contour(addon, traced):
    body = number_of(addon, traced, 0)
    assert bpy.ops.rototoon.make_part(numbers=str(body), name="body") == {"FINISHED"}
    (part,) = traced.rototoon.parts
    assert part.name == "body" and part.closed and 8 <= part.count <= 60
    contour = ls.strokes(addon, traced, "Contours", 1)
    assert away(next(iter(contour.values())), ls.lines(0)[0][0]) < 2
    with pytest.raises(RuntimeError, match="numbers: found '99', expected numbers of strokes on frame 1"):
        bpy.ops.rototoon.make_part(numbers="99")
    with pytest.raises(RuntimeError, match="No strokes are selected"):
        bpy.ops.rototoon.make_part()
    with pytest.raises(RuntimeError, match='There is a part "body" already'):
        bpy.ops.rototoon.make_part(numbers=str(body), name="body")
    # On the next frame the artist selects the stroke. It is the same part.
    bpy.context.scene.frame_set(2)
    gp, handle = addon("blender.grease_pencil"), handle_of(addon, traced, "Lines", 2)
    numbers = gp.value(handle, gp.TRACK, len(gp.offsets(handle)) - 1)
    handle.attributes.new(".selection", "BOOLEAN", "CURVE").data.foreach_set("value", numbers == body)
    bpy.ops.rototoon.make_part()
    assert said(addon).text == 'The strokes fit "body", which has a contour already: this is its key on frame 2'
    assert len(traced.rototoon.parts) == 1 and list(kinds(addon, traced, "Contours")) == [1, 2]


def test_a_contour_that_waits_does_not_get_the_name_of_the_new_part(addon, traced):
    body, contour = number_of(addon, traced, 0), np.array([[10.0, 5], [30, 5], [30, 10], [10, 12]])
    shots.draw(addon, traced, 1, [contour])
    bpy.ops.rototoon.make_part(numbers=str(body), name=" arm ")
    assert said(addon).text.startswith('"arm" is a new part')
    assert [part.name for part in traced.rototoon.parts] == ["Part 1", "arm"]
    waited, made = (part.keys[1] for part in addon("capture.contours").read(traced).parts)
    assert len(waited.points) == 4 and len(made.points) > 4


def test_strokes_in_any_order_that_cross_are_cut_and_joined(addon):
    outline = addon("lines.outline")
    corners = np.array([(0, 0), (100, 0), (100, 60), (0, 60)], float)
    sides = []
    for k, (a, b) in enumerate(zip(corners, np.roll(corners, -1, 0))):
        way = (b - a) / np.linalg.norm(b - a)
        # The lines run 4 px beyond the corners.
        line = a - 4 * way + np.linspace(0, 1, 30)[:, None] * (b - a + 8 * way)
        sides.append((line[::-1] if k % 2 else line, False))
    contour, gap = outline.joined([sides[k] for k in (2, 0, 3, 1)])
    assert gap == 0 and contour.min() > -1e-6 and contour[:, 0].max() < 100 + 1e-6 and contour[:, 1].max() < 60 + 1e-6
    thin = outline.thinned(contour, 0.5, 1000)
    assert len(thin) == 4 and sorted(map(tuple, thin.round().tolist())) == sorted(map(tuple, corners.tolist()))
    assert outline.joined([(corners[:2], False), (corners[2:], False)])[1] == pytest.approx(60)


def edit(addon, ob, frame, number, change):
    """Changes the points of a stroke as the artist does: `change(points)` gets layer points."""
    gp = addon("blender.grease_pencil")
    handle = handle_of(addon, ob, "Lines", frame)
    starts = gp.offsets(handle)
    i = gp.value(handle, gp.TRACK, len(starts) - 1).tolist().index(number)
    points = gp.positions(handle, int(starts[-1]))
    points[starts[i] : starts[i + 1]] = change(points[starts[i] : starts[i + 1]])
    gp.put(handle, "position", points)
    return i, slice(starts[i], starts[i + 1])


def test_a_reshaped_stroke_is_reshaped_on_all_frames_in_its_own_frame(addon, traced):
    arm = number_of(addon, traced, 4)
    before = {frame: ls.strokes(addon, traced, "Lines", frame) for frame in range(1, 7)}
    mapping = addon("blender.placement").Mapper(traced, [1], {}, ["Lines"]).at(0, 1)

    def bulge(points):
        pixels = mapping.to_pixels(points)
        way = pixels[-1] - pixels[0]
        side = np.array([-way[1], way[0]]) / np.linalg.norm(way)
        return mapping.to_layer(pixels + np.sin(np.linspace(0, np.pi, len(pixels)))[:, None] * 8 * side)

    edit(addon, traced, 1, arm, bulge)
    assert bpy.ops.rototoon.spread_edits() == {"FINISHED"}
    assert said(addon).text == "1 edited stroke, on 5 other frames"
    for frame in range(1, 7):
        now = ls.strokes(addon, traced, "Lines", frame)
        assert list(now) == list(before[frame])
        assert all(np.array_equal(now[number], before[frame][number]) for number in now if number != arm)
        a, b = before[frame][arm][0], before[frame][arm][-1]
        side = np.array([a[1] - b[1], b[0] - a[0]]) / np.linalg.norm(b - a)
        height = (now[arm] - a) @ side
        assert height.max() == pytest.approx(8, abs=1.0) and abs(height[0]) < 1.0
    with pytest.raises(RuntimeError, match="No stroke on this frame differs"):
        bpy.ops.rototoon.spread_edits()


def test_looks_and_deletions_go_to_all_frames(addon, traced):
    gp = addon("blender.grease_pencil")
    mouth, eye = number_of(addon, traced, 3), number_of(addon, traced, 1)
    bpy.context.scene.frame_set(3)
    handle = handle_of(addon, traced, "Lines", 3)
    starts = gp.offsets(handle)
    numbers = gp.value(handle, gp.TRACK, len(starts) - 1).tolist()
    i = numbers.index(mouth)
    radii, used = gp.value(handle, "radius", int(starts[-1])), gp.value(handle, "material_index", len(numbers))
    radii[starts[i] : starts[i + 1]] = 0.2
    used[i] = 0
    gp.put(handle, "radius", radii)
    gp.put(handle, "material_index", used)
    gp.remove_strokes(handle, [numbers.index(eye)])
    before = ls.strokes(addon, traced, "Lines", 5)
    bpy.ops.rototoon.spread_edits()
    assert said(addon).text == "1 edited and 1 deleted strokes, on 5 other frames"
    for frame in range(1, 7):
        now = ls.strokes(addon, traced, "Lines", frame)
        assert eye not in now and len(now) == 5
        j, at = list(now).index(mouth), np.cumsum([0] + [len(points) for points in now.values()])
        assert np.allclose(attribute(addon, traced, "Lines", frame, "radius")[at[j] : at[j + 1]], 0.2)
        assert attribute(addon, traced, "Lines", frame, "material_index")[j] == 0
    assert np.allclose(ls.strokes(addon, traced, "Lines", 5)[mouth], before[mouth], atol=1e-3)


def test_a_cut_stroke_is_cut_on_all_frames(addon, traced):
    gp, strokes = addon("blender.grease_pencil"), addon("blender.strokes")
    arm = number_of(addon, traced, 4)
    handle = handle_of(addon, traced, "Lines", 1)
    content = strokes.read(handle)
    i = content.strokes(gp.TRACK).tolist().index(arm)
    half = content.sizes[i] // 2
    whole = np.ones(len(content.sizes), bool)
    whole[i] = False
    one = strokes.chosen(content, np.flatnonzero(~whole))
    pieces = [strokes.Content(np.array([n]), one.types, {k: v[s] for k, v in one.point.items()}, one.curve, one.kinds)
              for n, s in ((half, slice(0, half)), (content.sizes[i] - half, slice(half, None)))]
    strokes.write(handle, strokes.joined(strokes.joined(strokes.chosen(content, np.flatnonzero(whole)), pieces[0]), pieces[1]))
    before = {frame: ls.strokes(addon, traced, "Lines", frame)[arm] for frame in range(2, 7)}
    assert bpy.ops.rototoon.spread_edits() == {"FINISHED"}
    for frame in range(2, 7):
        now = ls.strokes(addon, traced, "Lines", frame)
        assert len(now) == 7 and 7 in now
        length = np.linalg.norm(np.diff(before[frame], axis=0), axis=1).sum()
        found = [np.linalg.norm(np.diff(now[n], axis=0), axis=1).sum() for n in (arm, 7)]
        assert found[0] == pytest.approx(length / 2, rel=0.1) and found[1] == pytest.approx(length / 2, rel=0.1)
        assert away(np.vstack([now[arm], now[7]]), before[frame]) < 1.5


def radii_of(addon, ob, frame):
    """The radii of the points by stroke number."""
    handle = handle_of(addon, ob, "Lines", frame)
    gp = addon("blender.grease_pencil")
    starts = gp.offsets(handle)
    numbers, radii = gp.value(handle, gp.TRACK, len(starts) - 1).tolist(), gp.value(handle, "radius", int(starts[-1]))
    return {number: radii[a:b] for number, a, b in zip(numbers, starts, starts[1:])}


def test_fitted_strokes_give_their_look_and_no_shape(addon, traced):
    gp = addon("blender.grease_pencil")
    bpy.ops.rototoon.fit_strokes()
    addon("common.reports").take()
    with pytest.raises(RuntimeError, match="No stroke on this frame differs"):
        bpy.ops.rototoon.spread_edits()
    handle = handle_of(addon, traced, "Lines", 1)
    total = int(gp.offsets(handle)[-1])
    gp.put(handle, "radius", np.full(total, 0.3))
    before = {frame: ls.strokes(addon, traced, "Lines", frame) for frame in range(1, 7)}
    bpy.ops.rototoon.spread_edits()
    assert said(addon).text == "6 edited strokes, on 5 other frames"
    for frame in range(2, 7):
        now, radii = ls.strokes(addon, traced, "Lines", frame), radii_of(addon, traced, frame)
        assert list(now) == list(before[frame])
        for number, points in now.items():
            # A stroke that became a polyline of its corners is reshaped as others: by nothing.
            assert np.allclose(points, before[frame][number], atol=1e-2) and np.allclose(radii[number], 0.3)


def test_moved_points_of_a_fitted_stroke_are_named(addon, traced):
    gp, strokes = addon("blender.grease_pencil"), addon("blender.strokes")
    bpy.ops.rototoon.fit_strokes()
    content = strokes.read(handle_of(addon, traced, "Lines", 1))
    curve = int(content.strokes(gp.TRACK)[np.flatnonzero(content.types == strokes.NURBS)[0]])
    edit(addon, traced, 1, curve, lambda points: points + np.float32(0.2))
    before = {frame: ls.strokes(addon, traced, "Lines", frame)[curve] for frame in range(2, 7)}
    addon("common.reports").take()
    bpy.ops.rototoon.spread_edits()
    assert any("not reshaped: 1 stroke is a curve" in each.text for each in addon("common.reports").take())
    assert all(np.array_equal(ls.strokes(addon, traced, "Lines", frame)[curve], before[frame]) for frame in before)


def cover(addon, ob, frame):
    """Something filled that passes in front of both eyes and of a bit of two other lines, on this frame only."""
    gp, strokes = addon("blender.grease_pencil"), addon("blender.strokes")
    turn = np.linspace(0, 2 * np.pi, 80, endpoint=False)
    shape = np.stack([114.8 + 45 * np.cos(turn), 73.5 + 18 * np.sin(turn)], 1)
    ls.put(addon, ob, "Passing", frame, [(shape, True)])
    handle = handle_of(addon, ob, "Passing", frame)
    content = strokes.read(handle)
    if gp.FILL_BY_ID:
        content.set_strokes("fill_id", np.array([1], np.int32))
    else:
        material = ob.data.materials[0].copy()
        material.grease_pencil.show_fill = True
        ob.data.materials.append(material)
        content.set_strokes("material_index", np.array([len(ob.data.materials) - 1], np.int32))
    strokes.write(handle, content)
    gp.layer(ob, "Passing").frames.new(frame + 1)
    ob.data.layers.active = ob.data.layers["Lines"]


@pytest.mark.every_version
@pytest.mark.parametrize("frames", ["CURRENT", "RANGE"])
def test_hidden_lines_are_no_edit(addon, traced, frames):
    gp = addon("blender.grease_pencil")
    cover(addon, traced, 2)
    before = {frame: ls.strokes(addon, traced, "Lines", frame) for frame in range(1, 7)}
    bpy.context.scene.frame_set(2)
    bpy.ops.rototoon.hidden_lines(frames=frames)
    assert said(addon).text.startswith("4 hidden lines on 1 drawing")
    assert len(set(before[2]) - set(ls.strokes(addon, traced, "Lines", 2))) == 2
    with pytest.raises(RuntimeError, match="No stroke on this frame differs"):
        bpy.ops.rototoon.spread_edits()
    # All that is left gets thicker, and one line is deleted.
    handle = handle_of(addon, traced, "Lines", 2)
    gp.put(handle, "radius", np.full(int(gp.offsets(handle)[-1]), 0.3))
    deleted = number_of(addon, traced, 3)
    numbers = gp.value(handle, gp.TRACK, len(gp.offsets(handle)) - 1).tolist()
    left = len(set(numbers) - {deleted})
    gp.remove_strokes(handle, [i for i, number in enumerate(numbers) if number == deleted])
    bpy.ops.rototoon.spread_edits()
    assert said(addon).text.endswith("and 1 deleted strokes, on 5 other frames")
    for frame in (1, 3, 4, 5, 6):
        now, radii = ls.strokes(addon, traced, "Lines", frame), radii_of(addon, traced, frame)
        assert list(now) == [number for number in before[frame] if number != deleted]
        assert all(np.allclose(now[number], before[frame][number], atol=1e-2) for number in now)
        assert sum(np.allclose(each, 0.3) for each in radii.values()) == left


def test_moved_points_of_what_is_left_of_a_stroke_are_named(addon, traced):
    gp = addon("blender.grease_pencil")
    cover(addon, traced, 2)
    bpy.context.scene.frame_set(2)
    bpy.ops.rototoon.hidden_lines()
    handle = handle_of(addon, traced, "Lines", 2)
    starts = gp.offsets(handle)
    piece = int(np.flatnonzero(gp.value(handle, gp.INTERVAL, len(starts) - 1).any(1))[0])
    points = gp.positions(handle, int(starts[-1]))
    points[starts[piece] : starts[piece + 1]] += 0.2
    gp.put(handle, "position", points)
    before = ls.strokes(addon, traced, "Lines", 4)
    addon("common.reports").take()
    bpy.ops.rototoon.spread_edits()
    assert any("1 stroke is what Remove Hidden Lines left" in each.text for each in addon("common.reports").take())
    now = ls.strokes(addon, traced, "Lines", 4)
    assert list(now) == list(before) and all(np.array_equal(now[number], before[number]) for number in now)


def test_a_cut_fill_gives_its_width_and_stays_filled(addon, traced):
    gp, strokes = addon("blender.grease_pencil"), addon("blender.strokes")
    body = number_of(addon, traced, 0)
    if not gp.FILL_BY_ID:
        pytest.skip("fills are in materials")
    for frame in range(1, 7):
        handle = handle_of(addon, traced, "Lines", frame)
        content = strokes.read(handle)
        tracks = content.strokes(gp.TRACK)
        content.set_strokes("fill_id", np.where(tracks == body, 1, 0).astype(np.int32))
        strokes.write(handle, content)
    cover(addon, traced, 2)
    bpy.context.scene.frame_set(2)
    bpy.ops.rototoon.hidden_lines()
    handle = handle_of(addon, traced, "Lines", 2)
    gp.put(handle, "radius", np.full(int(gp.offsets(handle)[-1]), 0.3))
    bpy.ops.rototoon.spread_edits()
    content = strokes.read(handle_of(addon, traced, "Lines", 4))
    i = content.strokes(gp.TRACK).tolist().index(body)
    span = slice(content.starts[i], content.starts[i + 1])
    assert content.strokes("fill_id")[i] == 1 and (content.point["opacity"][span] == 1).all() and np.allclose(content.point["radius"][span], 0.3)


def cut_elsewhere(addon, ob, frame, number, spans):
    """Leaves spans of a stroke, by shares of its points, as the artist's cutter does: each a stroke with the same number."""
    gp, strokes = addon("blender.grease_pencil"), addon("blender.strokes")
    handle = handle_of(addon, ob, "Lines", frame)
    content = strokes.read(handle)
    i = content.strokes(gp.TRACK).tolist().index(number)
    one, found = strokes.chosen(content, [i]), strokes.chosen(content, [k for k in range(len(content.sizes)) if k != i])
    count = int(content.sizes[i])
    for first, last in spans:
        rows = np.arange(round(first * count), round(last * count)) % count
        piece = strokes.Content(np.array([len(rows)], np.int32), one.types, {k: v[rows] for k, v in one.point.items()}, dict(one.curve), one.kinds)
        piece.set_strokes("cyclic", np.array([False]))
        found = strokes.joined(found, piece)
    strokes.write(handle, found)
    return found


@pytest.mark.parametrize("spans", [[(0, 0.45), (0.55, 1)], [(0.1, 0.4), (0.6, 1.05)], [(0.3, 0.9)]])
def test_pieces_of_another_frame_are_all_reshaped_and_stay_pieces(addon, traced, spans):
    gp, strokes = addon("blender.grease_pencil"), addon("blender.strokes")
    body = number_of(addon, traced, 0)

    def raised(ob):
        edit(addon, ob, 1, body, lambda points: points + np.float32([0, 0, 0.2]))
        bpy.ops.rototoon.spread_edits()
        assert said(addon).text == "1 edited stroke, on 5 other frames"
        return strokes.read(handle_of(addon, ob, "Lines", 4))

    def pieces(content):
        return [content.point["position"][a:b] for a, b, number in zip(content.starts, content.starts[1:], content.strokes(gp.TRACK)) if number == body]

    (whole,) = pieces(raised(traced))
    bpy.ops.wm.open_mainfile(filepath=bpy.data.filepath)
    ob = bpy.context.object
    before = pieces(cut_elsewhere(addon, ob, 4, body, spans))
    content = raised(ob)
    now = pieces(content)
    assert len(now) == len(before) == len(spans) and not content.strokes("cyclic")[content.strokes(gp.TRACK) == body].any()
    for was, here in zip(before, now):
        assert len(here) == pytest.approx(len(was), abs=2) and away(here, whole) < 0.05
        moved = [np.linalg.norm(here[end] - was[end]) for end in (0, -1)]
        assert moved == pytest.approx([0.2, 0.2], abs=0.04)
    closed = strokes.read(handle_of(addon, ob, "Lines", 5))
    assert closed.strokes("cyclic")[closed.strokes(gp.TRACK) == body].tolist() == [True]


def test_a_single_point_of_another_frame_stays(addon, traced):
    gp, strokes = addon("blender.grease_pencil"), addon("blender.strokes")
    arm = number_of(addon, traced, 4)
    count = len(ls.strokes(addon, traced, "Lines", 4)[arm])
    cut_elsewhere(addon, traced, 4, arm, [(0, 0.8), (0.9, 0.9 + 1.01 / count)])
    edit(addon, traced, 1, arm, lambda points: points + np.float32([0, 0, 0.1]))
    bpy.ops.rototoon.spread_edits()
    now = strokes.read(handle_of(addon, traced, "Lines", 4))
    assert sorted(now.sizes[now.strokes(gp.TRACK) == arm] > 1) == [False, True]


def select(addon, ob, layer, which):
    handle = handle_of(addon, ob, layer, 1)
    handle.attributes.new(".selection", "BOOLEAN", "CURVE").data.foreach_set("value", which)


@pytest.mark.parametrize("close", ["hide", "lock"])
def test_a_selection_on_a_layer_that_edit_mode_does_not_reach_is_no_part(addon, film, close):
    body, eye = ls.lines(0)[0][0], ls.lines(0)[1][0]
    for name, line in (("A", eye), ("Off", body)):
        ls.put(addon, film, name, 1, [(line, True)])
        select(addon, film, name, [True])
    setattr(film.data.layers["Off"], close, True)
    bpy.ops.rototoon.make_part(name="eye")
    (contour,) = ls.strokes(addon, film, "Contours", 1).values()
    assert np.ptp(contour, axis=0) == pytest.approx(np.ptp(eye, axis=0), abs=1.0)
    assert said(addon).text.startswith('"eye" is a new part')
    setattr(film.data.layers["A"], close, True)
    with pytest.raises(RuntimeError, match="No strokes are selected on layers that are neither hidden nor locked"):
        bpy.ops.rototoon.make_part()


def test_strokes_beside_a_closed_one_are_said_not_to_be_used(addon, film):
    ls.put(addon, film, "A", 1, [(ls.lines(0)[1][0], True), (ls.lines(0)[4][0], False)])
    select(addon, film, "A", [True, True])
    bpy.ops.rototoon.make_part()
    assert "1 stroke is not used: a closed stroke is a contour by itself" in said(addon).text


def test_curves_on_another_frame_get_the_look(addon, traced):
    gp = addon("blender.grease_pencil")
    bpy.context.scene.frame_set(4)
    bpy.ops.rototoon.fit_strokes()
    before = ls.strokes(addon, traced, "Lines", 4)
    bpy.context.scene.frame_set(1)
    handle = handle_of(addon, traced, "Lines", 1)
    gp.put(handle, "radius", np.full(int(gp.offsets(handle)[-1]), 0.3))
    addon("common.reports").take()
    bpy.ops.rototoon.spread_edits()
    assert [each.text for each in addon("common.reports").take()] == ["6 edited strokes, on 5 other frames"]
    now = ls.strokes(addon, traced, "Lines", 4)
    assert list(now) == list(before) and all(np.allclose(now[number], before[number], atol=1e-2) for number in now)
    assert all(np.allclose(radii, 0.3) for radii in radii_of(addon, traced, 4).values())

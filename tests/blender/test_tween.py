"""Match Strokes and In-between, in background, with the real library."""

import json

import bpy
import numpy as np
import pytest
from test_strokes import add, circle, content, drawing, drawing_object

pytestmark = pytest.mark.usefixtures("library")


def limb(x, z, angle, count=24, length=2.0):
    """A bent line from (x, z) on."""
    share = np.linspace(0, 1, count)
    turn = angle + 0.8 * share
    steps = length / count * np.stack([np.cos(turn), np.sin(turn)], 1)
    return np.array([x, z]) + np.cumsum(steps, 0)


def figure(shift=0.0, lift=0.0):
    """Three strokes that look different."""
    return [limb(shift, 0, 0.2 + lift), limb(3 + shift, 0, 1.4 + lift, 30, 3.0), limb(shift, 3, -0.5 + lift, 18, 1.2)]


def keyed(addon, frames=(1, 9), layers=("Lines",), **more):
    """An object with the figure on some keys, farther on each."""
    ob = drawing_object(addon, layers)
    for layer in layers:
        for k, frame in enumerate(frames):
            add(addon, ob, layer, frame, figure(1.5 * k, 0.3 * k), **more)
    bpy.context.scene.frame_set(frames[0])
    return ob


def frames(addon, ob, layer="Lines"):
    """Keyframe type by frame."""
    return {n: kind for n, (_, kind) in addon("blender.grease_pencil").drawings(ob.data.layers[layer]).items()}


def tracks(addon, ob, frame, layer="Lines"):
    return content(addon, ob, layer, frame).curve["rototoon_track"].tolist()


def looks(addon, ob, frame, layer="Lines"):
    """All that the artist's drawing holds, without our marks."""
    found = content(addon, ob, layer, frame)
    ours = addon("tween.keys").OURS
    found.point = {n: v for n, v in found.point.items() if n not in ours}
    found.curve = {n: v for n, v in found.curve.items() if n not in ours}
    return found


def points(addon, ob, frame, layer="Lines"):
    found = content(addon, ob, layer, frame)
    return np.split(found.point["position"][:, [0, 2]], found.starts[1:-1])


def test_every_frame_gets_a_drawing_of_its_own_type(addon):
    ob = keyed(addon)
    before = [looks(addon, ob, frame) for frame in (1, 9)]
    assert bpy.ops.rototoon.in_between(spacing="LINEAR", arcs=0.0) == {"FINISHED"}
    assert frames(addon, ob) == {1: "KEYFRAME", 9: "KEYFRAME", **dict.fromkeys(range(2, 9), "GENERATED")}
    assert all(looks(addon, ob, frame).equals(kept) for frame, kept in zip((1, 9), before))
    middle = points(addon, ob, 5)
    for stroke, a, b in zip(middle, figure(0, 0), figure(1.5, 0.3)):
        assert len(stroke) == len(a)
        assert stroke.mean(0) == pytest.approx((a.mean(0) + b.mean(0)) / 2, abs=0.08)
        length = lambda p: np.linalg.norm(np.diff(p, axis=0), axis=1).sum()  # noqa: E731
        assert length(stroke) == pytest.approx(length(a), rel=0.02)


def test_order_and_direction_do_not_matter(addon):
    ob = keyed(addon)
    bpy.ops.rototoon.in_between()
    expected = {frame: points(addon, ob, frame) for frame in range(2, 9)}
    other = drawing_object(addon)
    first, second = figure(0, 0), figure(1.5, 0.3)
    add(addon, other, "Lines", 1, first)
    add(addon, other, "Lines", 9, [second[2][::-1], second[0], second[1][::-1]])
    bpy.ops.rototoon.in_between()
    for frame, strokes in expected.items():
        for one, two in zip(points(addon, other, frame), strokes, strict=True):
            assert one == pytest.approx(two, abs=2e-3)
    assert tracks(addon, other, 9) == [tracks(addon, other, 1)[k] for k in (2, 0, 1)]


def test_strokes_keep_their_numbers(addon):
    ob = keyed(addon, (1, 5, 9, 13))
    bpy.ops.rototoon.in_between(frames="ALL")
    numbers = tracks(addon, ob, 1)
    assert sorted(numbers) == [1, 2, 3]
    assert all(tracks(addon, ob, frame) == numbers for frame in range(1, 14))


def test_what_strokes_carry_follows(addon):
    ob = drawing_object(addon)
    gp = addon("blender.grease_pencil")
    shapes, n = figure(), sum(map(len, figure()))
    for frame, size in ((1, 0.02), (11, 0.06)):
        ramp = np.linspace(size, 2 * size, n).astype(np.float32)
        handle = add(addon, ob, "Lines", frame, shapes, radius=ramp, opacity=np.full(n, 1.1 - frame * 0.05))
        gp.put(handle, "vertex_color", np.tile([frame / 11, 0.5, 0, 0.8], (n, 1)))
        gp.put(handle, "material_index", np.array([0, 1, 0]))
        gp.put(handle, "cyclic", np.array([False, True, False]))
        gp.put(handle, "fill_color", np.tile([0, frame / 11, 1, 1], (3, 1)))
        gp.put(handle, "fill_id", np.array([0, frame, 0]))
        handle.attributes.new("mine", "INT", "POINT").data.foreach_set("value", np.arange(n, dtype=np.int32))
        handle.attributes.new("heat", "FLOAT", "POINT").data.foreach_set("value", ramp * 100)
    ob.data.materials.append(bpy.data.materials.new("Second"))
    bpy.ops.rototoon.in_between(spacing="LINEAR")
    found = content(addon, ob, "Lines", 6)
    ramp = np.linspace(0.04, 0.08, n)
    assert found.point["radius"] == pytest.approx(ramp, abs=1e-4)
    assert found.point["heat"] == pytest.approx(100 * ramp, abs=0.01)
    assert found.point["opacity"] == pytest.approx(np.full(n, 0.8), abs=1e-5)
    assert found.point["vertex_color"][0] == pytest.approx([6 / 11, 0.5, 0, 0.8], abs=1e-5)
    assert found.curve["fill_color"][2] == pytest.approx([0, 6 / 11, 1, 1], abs=1e-5)
    assert found.curve["material_index"].tolist() == [0, 1, 0] and found.curve["cyclic"].tolist() == [False, True, False]
    assert found.curve["fill_id"].tolist() == [0, 1, 0] and found.point["mine"].tolist() == list(range(n))


SEEN = "rototoon_seen"
"""An attribute whose name says that it is not the artist's."""


def mark(addon, ob, layer="Lines"):
    """Marks all drawings between keys: what is drawn again loses the mark."""
    for frame, kind in frames(addon, ob, layer).items():
        if kind == "GENERATED":
            handle = drawing(addon, ob, layer, frame)
            count = len(content(addon, ob, layer, frame).sizes)
            handle.attributes.new(SEEN, "INT", "CURVE").data.foreach_set("value", np.ones(count, np.int32))


def drawn_again(addon, ob, layer="Lines"):
    kinds = frames(addon, ob, layer)
    return [n for n in kinds if kinds[n] == "GENERATED" and SEEN not in content(addon, ob, layer, n).curve]


def move(addon, ob, frame, index=3, by=0.05, layer="Lines"):
    gp = addon("blender.grease_pencil")
    handle = drawing(addon, ob, layer, frame)
    moved = gp.positions(handle, int(gp.offsets(handle)[-1]))
    moved[index, 0] += by
    gp.put(handle, "position", moved)
    handle.tag_positions_changed()


KEYS = (1, 9, 17, 25, 33, 41)


@pytest.mark.parametrize(("spacing", "span"), [("EASE_IN_OUT", (9, 25)), ("SMOOTH", (1, 33))])
def test_only_the_touched_spans_are_drawn_again(addon, spacing, span):
    ob = keyed(addon, KEYS)
    bpy.ops.rototoon.in_between(frames="ALL", spacing=spacing)
    mark(addon, ob)
    assert bpy.ops.rototoon.update_in_betweens() == {"FINISHED"}
    assert drawn_again(addon, ob) == []
    move(addon, ob, 17)
    bpy.ops.rototoon.update_in_betweens()
    expected = [frame for frame in range(span[0] + 1, span[1]) if frame not in KEYS]
    assert drawn_again(addon, ob) == expected
    # What is drawn again is what would be drawn afresh.
    found = {frame: content(addon, ob, "Lines", frame).point["position"] for frame in range(1, 42)}
    bpy.ops.rototoon.clear_in_betweens()
    bpy.ops.rototoon.in_between(frames="ALL", spacing=spacing)
    for frame, kept in found.items():
        assert np.array_equal(content(addon, ob, "Lines", frame).point["position"], kept)


def test_other_choices_draw_again_where_they_hold(addon):
    ob = keyed(addon, KEYS)
    bpy.ops.rototoon.in_between(frames="ALL", spacing="LINEAR")
    mark(addon, ob)
    bpy.context.scene.frame_set(20)
    bpy.ops.rototoon.in_between(frames="CURRENT", spacing="CHART", chart="5, 10 20 50 80% 90, 95")
    assert drawn_again(addon, ob) == list(range(18, 25))
    mark(addon, ob)
    bpy.ops.rototoon.in_between(frames="CURRENT", spacing="CHART", chart="5, 10 20 50 80% 90, 95")
    assert drawn_again(addon, ob) == []
    # An update keeps each span's own choices.
    move(addon, ob, 17)
    bpy.ops.rototoon.update_in_betweens()
    assert drawn_again(addon, ob) == [*range(10, 17), *range(18, 25)]
    kept = json.loads(ob.data["rototoon_tween"])["Lines"]["spans"]
    assert kept["17"]["choices"]["spacing"] == "CHART" and kept["9"]["choices"]["spacing"] == "LINEAR"


def test_a_chart_says_how_far_each_drawing_has_come(addon):
    ob = drawing_object(addon)
    for frame, x in ((1, 0.0), (5, 4.0)):
        add(addon, ob, "Lines", frame, [wave_at(x)])
    bpy.context.scene.frame_set(1)
    bpy.ops.rototoon.in_between(spacing="CHART", chart="50 -10 110")
    assert [points(addon, ob, f)[0][0, 0] for f in (2, 3, 4)] == pytest.approx([2.0, -0.4, 4.4], abs=1e-4)
    bpy.ops.rototoon.in_between(spacing="LINEAR", step=2)
    assert sorted(frames(addon, ob)) == [1, 3, 5]
    assert points(addon, ob, 3)[0][0, 0] == pytest.approx(2.0, abs=1e-4)
    for chart, message in (("", "empty"), ("10, x", '"x"'), ("99999", "-1000 to 1000")):
        with pytest.raises(RuntimeError, match=message):
            bpy.ops.rototoon.in_between(spacing="CHART", chart=chart)


def wave_at(x, count=20):
    return np.stack([x + np.linspace(0, 1, count), np.sin(np.linspace(0, 3, count))], 1)


def test_a_new_key_within_a_span_splits_it(addon):
    ob = keyed(addon, (1, 17))
    bpy.ops.rototoon.in_between(spacing="EASE_IN")
    gp = addon("blender.grease_pencil")
    gp.remove_frames(ob.data.layers["Lines"], [9])
    add(addon, ob, "Lines", 9, figure(4, 0.1))
    kept = looks(addon, ob, 9)
    bpy.ops.rototoon.update_in_betweens()
    assert looks(addon, ob, 9).equals(kept) and frames(addon, ob)[9] == "KEYFRAME"
    assert set(frames(addon, ob)) == set(range(1, 18))
    spans = json.loads(ob.data["rototoon_tween"])["Lines"]["spans"]
    assert {k: (v["last"], v["choices"]["spacing"]) for k, v in spans.items()} == {"1": (9, "EASE_IN"), "9": (17, "EASE_IN")}
    # And one that is gone joins its neighbours.
    gp.remove_frames(ob.data.layers["Lines"], [9])
    bpy.ops.rototoon.update_in_betweens()
    assert frames(addon, ob)[9] == "GENERATED"


def test_a_drawing_between_that_was_changed_becomes_a_key(addon):
    ob = keyed(addon, (1, 17))
    bpy.ops.rototoon.in_between()
    move(addon, ob, 9, index=slice(None), by=0.7)
    kept = content(addon, ob, "Lines", 9).point["position"]
    bpy.ops.rototoon.update_in_betweens()
    kinds = frames(addon, ob)
    assert kinds[9] == "BREAKDOWN" and kinds[8] == kinds[10] == "GENERATED"
    assert np.array_equal(content(addon, ob, "Lines", 9).point["position"], kept)
    near = points(addon, ob, 8)[0][3] - points(addon, ob, 9)[0][3]
    assert np.linalg.norm(near) < 0.3
    bpy.ops.rototoon.clear_in_betweens()
    assert sorted(frames(addon, ob)) == [1, 9, 17]
    assert "rototoon_tween" not in ob.data or not json.loads(ob.data["rototoon_tween"])["Lines"]["spans"]


def test_only_what_was_drawn_between_is_cleared(addon):
    ob = keyed(addon, KEYS, ("Lines", "Colours"))
    gp = addon("blender.grease_pencil")
    add(addon, ob, "Lines", 44, figure())
    gp.set_keyframe_type(ob.data.layers["Lines"], {44: "GENERATED"})
    bpy.ops.rototoon.in_between(frames="ALL")
    assert len(frames(addon, ob, "Colours")) == 41
    bpy.context.scene.frame_set(12)
    bpy.ops.rototoon.clear_in_betweens(frames="CURRENT", layers="ACTIVE")
    left = frames(addon, ob, ob.data.layers.active.name)
    assert 8 in left and not set(left) & set(range(10, 17))
    bpy.ops.rototoon.clear_in_betweens()
    assert set(frames(addon, ob)) == {*KEYS, 44} and set(frames(addon, ob, "Colours")) == set(KEYS)


def test_layers_with_the_same_keys_move_together_and_locked_ones_stay(addon):
    ob = keyed(addon, (1, 9), ("Lines", "Colours", "Locked"))
    ob.data.layers["Locked"].lock = True
    bpy.ops.rototoon.in_between()
    for frame in range(2, 9):
        for one, two in zip(points(addon, ob, frame), points(addon, ob, frame, "Colours"), strict=True):
            assert one == pytest.approx(two, abs=1e-4)
    assert sorted(frames(addon, ob, "Locked")) == [1, 9]


def test_strokes_appear_vanish_and_fall_into_pieces(addon):
    ob = drawing_object(addon)
    whole = limb(0, 0, 0.2, 60, 4.0)
    extra = circle((0, 3), 0.5, 20)
    add(addon, ob, "Lines", 1, [figure()[1], whole])
    add(addon, ob, "Lines", 9, [whole[30:], extra, figure()[1], whole[:31]])
    gp = addon("blender.grease_pencil")
    for frame, ids in ((1, [4, 0]), (9, [0, 4, 4, 0])):
        gp.put(drawing(addon, ob, "Lines", frame), "fill_id", np.array(ids))
    bpy.context.scene.frame_set(1)
    bpy.ops.rototoon.in_between(spacing="LINEAR", leaving="FADE")
    found = content(addon, ob, "Lines", 5)
    assert sorted(found.sizes.tolist()) == [20, 30, 30, 31]
    shown = np.minimum.reduceat(found.point["opacity"], found.starts[:-1])
    new = found.sizes.tolist().index(20)
    assert shown[new] == pytest.approx(0.5, abs=1e-5) and (np.delete(shown, new) == 1).all()
    assert found.curve["fill_opacity"][new] == pytest.approx(0.5, abs=1e-5)
    # The new stroke belongs to the fill of the one beside it.
    assert found.curve["fill_id"][new] == 4
    later = tracks(addon, ob, 9)
    assert {tracks(addon, ob, 5)[k] for k in range(4)} == set(later)
    bpy.ops.rototoon.in_between(spacing="LINEAR", leaving="GROW")
    strokes = points(addon, ob, 5)
    ring = next(s for s in strokes if len(s) == 20)
    assert np.ptp(ring, axis=0) == pytest.approx([0.5, 0.5], abs=0.01)


def test_bad_input_is_told_or_left_alone(addon):
    ob = drawing_object(addon)
    with pytest.raises(RuntimeError, match="two keys"):
        bpy.ops.rototoon.in_between()
    dot = np.array([[0.5, 0.5]])
    for frame in (1, 9):
        add(addon, ob, "Lines", frame, [dot + 0.1 * frame, np.repeat(dot, 5, 0), figure()[0], figure()[2]])
    gp = addon("blender.grease_pencil")
    handle = drawing(addon, ob, "Lines", 9)
    bad = gp.positions(handle, int(gp.offsets(handle)[-1]))
    bad[-1] = np.nan
    gp.put(handle, "position", bad)
    ob.data.layers["Lines"].frames.new(17)
    add(addon, ob, "Lines", 25, figure())
    add(addon, ob, "Lines", 26, figure())
    assert bpy.ops.rototoon.in_between(frames="ALL") == {"FINISHED"}
    assert set(frames(addon, ob)) == {*range(1, 10), 17, 25, 26}
    found = content(addon, ob, "Lines", 5)
    assert np.isfinite(found.point["position"]).all() and found.sizes.tolist()[:2] == [1, 5]
    bpy.context.scene.frame_set(20)
    with pytest.raises(RuntimeError, match="blank"):
        bpy.ops.rototoon.in_between()
    bpy.context.scene.frame_set(25)
    with pytest.raises(RuntimeError, match="No frames between"):
        bpy.ops.rototoon.in_between()


def scribble(seed):
    """Ten strokes at random places."""
    chance = np.random.default_rng(seed)
    return [limb(*chance.uniform(-4, 4, 2), chance.uniform(0, 6), 12, 1.5) for _ in range(10)]


def test_a_drawing_that_is_held_is_said(addon):
    ob = drawing_object(addon)
    for seed, frame in enumerate((1, 5, 9, 13)):
        add(addon, ob, "Lines", frame, scribble(min(seed, 2)))
    assert bpy.ops.rototoon.in_between(frames="ALL") == {"FINISHED"}
    (said,) = addon("common.reports").take()[-1].warnings
    assert said.startswith("frames 1 to 5, 5 to 9: no movement between the two drawings can be believed"), said
    assert np.allclose(content(addon, ob, "Lines", 3).point["position"], content(addon, ob, "Lines", 1).point["position"])
    assert bpy.ops.rototoon.update_in_betweens() == {"FINISHED"}
    assert addon("common.reports").take()[-1].warnings == (), "it is said once"


def test_a_text_that_is_not_understood_counts_as_none(addon):
    ob = keyed(addon)
    for text in ("{", "[]", '{"Lines": 3}', '{"Lines": {"next": 1, "spans": {"1": {}}}}'):
        ob.data["rototoon_tween"] = text
        assert bpy.ops.rototoon.in_between() == {"FINISHED"}
        assert len(frames(addon, ob)) == 9


def test_beziers_keep_their_handles(addon):
    ob = drawing_object(addon)
    gp = addon("blender.grease_pencil")
    turned = lambda p, a: p @ np.array([[np.cos(a), np.sin(a)], [-np.sin(a), np.cos(a)]])  # noqa: E731
    line = wave_at(0, 6)
    for frame, angle in ((1, 0.0), (9, 1.0)):
        handle = add(addon, ob, "Lines", frame, [turned(line, angle)])
        handle.set_types(type="BEZIER", indices=[0])
        for name, way in (("handle_left", -0.2), ("handle_right", 0.2)):
            values = np.zeros((6, 3), np.float32)
            values[:, [0, 2]] = turned(line + [way, 0.0], angle)
            if handle.attributes.get(name) is None:
                handle.attributes.new(name, "FLOAT_VECTOR", "POINT")
            gp.put(handle, name, values)
    bpy.context.scene.frame_set(1)
    bpy.ops.rototoon.in_between(spacing="LINEAR")
    found = content(addon, ob, "Lines", 5)
    assert found.types.tolist() == [2]
    reach = found.point["handle_right"] - found.point["position"]
    assert np.linalg.norm(reach, axis=1) == pytest.approx(np.full(6, 0.2), abs=2e-3)
    assert reach[2, [0, 2]] == pytest.approx(turned(np.array([0.2, 0.0]), 0.5), abs=5e-3)


def test_everything_is_one_undo_step(addon):
    bpy.context.preferences.edit.use_global_undo = True
    ob = keyed(addon)
    bpy.ops.ed.undo_push(message="keys")
    bpy.ops.rototoon.in_between("EXEC_DEFAULT", True)
    assert len(frames(addon, ob)) == 9
    bpy.ops.ed.undo()
    ob = bpy.data.objects["Drawing"]
    assert sorted(frames(addon, ob)) == [1, 9] and "rototoon_tween" not in ob.data


@pytest.mark.parametrize("chart", ["10, 30", "1 2 3 4 5 6 7 8"])
def test_a_chart_of_the_wrong_length_is_refused(addon, chart):
    ob = keyed(addon, (1, 9, 17))
    count = len(chart.replace(",", " ").split())
    with pytest.raises(RuntimeError, match=f"The chart has {count} percentages, expected 7, one for each drawing between the keys on 1 and 9"):
        bpy.ops.rototoon.in_between(frames="ALL", spacing="CHART", chart=chart)
    assert sorted(frames(addon, ob)) == [1, 9, 17]
    bpy.ops.rototoon.in_between(frames="ALL", spacing="CHART", chart="10, 30, 70", step=2)
    assert sorted(frames(addon, ob)) == list(range(1, 18, 2))


def test_the_button_chart_begins_with_an_even_chart_of_the_span(addon):
    ob = keyed(addon, (1, 9, 17, 22))
    bpy.context.scene.frame_set(3)

    def kept(first):
        return json.loads(ob.data["rototoon_tween"])["Lines"]["spans"][str(first)]["choices"]["chart"]

    bpy.ops.rototoon.in_between(frames="CURRENT", spacing="CHART")
    assert kept(1) == "12.5, 25, 37.5, 50, 62.5, 75, 87.5"
    # What Blender shows after the button, with another number of frames for each drawing.
    bpy.ops.rototoon.in_between(frames="CURRENT", spacing="CHART", chart=kept(1), step=2)
    assert kept(1) == "25, 50, 75"
    # The chart fits as it is.
    bpy.context.scene.frame_set(18)
    bpy.ops.rototoon.in_between(frames="CURRENT", spacing="CHART")
    assert kept(17) == "10, 30, 70, 90"
    with pytest.raises(RuntimeError, match="The chart has 4 percentages, expected 7"):
        bpy.ops.rototoon.in_between(frames="ALL", spacing="CHART")


@pytest.mark.parametrize("curve", ["0 0", "1 1", "0 0.5"])
def test_a_curve_of_one_end_is_refused(addon, curve):
    ob = keyed(addon)
    with pytest.raises(RuntimeError, match=f"The curve has only {curve}, expected a place between the keys or two places"):
        bpy.ops.rototoon.in_between(spacing="CURVE", curve=curve)
    assert sorted(frames(addon, ob)) == [1, 9]
    assert bpy.ops.rototoon.in_between(spacing="CURVE", curve="0.3 0.8") == {"FINISHED"}


def test_a_step_that_is_too_large_is_named(addon):
    keyed(addon)
    with pytest.raises(RuntimeError, match="Frames Each is 100, so no drawing lies between the keys on 1 and 9: choose 7 or less"):
        bpy.ops.rototoon.in_between(frames="ALL", step=100)
    bpy.ops.rototoon.in_between(frames="ALL", step=7)


def test_in_betweens_whose_last_key_was_removed_are_named(addon):
    ob, scripting = keyed(addon, (1, 9, 17)), addon("scripting")
    bpy.ops.rototoon.in_between(frames="ALL")
    ob.data.layers["Lines"].frames.remove(17)
    scripting.take_reports()
    bpy.ops.rototoon.update_in_betweens()
    report = scripting.take_reports()[-1]
    assert report.kind == "WARNING" and "in-betweens on 10 to 16 have no key on one side, and stay as they were: delete them" in report.text
    ob.data.layers["Lines"].frames.remove(9)
    with pytest.raises(RuntimeError, match="in-betweens on 2 to 8 and 10 to 16 have no key on one side"):
        bpy.ops.rototoon.update_in_betweens()

"""The Python interface beside the operators, and what scripts can read of reports."""

import bpy
import numpy as np
import pytest
import shots


@pytest.fixture
def scripting(addon):
    return addon("scripting")


@pytest.fixture
def ob(tmp_path):
    return shots.set_up(tmp_path)


def two_keys(scripting, ob):
    scripting.set_key(ob, 1, {"diamond": shots.diamond(0), "square": shots.square(0)})
    scripting.set_key(ob, 9, {"diamond": shots.diamond(8), "square": shots.square(8)})


def test_keys_from_pixels_are_tracked_and_read_back(addon, fake, scripting, ob):
    assert scripting.set_key(ob, 1, {"diamond": shots.diamond(0), "square": shots.square(0).tolist()}) == ["diamond", "square"]
    assert scripting.set_key(ob, 9, {"square": shots.square(8), "diamond": shots.diamond(8)}) == []
    found = scripting.track(ob)
    assert (found.contours, found.solved, found.kept, found.ends, found.warnings) == (14, 2, 0, (), ())
    assert scripting.track(ob).kept == 2
    diamond, square = scripting.parts(ob)
    assert (square.name, square.closed, square.points, square.keys) == ("square", True, 4, (1, 9))
    assert square.tracked == tuple(range(2, 9)) and square.depth > diamond.depth and square.layer == "Contours"
    track = scripting.tracks(ob)["square"]
    assert track.frames.tolist() == list(range(1, 10)) and track.closed
    assert track.pixels == pytest.approx(np.stack([shots.square(k) for k in range(9)]), abs=1e-3)
    assert track.is_key.tolist() == [True] + [False] * 7 + [True]
    assert track.confidence.shape == (9, 4) and (track.confidence[[0, -1]] == 1).all() and (track.confidence[4] == 0.5).all()
    assert track.pixels.dtype == track.world.dtype == np.float64


def test_world_points_are_where_the_camera_sees_the_pixels(addon, fake, scripting, ob):
    from bpy_extras.object_utils import world_to_camera_view
    from mathutils import Vector

    ob.location, ob.rotation_euler, ob.scale = (0.4, 1.0, -0.2), (0.1, 0.05, 0.3), (1.5, 1.5, 1.5)
    layer = shots.layer_of(ob)
    layer.translation = (0.2, 0.0, 0.1)
    bpy.context.view_layer.update()
    two_keys(scripting, ob)
    scripting.track(ob)
    track = scripting.tracks(ob)["square"]
    scene = bpy.context.scene
    for pixels, points in zip(track.pixels.reshape(-1, 2), track.world.reshape(-1, 3)):
        seen = world_to_camera_view(scene, scene.camera, Vector(points))
        assert (seen.x * 160, (1 - seen.y) * 90) == pytest.approx(pixels, abs=1e-2)


def test_world_points_of_a_moving_object(addon, fake, scripting, ob):
    for frame, x in ((1, 0.0), (9, 2.0)):
        ob.location.x = x
        ob.keyframe_insert("location", frame=frame)
    two_keys(scripting, ob)
    scripting.track(ob)
    still = scripting.tracks(ob)["square"].world
    bpy.context.scene.frame_set(5)
    track = scripting.tracks(ob)["square"]
    assert np.array_equal(track.world, still) and bpy.context.scene.frame_current == 5
    assert track.pixels[-1] == pytest.approx(shots.square(8), abs=1e-3)


def test_another_number_of_points_is_matched(addon, fake, scripting, ob):
    two_keys(scripting, ob)
    ring = shots.square(4)
    dense = np.concatenate([np.linspace(a, b, 6, endpoint=False) for a, b in zip(ring, np.roll(ring, -1, 0))])
    scripting.set_key(ob, 5, {"square": np.roll(dense[::-1], 3, 0)})
    assert scripting.parts(ob)[1].keys == (1, 5, 9) and scripting.parts(ob)[1].points == 4
    track = scripting.tracks(ob)["square"]
    assert track.pixels[track.frames.tolist().index(5)] == pytest.approx(ring, abs=0.05)


def test_a_generated_contour_becomes_the_key_and_a_key_is_kept(addon, fake, scripting, ob):
    two_keys(scripting, ob)
    scripting.track(ob)
    scripting.set_key(ob, 5, {"square": shots.square(4) + 2})
    assert [part.keys for part in scripting.parts(ob)] == [(1, 9), (1, 5, 9)]
    assert 5 in scripting.parts(ob)[0].tracked
    before = shots.snapshot(ob)
    with pytest.raises(RuntimeError, match='"square" has a key on frame 5 already'):
        scripting.set_key(ob, 5, {"diamond": shots.diamond(4), "square": shots.square(4)})
    assert shots.snapshot(ob) == before
    scripting.set_key(ob, 5, {"square": shots.square(4)}, replace=True)
    track = scripting.tracks(ob)["square"]
    assert track.pixels[4] == pytest.approx(shots.square(4), abs=1e-3)


def test_lost_parts_as_data_and_as_warning(addon, fake, scripting, ob):
    scripting.set_key(ob, 4, {"square": shots.square(3)})
    found = scripting.track(ob)
    assert found.lost == {"square": [1, 7]} == scripting.wanted_keys(ob)
    assert scripting.lost_frames(ob) == {"square": [1, 7, 8, 9]}
    assert [(end.frame, end.reason) for end in scripting.ends(ob)] == [(1, "lost"), (7, "lost")]
    assert found.warnings == ('"square" needs a key on 1 and 7',)
    assert scripting.weakest_frame(ob)[0] == 1, "where the part was lost, a key helps most"
    scripting.take_reports()
    bpy.ops.rototoon.track()
    (report,) = scripting.take_reports()
    assert (report.operator, report.kind, report.warnings) == ("track", "WARNING", found.warnings)
    assert report.text.endswith('; "square" needs a key on 1 and 7') and not scripting.take_reports()


def test_lines_of_other_layers_and_styles(addon, fake, scripting, ob):
    scripting.set_key(ob, 1, {"arm": shots.square(0)[:3]}, closed=False, layer="Contours.arm", radius=0.03)
    (part,) = scripting.parts(ob)
    assert (part.layer, part.closed, part.points) == ("Contours.arm", False, 3)
    gp = addon("blender.grease_pencil")
    handle = gp.drawings(ob.data.layers["Contours.arm"])[1][0]
    assert gp.value(handle, "radius", 3) == pytest.approx(np.full(3, 0.03))
    for name in ("Ink", "Contoursink"):
        with pytest.raises(RuntimeError, match="is not a contour layer"):
            scripting.set_key(ob, 1, {"leg": shots.square(0)}, layer=name)
        assert name not in ob.data.layers


def test_a_key_beyond_all_others_on_a_moving_object(addon, fake, scripting, ob):
    for frame, x in ((1, 0.0), (9, 2.0)):
        ob.location.x = x
        ob.keyframe_insert("location", frame=frame)
    two_keys(scripting, ob)
    assert scripting.tracks(ob)["square"].pixels == pytest.approx(np.stack([shots.square(0), shots.square(8)]), abs=1e-3)


@pytest.mark.parametrize(
    ("change", "call", "text"),
    [
        (lambda ob: None, lambda s, ob: s.track(ob), 'Draw contours on the layer "Contours" first'),
        (lambda ob: setattr(ob.rototoon, "pattern", ""), lambda s, ob: s.tracks(ob), "Choose the footage first"),
        (lambda ob: None, lambda s, ob: s.track(None), "Make a Grease Pencil object active first"),
        (lambda ob: None, lambda s, ob: s.set_key(ob, 1, {"a": [[1, 2, 3]]}), r'"a": expected at least two points'),
        (lambda ob: None, lambda s, ob: s.set_key(ob, 1, {"a": [[1, float("nan")], [3, 4]]}), r'"a": expected at least two'),
        (lambda ob: setattr(shots.layer_of(ob), "lock", True), lambda s, ob: s.set_key(ob, 1, {"a": shots.square(0)}), "is locked"),
        (lambda ob: ob.copy(), lambda s, ob: s.set_key(ob, 1, {"a": shots.square(0)}), "shares its drawings"),
        (
            lambda ob: setattr(bpy.context.window, "scene", bpy.data.scenes.new("Other")),
            lambda s, ob: s.set_key(ob, 1, {"a": shots.square(0)}),
            "is not in the scene",
        ),
        (
            lambda ob: (ob.data.layers.remove(shots.layer_of(ob)), bpy.data.objects.remove(bpy.context.scene.camera)),
            lambda s, ob: s.set_key(ob, 1, {"a": shots.square(0)}),
            "has no camera",
        ),
    ],
)
def test_refusals(addon, fake, scripting, ob, change, call, text):
    change(ob)
    before = shots.snapshot(ob)
    with pytest.raises(RuntimeError, match=text):
        call(scripting, ob)
    assert shots.snapshot(ob) == before


def test_errors_have_the_texts_of_the_operators(addon, fake, scripting, ob):
    ob.rototoon.preset = "zhou2011"
    scripting.set_key(ob, 1, {"square": shots.square(0)})
    with pytest.raises(RuntimeError) as of_operator:
        bpy.ops.rototoon.track()
    with pytest.raises(RuntimeError) as of_function:
        scripting.track(ob)
    assert str(of_operator.value).strip() == f"Error: {of_function.value}"
    with pytest.raises(RuntimeError, match="No method 'best': expected one of rototoon, zhou2011"):
        scripting.track(ob, "best")


def test_progress_cancels(addon, fake, scripting, ob):
    two_keys(scripting, ob)
    before, told = shots.snapshot(ob), []
    with pytest.raises(RuntimeError, match="stopped"):
        scripting.track(ob, progress=lambda share, step: told.append((share, step)) or False)
    assert told and shots.snapshot(ob) == before


def test_every_function_is_documented_and_typed(scripting):
    import inspect
    import typing

    from conftest import ROOT

    page = (ROOT / "docs/src/scripts/blender.md").read_text()
    for name in scripting.__all__:
        found = getattr(scripting, name)
        assert inspect.getdoc(found), name
        assert f"`{name}" in page or f"scripting.{name}" in page, f"{name} is not in docs/src/scripts/blender.md"
        if inspect.isfunction(found):
            function = inspect.unwrap(found)
            assert set(typing.get_type_hints(function)) == {*inspect.signature(function).parameters, "return"}, name


@pytest.mark.parametrize(
    ("frame", "name", "text"),
    [
        (101.5, "a", "frame: found 101.5, expected a whole number from 1 to 9"),
        ("x", "a", "frame: found 'x', expected a whole number from 1 to 9"),
        (None, "a", "frame: found None, expected a whole number"),
        (500, "a", "frame: found 500, expected a frame of the footage, from 1 to 9"),
        (0, "a", "frame: found 0, expected a frame of the footage, from 1 to 9"),
        (1, "", "polygons: found '', expected the name of a part"),
        (1, 3, "polygons: found 3, expected the name of a part"),
    ],
)
def test_a_bad_frame_or_part_of_a_key_is_named(addon, fake, scripting, ob, frame, name, text):
    before = shots.snapshot(ob)
    with pytest.raises(RuntimeError) as error:
        scripting.set_key(ob, frame, {name: shots.square(0)})
    assert str(error.value).startswith(text)
    assert shots.snapshot(ob) == before
    scripting.set_key(ob, np.int64(1), {"a": shots.square(0)})

"""Drawings without footage, and drawings of several layers, as a document."""

import json

import bpy
import pytest
from bpy_extras.object_utils import world_to_camera_view
from line_stage import said
from mathutils import Vector
from test_strokes import add, circle, drawing_object
from test_tween import figure

pytestmark = pytest.mark.usefixtures("library")


def scene(camera=True):
    """A scene whose camera looks at the drawing from the front, 100 pixels a unit."""
    if camera:
        data = bpy.data.cameras.new("Camera")
        data.type, data.ortho_scale = "ORTHO", 8.0
        bpy.context.scene.camera = bpy.data.objects.new("Camera", data)
        bpy.context.collection.objects.link(bpy.context.scene.camera)
        bpy.context.scene.camera.location = (0, -10, 0)
        bpy.context.scene.camera.rotation_euler = (1.5707963, 0, 0)
    render = bpy.context.scene.render
    render.resolution_x, render.resolution_y, render.resolution_percentage = 800, 600, 100
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 1, 12


def drawn(addon, layers=("Lines",), keys=(1, 9)):
    ob = drawing_object(addon, layers)
    for layer in layers:
        for k, frame in enumerate(keys):
            add(addon, ob, layer, frame, figure(0.5 * k, 0.1 * k))
    bpy.context.scene.frame_set(keys[0])
    bpy.ops.rototoon.in_between(spacing="LINEAR", frames="ALL")
    return ob


def exported(path, **how):
    assert bpy.ops.rototoon.export_document(filepath=str(path), **how) == {"FINISHED"}
    return json.loads(path.read_text())


def test_drawings_without_footage_are_in_pixels_of_the_camera(addon, tmp_path, monkeypatch):
    # The pattern does not depend on the current folder.
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    scene()
    drawn(addon)
    found = exported(tmp_path / "none.json")
    assert found["footage"] == {"pattern": "no_footage_%04d.png", "first": 1, "last": 12, "fps": 24.0, "width": 800, "height": 600}
    assert said(addon).text == "2 drawings and 7 in-betweens in none.json, without footage"
    assert [each["frame"] for each in found["drawings"]] == [1, 9] and [each["frame"] for each in found["in_betweens"]] == list(range(2, 9))
    wanted = figure()[0][0]
    assert found["drawings"][0]["strokes"][0]["points"][0] == pytest.approx([400 + 100 * wanted[0], 300 - 100 * wanted[1]], abs=0.01)
    assert addon("rototoon").Session.open(str(tmp_path / "none.json")) is not None


@pytest.mark.parametrize("aspect", [(4 / 3, 1), (1, 2)])
def test_drawings_are_in_pixels_of_the_rendered_picture_whatever_their_shape(addon, tmp_path, aspect):
    scene()
    bpy.context.scene.render.pixel_aspect_x, bpy.context.scene.render.pixel_aspect_y = aspect
    ob = drawn(addon)
    bpy.context.view_layer.update()
    found = exported(tmp_path / "none.json")["drawings"][0]["strokes"][0]["points"][0]
    seen = world_to_camera_view(bpy.context.scene, bpy.context.scene.camera, ob.matrix_world @ Vector((figure()[0][0][0], 0, figure()[0][0][1])))
    assert found == pytest.approx([800 * seen.x, 600 * (1 - seen.y)], abs=0.01)


def test_without_a_camera_there_are_no_pixels(addon, tmp_path):
    scene(camera=False)
    drawn(addon)
    with pytest.raises(RuntimeError, match="camera|footage"):
        exported(tmp_path / "none.json")
    assert not (tmp_path / "none.json").exists()


def test_all_layers_are_one_drawing_in_their_order(addon, tmp_path):
    scene()
    ob = drawn(addon, ("Back", "Lines", "Front"))
    ob.data.layers["Front"].hide = True
    add(addon, ob, "Back", 5, [circle((0, 0), 1.0, 12)])
    bpy.ops.rototoon.update_in_betweens()
    found = exported(tmp_path / "all.json", layers="ALL")
    assert said(addon).warnings == ()
    # Where one layer has a drawing of the artist, the others give what they show.
    assert [each["frame"] for each in found["drawings"]] == [1, 5, 9]
    assert [len(each["strokes"]) for each in found["drawings"]] == [6, 7, 6]
    assert [each["frame"] for each in found["in_betweens"]] == [2, 3, 4, 6, 7, 8]
    one = exported(tmp_path / "one.json")["drawings"]
    assert said(addon).warnings[0].startswith('left out: lines on "Back"')
    points = [[stroke["points"] for stroke in each["strokes"]] for each in (one[0], one[1])]
    assert [stroke["points"] for stroke in found["drawings"][0]["strokes"][3:]] == points[0]
    assert [stroke["points"] for stroke in found["drawings"][2]["strokes"][3:]] == points[1]
    for each in found["in_betweens"]:
        tracks = [stroke["track"] for stroke in each["strokes"]]
        assert len(set(tracks)) == len(tracks)
    for match in found["matches"]:
        assert [len(tracks) for tracks in match["tracks"]] == [len(each["strokes"]) for each in found["drawings"] if each["frame"] in (match["frame"], match["next"])]
    assert addon("rototoon").Session.open(str(tmp_path / "all.json")) is not None


def test_pairs_and_spacings_of_layers_with_the_same_keys_go_out(addon, tmp_path):
    scene()
    ob = drawn(addon, ("Back", "Lines"))
    bpy.ops.rototoon.in_between(spacing="EASE_IN")
    ob.data.layers.active = ob.data.layers["Lines"]
    bpy.ops.rototoon.match_strokes(layers="ACTIVE")
    bpy.ops.rototoon.match_strokes(layers="ACTIVE", earlier=1, later=2)
    bpy.ops.rototoon.match_strokes(layers="ACTIVE", earlier=3, later=-1)
    found = exported(tmp_path / "all.json", layers="ALL")
    assert found["drawings"][0]["spacing"] == "ease_in"
    assert found["pairs"] == [{"frame": 1, "from": 3, "to": 4}, {"frame": 1, "from": 5, "to": None}]


def test_a_layer_without_lines_is_named(addon, tmp_path):
    scene()
    drawn(addon, ("Ink",))
    with pytest.raises(RuntimeError, match='No lines on "Lines": choose the layer of your lines in the panel Lines, or all layers'):
        exported(tmp_path / "none.json")
    assert len(exported(tmp_path / "all.json", layers="ALL")["drawings"]) == 2


def test_lines_that_were_hidden_stay_hidden(addon, tmp_path):
    scene()
    ob = drawing_object(addon, ("Lines", "Front"), filled=True)
    square = [[0, 0], [2, 0], [2, 2], [0, 2]]
    add(addon, ob, "Lines", 1, [square], cyclic=True)
    add(addon, ob, "Front", 1, [[[1, -1], [3, -1], [3, 3], [1, 3]]], cyclic=True)
    gp = addon("blender.grease_pencil")
    if gp.FILL_BY_ID:
        for layer in ob.data.layers:
            gp.put(gp.drawings(layer)[1][0], "fill_id", [1])
    bpy.context.scene.frame_set(1)
    bpy.ops.rototoon.hidden_lines()
    shape, *lines = exported(tmp_path / "cut.json")["drawings"][0]["strokes"]
    assert shape["fill"] and shape["closed"] and "widths" not in shape, "the outline carries the fill alone"
    assert lines and all(point[0] <= 500.1 for each in lines for point in each["points"]), "behind the front shape is no line"


def test_contours_need_footage_and_are_named(addon, tmp_path):
    scene()
    ob = drawn(addon)
    ob.data.layers.new("Contours")
    add(addon, ob, "Contours", 1, [circle((0, 0), 1.0, 12)])
    exported(tmp_path / "lines.json")
    assert said(addon).warnings == ("left out: contours, which need footage",)
    ob.rototoon.lines_layer = "None"
    with pytest.raises(RuntimeError, match="Choose the footage first, in the panel Footage: contours need it"):
        exported(tmp_path / "none.json")

"""Cameras, images and drawings that Blender does not evaluate: they are read where they are, also after a file was opened again, or refused."""

import bpy
import pytest
import shots
from mathutils import Matrix

MOVES = "moves, and Blender does not show where"


def keyed(addon, folder, **options):
    """A shot of which nothing is at the origin, with a key. What shows the footage hangs on an empty."""
    ob = shots.set_up(folder, **options)
    shower = ob.rototoon.reference if ob.rototoon.plane == "REFERENCE" else ob.rototoon.camera
    stand = bpy.data.objects.new("Stand", None)
    bpy.context.scene.collection.objects.link(stand)
    shower.parent = stand
    for each in (ob, stand):
        each.matrix_world = Matrix.Translation((3, 1, 2)) @ Matrix.Rotation(0.5, 4, "Z") @ each.matrix_world
    bpy.context.view_layer.update()
    other = bpy.data.objects.new("Final", bpy.data.cameras.new("Final"))
    bpy.context.scene.collection.objects.link(other)
    bpy.context.scene.camera = other
    shots.draw(addon, ob, 1, [shots.square(0)])
    bpy.ops.rototoon.match_contours()
    return ob, shower, stand


def untick(*objects):
    """Puts objects into a collection, and takes its tick away."""
    aside = bpy.data.collections.new("Aside")
    bpy.context.scene.collection.children.link(aside)
    for each in objects:
        for home in each.users_collection:
            home.objects.unlink(each)
        aside.objects.link(each)
    bpy.context.view_layer.layer_collection.children["Aside"].exclude = True


def disable(*objects):
    for each in objects:
        each.hide_viewport = True


def again(ob, folder):
    """The object after its file was saved and opened."""
    name, path = ob.name, str(folder / "shot.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    return bpy.data.objects[name]


def square(addon, ob):
    (part,) = addon("scripting").tracks(ob).values()
    return part.pixels[0]


@pytest.mark.every_version
@pytest.mark.parametrize("hide", [disable, untick])
@pytest.mark.parametrize("plane", ["CAMERA", "REFERENCE"])
def test_what_shows_the_footage_is_read_where_it_is(addon, tmp_path, plane, hide):
    ob, shower, _ = keyed(addon, tmp_path, plane=plane)
    hide(shower)
    assert square(addon, again(ob, tmp_path)) == pytest.approx(shots.square(0), abs=2e-3)


def test_a_drawing_and_all_that_shows_it_are_read_where_they_are(addon, tmp_path):
    ob, shower, stand = keyed(addon, tmp_path)
    untick(ob, shower, stand)
    assert square(addon, again(ob, tmp_path)) == pytest.approx(shots.square(0), abs=2e-3)


@pytest.mark.every_version
def test_lines_of_a_drawing_are_as_wide_as_they_are(addon, tmp_path):
    """The widths of strokes are scaled with the object."""
    ob, _, _ = keyed(addon, tmp_path)
    ob.scale = (2, 2, 2)
    bpy.context.view_layer.update()
    radius_of = addon("blender.camera").radius_of
    seen = radius_of(ob)
    untick(ob)
    assert radius_of(again(ob, tmp_path)) == pytest.approx(seen)


def test_radii_are_those_of_its_scale(addon, tmp_path):
    ob, shower, stand = keyed(addon, tmp_path)
    ob.scale = (2, 2, 2)
    untick(ob, shower, stand)
    assert addon("blender.camera").radius_of(again(ob, tmp_path)) == pytest.approx(2)


def test_an_object_in_another_scene_than_its_camera(addon, tmp_path):
    ob, _, _ = keyed(addon, tmp_path)
    second = bpy.data.scenes.new("Second")
    second.collection.objects.link(ob)
    second.render.resolution_x, second.render.resolution_y = shots.SIZE
    bpy.context.window.scene = second
    assert square(addon, again(ob, tmp_path)) == pytest.approx(shots.square(0), abs=2e-3)


def test_a_linked_object_is_seen_through_its_own_camera(addon, tmp_path):
    ob, _, _ = keyed(addon, tmp_path)
    name, path = ob.name, str(tmp_path / "shot.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    bpy.context.scene.render.resolution_x, bpy.context.scene.render.resolution_y = shots.SIZE
    bpy.ops.wm.link(directory=path + "/Object/", filename=name)
    assert square(addon, bpy.data.objects[name]) == pytest.approx(shots.square(0), abs=2e-3)


@pytest.mark.every_version
def test_what_moves_unseen_is_refused_by_name(addon, tmp_path):
    ob, camera, _ = keyed(addon, tmp_path)
    camera.keyframe_insert("location", frame=1)
    camera.hide_set(True)
    assert square(addon, ob) == pytest.approx(shots.square(0), abs=2e-3)
    disable(camera)
    with pytest.raises(RuntimeError, match=f'"{camera.name}" {MOVES}'):
        bpy.ops.rototoon.export_document(filepath=str(tmp_path / "out.json"))
    assert not (tmp_path / "out.json").exists()


def test_what_hangs_on_something_that_moves_is_read_while_that_is_seen(addon, tmp_path):
    ob, camera, stand = keyed(addon, tmp_path)
    stand.keyframe_insert("location", frame=1)
    disable(camera)
    ob = again(ob, tmp_path)
    assert square(addon, ob) == pytest.approx(shots.square(0), abs=2e-3)
    disable(bpy.data.objects["Stand"])
    with pytest.raises(RuntimeError, match=f'"Stand" {MOVES}'):
        square(addon, ob)

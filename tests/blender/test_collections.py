"""Where new objects are put: into the active collection, unless it belongs to another file."""

import bpy
import pytest
import shots


def linked(folder):
    """A collection of another file, made active."""
    made = bpy.data.collections.new("Set")
    bpy.data.libraries.write(str(folder / "set.blend"), {made})
    bpy.data.collections.remove(made)
    with bpy.data.libraries.load(str(folder / "set.blend"), link=True) as (_, into):
        into.collections = ["Set"]
    bpy.context.scene.collection.children.link(into.collections[0])
    bpy.context.view_layer.active_layer_collection = bpy.context.view_layer.layer_collection.children["Set"]
    return into.collections[0]


@pytest.mark.parametrize("plane", ["CAMERA", "REFERENCE"])
def test_into_the_active_collection(addon, tmp_path, plane):
    made = bpy.data.collections.new("Shots")
    bpy.context.scene.collection.children.link(made)
    bpy.context.view_layer.active_layer_collection = bpy.context.view_layer.layer_collection.children["Shots"]
    ob = shots.set_up(tmp_path, plane=plane)
    shows = ob.rototoon.camera if plane == "CAMERA" else ob.rototoon.reference
    assert {ob, shows} <= set(made.objects)


def test_into_the_scene_where_the_active_collection_is_of_another_file(addon, tmp_path):
    made = linked(tmp_path)
    ob = shots.set_up(tmp_path)
    assert bpy.context.scene.collection.objects[ob.name] == ob == bpy.context.view_layer.objects.active and not len(made.objects)

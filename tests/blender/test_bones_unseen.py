"""Armatures that Blender does not evaluate, since they are disabled in viewports: their bones do not move, and are refused."""

import bpy
import pytest
from test_bones import armature, needs_library, put, saved, walk  # noqa: F401 - fixtures
from test_not_evaluated import disable


def collection(ob):
    aside = bpy.data.collections.new("Aside")
    bpy.context.scene.collection.children.link(aside)
    aside.objects.link(ob)
    bpy.context.scene.collection.objects.unlink(ob)
    bpy.context.view_layer.objects.active = ob
    aside.hide_viewport = True


def driven(addon, folder):
    """An armature that walks."""
    put(addon, folder, walk(addon))
    ob = armature()
    assert bpy.ops.rototoon.drive_bones(content="boy", motion="walk", view="FRONT", folder=str(folder)) == {"FINISHED"}
    return ob


@pytest.mark.parametrize("hide", [disable, collection])
def test_an_armature_that_is_not_moved_is_refused(addon, tmp_path, hide):
    ob = driven(addon, tmp_path)
    hide(ob)
    before = ob.animation_data.action
    with pytest.raises(RuntimeError, match='"Rig" is disabled in viewports or excluded from the view layer'):
        bpy.ops.rototoon.save_clip_from_armature(character="rig", motion="back", view="FRONT", folder=str(tmp_path))
    with pytest.raises(RuntimeError, match='"Rig" is disabled in viewports or excluded from the view layer'):
        bpy.ops.rototoon.drive_bones(content="boy", motion="walk", view="FRONT", folder=str(tmp_path))
    assert ob.animation_data.action == before


def test_an_armature_behind_the_eye_moves(addon, tmp_path):
    driven(addon, tmp_path).hide_set(True)
    assert bpy.ops.rototoon.save_clip_from_armature(character="rig", motion="back", view="FRONT", folder=str(tmp_path)) == {"FINISHED"}
    assert saved(addon, tmp_path, "rig", "back").std(0).max() > 10

"""One undo takes back what an operator did, and one redo does it again: drawings, types of frames, parts, settings, objects."""

import bpy
import pytest
import shots
import studio
from studio import OPERATORS
from test_guard import file, opened, prepared, run, said  # noqa: F401 - fixtures of the studio

pytestmark = pytest.mark.every_version

PLAIN = {"STRING", "INT", "FLOAT", "ENUM", "BOOLEAN"}


def plain(properties):
    """The values of all single properties."""
    single = (prop for prop in properties.bl_rna.properties if prop.type in PLAIN and not getattr(prop, "is_array", False))
    return {prop.identifier: getattr(properties, prop.identifier) for prop in single}


def state(addon):
    """By object what an artist would miss."""
    found = {}
    for ob in bpy.data.objects:
        drawings = studio.digests(addon, ob) if ob.type == "GREASEPENCIL" else {}
        layers = [(layer.name, layer.hide, layer.lock) for layer in ob.data.layers] if drawings else []
        parts = [plain(part) for part in ob.rototoon.parts]
        found[ob.name] = {"drawings": drawings, "layers": layers, "parts": parts, **plain(ob.rototoon)}
    return found


@pytest.mark.parametrize("name", OPERATORS)
def test_undo_and_redo(addon, opened, file, said, name):  # noqa: F811
    prepared(addon, opened, name)
    bpy.ops.ed.undo_push(message="before")
    before = state(addon)
    assert "Error" not in run(addon, name, file, said)
    after = state(addon)
    bpy.ops.ed.undo_push(message="after")
    bpy.ops.ed.undo()
    assert state(addon) == before
    bpy.ops.ed.redo()
    assert state(addon) == after


def test_a_new_key_of_an_opened_file_is_a_key_in_the_saved_one(addon, fake, tmp_path):
    path = str(tmp_path / "shot.blend")
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    bpy.context.scene.frame_set(5)
    bpy.ops.rototoon.new_key()
    bpy.ops.wm.save_mainfile()
    bpy.ops.wm.open_mainfile(filepath=path)
    drawings = addon("blender.grease_pencil").drawings(shots.layer_of(bpy.context.object))
    assert [drawings[number][1] for number in (1, 4, 5, 6, 9)] == ["KEYFRAME", "GENERATED", "KEYFRAME", "GENERATED", "KEYFRAME"]

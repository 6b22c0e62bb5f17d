"""Parts that the picture hides, and contours that are lost."""

import json

import bpy
import numpy as np
import pytest
import shots


def made(addon, ob, number):
    """Frames with a generated contour of a part."""
    return sorted(addon("capture.contours").read(ob).part(number).made)


def hide(ob, frame, part=0, **options):
    bpy.context.scene.frame_set(frame)
    ob.rototoon.active_part = part
    return bpy.ops.rototoon.hide_part(**options)


def doubt(addon, ob, frames, value, strokes=2):
    """Gives the generated contours of some frames this confidence."""
    gp = addon("blender.grease_pencil")
    for frame in frames:
        handle = gp.drawings(shots.layer_of(ob))[frame][0]
        gp.put(handle, gp.CONFIDENCE, np.full(int(gp.offsets(handle)[-1]), value))


def test_a_hidden_part_has_no_contour_until_it_is_there_again(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    before = made(addon, ob, 1)
    assert hide(ob, 4) == {"FINISHED"} and hide(ob, 5) == {"FINISHED"}
    assert made(addon, ob, 1) == [frame for frame in before if frame not in (4, 5)]
    assert made(addon, ob, 2) == before
    item, offset = ob.rototoon.parts[0], ob.rototoon.frame_offset
    assert addon("capture.absence").of(item) == [[4 - offset, 5 - offset]]
    path = tmp_path / "out.json"
    bpy.ops.rototoon.export_document(filepath=str(path))
    part = json.loads(path.read_text())["parts"][0]
    assert part["absent"] == [[4 - offset, 5 - offset]]
    assert str(4 - offset) not in part["tracks"] and str(6 - offset) in part["tracks"]
    assert hide(ob, 4) == {"FINISHED"}
    assert addon("capture.absence").of(item) == [[5 - offset, 5 - offset]]
    bpy.ops.rototoon.import_document(filepath=str(path))
    assert addon("capture.absence").of(bpy.context.object.rototoon.parts[0]) == [[4 - offset, 5 - offset]]


def test_the_library_leaves_hidden_frames_out(addon, library, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    before = made(addon, ob, 1)
    hide(ob, 4)
    bpy.ops.rototoon.track()
    assert made(addon, ob, 1) == [frame for frame in before if frame != 4] and made(addon, ob, 2) == before
    hide(ob, 4)
    bpy.ops.rototoon.track()
    assert made(addon, ob, 1) == before


def test_a_lost_stretch_is_hidden_at_once(addon, fake, library, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    doubt(addon, ob, made(addon, ob, 1), 1.0)
    doubt(addon, ob, (5, 6, 7), 0.1)
    hide(ob, 6, frames="STRETCH")
    assert not {5, 6, 7} & set(made(addon, ob, 1)) and 4 in made(addon, ob, 1)
    hide(ob, 6, frames="STRETCH")
    assert addon("capture.absence").of(ob.rototoon.parts[0]) == []


def test_keys_cannot_be_hidden_and_locked_layers_stay(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    with pytest.raises(RuntimeError, match="has a key on frame 1"):
        hide(ob, 1)
    shots.layer_of(ob).lock = True
    with pytest.raises(RuntimeError, match="is locked"):
        hide(ob, 4)
    shots.layer_of(ob).lock = False
    assert ob.rototoon.parts[0].extra == "" and 4 in made(addon, ob, 1)


def test_lost_contours_are_marked_and_found(addon, fake, library, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    doubt(addon, ob, made(addon, ob, 1), 1.0)
    overlay = addon("ui.overlay")
    assert overlay.lost_lines(ob, 6) == []
    doubt(addon, ob, (6,), 0.1)
    lines = overlay.lost_lines(ob, 6)
    assert len(lines) == 2 and all(np.array_equal(line[0], line[-1]) for line in lines), "closed contours end where they begin"
    judged = addon("capture.doubt").judged(ob, addon("capture.contours").read(ob, (addon("blender.grease_pencil").CONFIDENCE,)))
    assert judged.of(1).lost == judged.of(2).lost == [6] and judged.weakest == 6
    bpy.ops.rototoon.weakest_frame()
    assert bpy.context.scene.frame_current == 6

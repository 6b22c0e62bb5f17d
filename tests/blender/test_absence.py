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


def test_corrections_that_go_with_a_hidden_contour_are_told(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    shots.move(addon, ob, 4, 1, (5.0, -3.0), which=[1])
    reports = addon("common.reports")
    reports.take()
    for frame, told in ((4, True), (5, False)):
        hide(ob, frame)
        (report,) = reports.take()
        assert ("your corrections of it on 4 are gone: Undo brings them back" in report.text) == told, report


def shown(addon, ob, layer, frame):
    """The number of strokes that a layer shows on a frame. Blender shows a drawing until the next one."""
    gp = addon("blender.grease_pencil")
    before = [number for number in gp.frame_numbers(ob.data.layers[layer]) if number <= frame]
    return len(gp.offsets(gp.drawings(ob.data.layers[layer])[max(before)][0])) - 1 if before else 0


def alone(addon, tmp_path):
    """The square alone on its layer, keyed on frames 1 and 9, tracked and snapped."""
    ob = shots.set_up(tmp_path)
    shots.draw(addon, ob, 1, [shots.square(0)])
    bpy.context.scene.frame_set(9)
    bpy.ops.rototoon.new_key()
    bpy.ops.rototoon.track()
    bpy.ops.rototoon.snap()
    return ob


@pytest.mark.parametrize("frames", [[4, 5], [2, 3], [7, 8], [2, 3, 4, 5, 6, 7, 8]])
def test_a_hidden_part_alone_on_its_layer_does_not_show(addon, library, tmp_path, frames):
    """Not even by the drawing before, whether tracked or a key, and its snapped line goes too."""
    ob = alone(addon, tmp_path)
    for frame in frames:
        assert hide(ob, frame) == {"FINISHED"}

    def gone(layer):
        return [frame for frame in range(1, 10) if not shown(addon, ob, layer, frame)]

    assert gone("Contours") == gone("Snapped") == frames
    for _ in range(2):
        bpy.ops.rototoon.track()
        bpy.ops.rototoon.snap()
        assert gone("Contours") == gone("Snapped") == frames
    path = tmp_path / "out.json"
    bpy.ops.rototoon.export_document(filepath=str(path))
    # There again, no empty drawing is left.
    hide(ob, frames[0], frames="STRETCH")
    bpy.ops.rototoon.track()
    assert not gone("Contours")
    bpy.ops.rototoon.import_document(filepath=str(path))
    ob = bpy.context.object
    assert gone("Contours") == gone("Snapped") == frames
    bpy.context.scene.frame_set(frames[0])
    assert bpy.ops.rototoon.new_key() == {"FINISHED"} and shown(addon, ob, "Contours", frames[0]) == 1
    bpy.ops.rototoon.clear_generated()
    assert addon("blender.grease_pencil").frame_numbers(shots.layer_of(ob)) == [1, frames[0], 9]


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

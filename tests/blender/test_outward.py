"""Parts with one key: generated frames around it, and where the panel says that a key is wanted."""

import json

import bpy
import numpy as np
import pytest
import shots


def one_key(addon, tmp_path, frame=5):
    """Footage, and the diamond and the square drawn on one frame."""
    ob = shots.set_up(tmp_path)
    shots.draw(addon, ob, frame, [shots.diamond(frame - 1), shots.square(frame - 1)])
    return ob


def made(addon, ob):
    """Frames with a generated contour, by part number."""
    return {part.number: sorted(part.made) for part in addon("capture.contours").read(ob).parts}


def test_generated_frames_go_outward_and_the_panel_says_where_a_key_is_wanted(addon, fake, tmp_path):
    ob = one_key(addon, tmp_path)
    assert bpy.ops.rototoon.track() == {"FINISHED"}
    assert made(addon, ob) == {1: [3, 4, 6, 7], 2: [3, 4, 6, 7]}
    said = addon("ui.panels").said_of_ends(ob.rototoon)
    assert said == [("2 parts need a key on frame 2", "KEY_HLT"), ("2 parts need a key on frame 8", "KEY_HLT")]


def test_a_lost_part_does_not_go_on_showing(addon, fake, tmp_path):
    """Blender shows a drawing until the next one, so an empty one ends what was tracked."""
    ob = one_key(addon, tmp_path)
    for _ in range(2):
        bpy.ops.rototoon.track()
        gp = addon("blender.grease_pencil")
        strokes = {frame: len(gp.offsets(handle)) - 1 for frame, (handle, _) in gp.drawings(shots.layer_of(ob)).items()}
        assert strokes == {3: 2, 4: 2, 5: 2, 6: 2, 7: 2, 8: 0}
    bpy.context.scene.frame_set(8)
    assert bpy.ops.rototoon.new_key() == {"FINISHED"}
    bpy.ops.rototoon.track()
    assert made(addon, ob)[1] == [6, 7]


def test_corrections_beside_a_single_key_are_kept(addon, fake, tmp_path):
    ob = one_key(addon, tmp_path)
    bpy.ops.rototoon.track()
    shots.move(addon, ob, 7, 2, (5.0, -3.0), which=[1])
    moved = dict(shots.pixels(addon, ob, 7))[2][1]
    bpy.ops.rototoon.track()
    state = addon("capture.sessions").known(ob).session.state
    assert list(state["parts"][1]["pins"]) == ["7"]
    assert np.array_equal(dict(shots.pixels(addon, ob, 7))[2][1], moved)
    # Another method stays on the key.
    ob.rototoon.preset = "zhou2011"
    with pytest.raises(RuntimeError, match="Nothing to track"):
        bpy.ops.rototoon.track()


def test_a_further_key_makes_an_ordinary_part(addon, fake, tmp_path):
    ob = one_key(addon, tmp_path)
    bpy.ops.rototoon.track()
    bpy.context.scene.frame_set(9)
    ob.rototoon.active_part = 1
    bpy.ops.rototoon.new_key(parts="ACTIVE")
    bpy.ops.rototoon.track()
    assert made(addon, ob) == {1: [3, 4, 6, 7], 2: [6, 7, 8]}
    said = [text for text, _ in addon("ui.panels").said_of_ends(ob.rototoon)]
    assert said == ["Part 1 needs a key on frame 2", "Part 1 needs a key on frame 8"]


def test_documents_keep_outward_tracks_and_wanted_keys(addon, fake, tmp_path):
    ob = one_key(addon, tmp_path)
    bpy.ops.rototoon.track()
    path = tmp_path / "out.json"
    bpy.ops.rototoon.export_document(filepath=str(path))
    document = json.loads(path.read_text())
    assert document["parts"][0]["wants_key"] == [2, 8]
    assert sorted(document["parts"][0]["tracks"]) == ["3", "4", "5", "6", "7"]
    before = made(addon, ob)
    bpy.ops.rototoon.import_document(filepath=str(path))
    again = bpy.context.object
    assert made(addon, again) == before
    assert len(addon("ui.panels").said_of_ends(again.rototoon)) == 2


def test_undo_and_clear_leave_the_key(addon, fake, tmp_path):
    ob = one_key(addon, tmp_path)
    bpy.ops.rototoon.track()
    assert bpy.ops.rototoon.clear_generated() == {"FINISHED"}
    assert made(addon, ob) == {1: [], 2: []}
    assert [frame.frame_number for frame in shots.layer_of(ob).frames] == [5]


def test_the_library_follows_a_single_key(addon, library, tmp_path):
    ob = one_key(addon, tmp_path)
    assert bpy.ops.rototoon.track() == {"FINISHED"}
    truth = {1: shots.diamond, 2: shots.square}
    for part, frames in made(addon, ob).items():
        assert frames == [1, 2, 3, 4, 6, 7, 8, 9]
        for frame in frames:
            points = dict(shots.pixels(addon, ob, frame))[part]
            # The square hides corners of the diamond in the end.
            assert np.median(np.linalg.norm(points - truth[part](frame - 1), axis=1)) < 2
    assert addon("ui.panels").said_of_ends(ob.rototoon) == []

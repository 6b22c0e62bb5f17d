"""Contours that lie in front of the object's own plane, as after drawing at the 3D cursor or on a surface: what comes in later lies on their plane."""

import bpy
import numpy as np
import pytest
import shots

DEPTH = -2.0


@pytest.fixture
def before(addon, fake, tmp_path):
    """Two keys, moved towards the camera."""
    ob, gp = shots.two_keys(addon, tmp_path), addon("blender.grease_pencil")
    for handle, _ in gp.drawings(shots.layer_of(ob)).values():
        points = gp.positions(handle, int(gp.offsets(handle)[-1]))
        points[:, 1] = DEPTH
        gp.put(handle, "position", points)
    bpy.ops.rototoon.match_contours()
    return ob


def depths(addon, ob):
    """The depths of all contours."""
    gp = addon("blender.grease_pencil")
    handles = [handle for handle, _ in gp.drawings(shots.layer_of(ob)).values()]
    return np.concatenate([gp.positions(handle, int(gp.offsets(handle)[-1]))[:, 1] for handle in handles])


def test_make_part_draws_on_their_plane(addon, before):
    bpy.context.scene.frame_set(1)
    outline = np.array([[130.0, 5], [150, 5], [150, 15], [130, 15]])
    gp = addon("blender.grease_pencil")
    lines = gp.layer(before, "Lines")
    drawing = lines.frames.new(1).drawing
    drawing.add_strokes([4])
    gp.put(drawing, "position", shots.mapping(addon, before).to_layer(outline).astype(np.float32))
    gp.put(drawing, "cyclic", np.array([True]))
    gp.put(drawing, gp.TRACK, np.array([1]))
    assert bpy.ops.rototoon.make_part(numbers="1", name="hat") == {"FINISHED"}
    assert bpy.ops.rototoon.track() == {"FINISHED"}
    assert depths(addon, before) == pytest.approx(DEPTH, abs=1e-5)
    seen = addon("scripting").tracks(before)["hat"].pixels[0]
    assert np.array(sorted(seen.round(1).tolist())) == pytest.approx(np.array(sorted(outline.tolist())), abs=0.1)


def test_an_import_lies_on_their_plane(addon, before, tmp_path):
    assert bpy.ops.rototoon.track() == {"FINISHED"}
    path = str(tmp_path / "shot.json")
    bpy.ops.rototoon.export_document(filepath=path)
    seen = addon("scripting").tracks(before)
    bpy.ops.rototoon.import_document(filepath=path, into="ACTIVE")
    assert depths(addon, before) == pytest.approx(DEPTH, abs=1e-5)
    for name, track in addon("scripting").tracks(before).items():
        assert track.pixels == pytest.approx(seen[name].pixels, abs=2e-3)

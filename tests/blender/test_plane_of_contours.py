"""Contours that lie in front of the object's own plane, as after drawing at the 3D cursor or on a surface: what comes in later lies on their plane."""

import bpy
import numpy as np
import pytest
import shots

DEPTH = -2.0


@pytest.fixture
def before(addon, fake, tmp_path):
    """Two keys, moved towards the camera."""
    ob = shots.two_keys(addon, tmp_path)
    moved(addon, ob, "Contours", DEPTH)
    bpy.ops.rototoon.match_contours()
    return ob


def moved(addon, ob, layer, depth):
    """Moves what is on a layer to a depth."""
    gp = addon("blender.grease_pencil")
    for handle, _ in gp.drawings(ob.data.layers[layer]).values():
        points = gp.positions(handle, int(gp.offsets(handle)[-1]))
        points[:, 1] = depth
        gp.put(handle, "position", points)


def depths(addon, ob, layer="Contours"):
    """The depths of all points of a layer."""
    gp = addon("blender.grease_pencil")
    handles = [handle for handle, _ in gp.drawings(ob.data.layers[layer]).values()]
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


@pytest.mark.usefixtures("library")
def test_lines_and_paint_lie_on_their_plane(addon, before, tmp_path):
    assert bpy.ops.rototoon.trace_drawing(frames="CURRENT") == {"FINISHED"}
    addon("scripting").fill_region(before, 1, (8.0, 8.0), (0.1, 0.2, 0.9))
    for name in ("Lines", "Paint"):
        assert depths(addon, before, name) == pytest.approx(DEPTH, abs=1e-5)
    path = str(tmp_path / "shot.json")
    bpy.ops.rototoon.export_document(filepath=path)
    for name in ("Lines", "Paint"):
        before.data.layers.remove(before.data.layers[name])
    bpy.ops.rototoon.import_document(filepath=path, into="ACTIVE")
    for name in ("Lines", "Paint"):
        assert depths(addon, before, name) == pytest.approx(DEPTH, abs=1e-5)


@pytest.mark.usefixtures("library")
def test_lines_stay_on_a_plane_of_their_own(addon, before):
    bpy.ops.rototoon.trace_drawing(frames="CURRENT")
    moved(addon, before, "Lines", 1.0)
    bpy.context.scene.frame_set(5)
    bpy.ops.rototoon.trace_drawing(frames="CURRENT")
    assert depths(addon, before, "Lines") == pytest.approx(1.0, abs=1e-5)


@pytest.mark.usefixtures("library")
def test_contours_on_no_plane_leave_lines_on_that_of_the_object(addon, before):
    gp = addon("blender.grease_pencil")
    handle = gp.drawings(shots.layer_of(before))[1][0]
    points = gp.positions(handle, int(gp.offsets(handle)[-1]))
    points[:, 1] += np.arange(len(points)) % 3
    gp.put(handle, "position", points)
    bpy.ops.rototoon.trace_drawing(frames="CURRENT")
    assert depths(addon, before, "Lines") == pytest.approx(0.0, abs=1e-5)


@pytest.mark.usefixtures("library")
@pytest.mark.parametrize("turned", [False, True])
def test_lines_and_paint_lie_on_the_plane_of_contours_on_a_moved_layer(addon, before, tmp_path, turned):
    layer = shots.layer_of(before)
    layer.translation = (0, -1, 0)
    if turned:
        layer.rotation = (0.3, 0.1, 0.2)
    bpy.context.view_layer.update()
    world = np.array(addon("blender.camera").layer_to_world(before, layer))
    gp = addon("blender.grease_pencil")
    points = np.concatenate([gp.positions(h, int(gp.offsets(h)[-1])) for h, _ in gp.drawings(layer).values()])
    points = points @ world[:3, :3].T + world[:3, 3]
    centre = points.mean(0)
    normal = np.linalg.svd(points - centre)[2][2]
    assert bpy.ops.rototoon.trace_drawing(frames="CURRENT") == {"FINISHED"}
    addon("scripting").fill_region(before, 1, (8.0, 8.0), (0.1, 0.2, 0.9))
    to_world = np.array(before.matrix_world)
    for name in ("Lines", "Paint"):
        drawn = np.concatenate([gp.positions(h, int(gp.offsets(h)[-1])) for h, _ in gp.drawings(before.data.layers[name]).values()])
        drawn = drawn @ to_world[:3, :3].T + to_world[:3, 3]
        assert (drawn - centre) @ normal == pytest.approx(0, abs=1e-4)


@pytest.mark.usefixtures("library")
def test_lines_lie_on_the_plane_of_a_layer_that_was_moved(addon, before):
    layer = before.data.layers["Contours"]
    layer.translation = (0, 0.5, 0)
    bpy.context.view_layer.update()
    bpy.ops.rototoon.trace_drawing(frames="CURRENT")
    assert depths(addon, before, "Lines") == pytest.approx(DEPTH + 0.5, abs=1e-5)

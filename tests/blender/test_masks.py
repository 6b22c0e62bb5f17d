"""Contours as Blender masks, and pictures of ids in Blender's keyer."""

import json
import os
import shutil
import subprocess
from pathlib import Path

import bpy
import numpy as np
import pytest
import shots

ROOT = Path(__file__).resolve().parents[2]


def keyed(mask, name, frame):
    """Pixels of a layer's points on a frame, as Blender has them."""
    bpy.context.scene.frame_set(frame)
    points = mask.layers[name].splines[0].points
    values = np.empty(2 * len(points), np.float32)
    points.foreach_get("co", values)
    width, height = shots.SIZE
    return (values.reshape(-1, 2) - 0.5) * max(shots.SIZE) * (1, -1) + (width / 2, height / 2)


def editors():
    return [(area.ui_type, area.spaces.active.type) for area in bpy.context.window.screen.areas]


def test_every_frame_has_the_shape_of_the_contour(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    bpy.context.scene.frame_set(4)
    before = editors()
    assert bpy.ops.rototoon.contours_to_mask() == {"FINISHED"}
    assert bpy.context.scene.frame_current == 4 and editors() == before
    mask = bpy.data.masks[ob.name]
    assert [layer.name for layer in mask.layers] == ["Part 2", "Part 1"]
    assert (mask.frame_start, mask.frame_end) == (1, 9)
    for frame in range(1, 10):
        assert np.abs(keyed(mask, "Part 1", frame) - shots.diamond(frame - 1)).max() < 2e-3
        assert np.abs(keyed(mask, "Part 2", frame) - shots.square(frame - 1)).max() < 2e-3
    spline = mask.layers["Part 1"].splines[0]
    assert spline.use_cyclic and spline.use_fill
    # Sides are straight: handles lie on them.
    point, after = spline.points[0], spline.points[1]
    handle, side = np.subtract(point.handle_right, point.co), np.subtract(after.co, point.co)
    assert abs(np.cross([*handle, 0], [*side, 0])[2]) < 1e-6


def test_a_mask_is_made_anew_and_undone(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.contours_to_mask(name="roto")
    mask = bpy.data.masks["roto"]
    assert np.abs(keyed(mask, "Part 2", 5) - shots.square(4)).max() < 2e-3  # between keys Blender blends
    shots.move(addon, ob, 9, 2, (6.0, 4.0))
    bpy.ops.ed.undo_push(message="before")
    bpy.ops.rototoon.contours_to_mask(name="roto")
    assert len(bpy.data.masks) == 1 and bpy.data.masks["roto"] == mask
    assert np.abs(keyed(mask, "Part 2", 9) - (shots.square(8) + (6.0, 4.0))).max() < 2e-3
    bpy.ops.ed.undo_push(message="mask")
    bpy.ops.ed.undo()
    assert np.abs(keyed(bpy.data.masks["roto"], "Part 2", 9) - shots.square(8)).max() < 2e-3


def test_snapped_lines_open_parts_and_lifetimes(addon, fake, tmp_path):
    shots.draw_sequence(tmp_path / "frames")
    bow = [[[20.0, 20.0], [30.0, 12.0], [40.0, 20.0]], [[40.0, 20.0], [40.0, 40.0]], [[40.0, 40.0], [20.0, 20.0]]]
    corners = [path[0] for path in bow]
    source = {
        "rototoon": 1,
        "footage": {"pattern": "frames/shot_%03d.png", "first": 1, "last": 9, "fps": 25, "width": 160, "height": 90},
        "parts": [
            {"name": "bow", "closed": True, "depth": 1, "keys": {"1": corners, "2": corners},
             "tracks": {"1": corners, "2": corners}, "curves": {"1": bow, "2": bow}},
            {"name": "line", "closed": False, "depth": 2,
             "keys": {"1": [[5.0, 6.0], [40.0, 9.5]], "9": [[7.0, 8.0], [42.0, 11.5]]}},
        ],
    }  # fmt: skip
    (tmp_path / "in.json").write_text(json.dumps(source))
    bpy.ops.rototoon.import_document(filepath=str(tmp_path / "in.json"), keep_numbers=True)
    bpy.ops.rototoon.contours_to_mask(name="roto")
    mask = bpy.data.masks["roto"]
    assert [layer.name for layer in mask.layers] == ["line", "bow"]
    assert not mask.layers["line"].splines[0].use_cyclic
    found = keyed(mask, "bow", 2)
    assert len(found) > 12 and np.abs(found - (30.0, 12.0)).max(1).min() < 2.0
    shown = []
    for frame in range(1, 10):
        bpy.context.scene.frame_set(frame)
        shown.append([mask.layers["bow"].alpha, mask.layers["line"].alpha])
    assert np.allclose(shown, [[frame <= 2, 1] for frame in range(1, 10)])
    bpy.ops.rototoon.contours_to_mask(name="roto", use_snapped=False)
    assert len(bpy.data.masks["roto"].layers["bow"].splines[0].points) == 3


def test_a_part_that_is_hidden_is_not_in_the_mask(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    ob.rototoon.active_part = 0
    bpy.ops.rototoon.match_contours()
    ob.rototoon.frame_offset += 20
    gp = addon("blender.grease_pencil")
    gp.put_frames(shots.layer_of(ob), {frame: [frame + 20] for frame in gp.frame_numbers(shots.layer_of(ob))})
    bpy.ops.rototoon.track()
    for frame in (24, 25, 28):
        bpy.context.scene.frame_set(frame)
        bpy.ops.rototoon.hide_part()
    bpy.ops.rototoon.contours_to_mask(name="roto")
    hidden, other = (bpy.data.masks["roto"].layers[part.name] for part in ob.rototoon.parts)
    shown = []
    for frame in range(21, 30):
        bpy.context.scene.frame_set(frame)
        shown.append([hidden.alpha, other.alpha])
    assert np.allclose(shown, [[frame not in (24, 25, 28), 1] for frame in range(21, 30)])


def composite(node, output, path):
    """What the compositor makes of a node's output, (H, W, 4) from the top."""
    scene, tree = bpy.context.scene, node.id_data
    if bpy.app.version >= (5, 0, 0):
        tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
        out = tree.nodes.new("NodeGroupOutput")
    else:
        out = tree.nodes.new("CompositorNodeComposite")
    tree.links.new(node.outputs[output], out.inputs[0])
    scene.render.resolution_x, scene.render.resolution_y = shots.SIZE
    scene.render.resolution_percentage = 100
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    return pixels_of(path)


def pixels_of(path):
    image = bpy.data.images.load(str(path))
    image.colorspace_settings.name = "Non-Color"
    values = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(values)
    return values.reshape(shots.SIZE[1], shots.SIZE[0], 4)[::-1]


def compositor():
    scene = bpy.context.scene
    if bpy.app.version >= (5, 0, 0):
        scene.compositing_node_group = bpy.data.node_groups.new("ids", "CompositorNodeTree")
        return scene.compositing_node_group
    scene.use_nodes = True
    scene.node_tree.nodes.clear()
    return scene.node_tree


@pytest.fixture(scope="module")
def cli():
    """The command line: the one that a variable names, else the newest that is built, else newly built."""
    if named := os.environ.get("ROTOTOON_CLI"):
        return named
    name = "rototoon.exe" if os.name == "nt" else "rototoon"
    built = [path for path in (ROOT / "target" / profile / name for profile in ("release", "debug")) if path.is_file()]
    if built:
        return str(max(built, key=lambda path: path.stat().st_mtime))
    cargo = shutil.which("cargo")
    if cargo is None:
        pytest.skip("no command line, and no cargo to build it with")
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    subprocess.run([cargo, "build", "--quiet", "-p", "rototoon-cli"], cwd=ROOT, env=environment, check=True)
    return str(ROOT / "target/debug" / name)


@pytest.mark.parametrize("part", ["near", "far"])
def test_ids_are_keyed_by_blender(addon, cli, tmp_path, part):
    shots.draw_sequence(tmp_path / "frames")
    at = {name: {"1": (shots.diamond(0) + shift).tolist()} for name, shift in (("near", 0.3), ("far", (-11.2, 5.6)))}
    source = {
        "rototoon": 1,
        "footage": {"pattern": "frames/shot_%03d.png", "first": 1, "last": 9, "fps": 25, "width": 160, "height": 90},
        "parts": [
            {"name": "near", "closed": True, "depth": 2, "keys": at["near"]},
            {"name": "far", "closed": True, "depth": 1, "keys": at["far"]},
        ],
    }
    document = tmp_path / "in.json"
    document.write_text(json.dumps(source))

    def render(name, *arguments):
        command = [cli, "render", str(document), "-o", str(tmp_path / name), "--frames", "1", *arguments]
        subprocess.run(command, check=True)
        return tmp_path / name

    ids = render("ids.exr", "--what", "ids")
    near = pixels_of(render("near.exr", "--what", "matte", "--parts", "near"))[..., 3]
    both = pixels_of(render("both.exr", "--what", "matte"))[..., 3]
    # Nearer parts hide farther ones: what the far part shows is what both cover less what the near one does.
    expected = near if part == "near" else both - near
    keyer = compositor().nodes.new("CompositorNodeCryptomatteV2")
    keyer.source = "IMAGE"
    keyer.image = bpy.data.images.load(str(ids))
    keyer.matte_id = part
    found = composite(keyer, "Matte", tmp_path / "keyed.exr")[..., 0]
    assert expected.sum() > 50 and np.abs(found - expected).max() < 1 / 255


def test_lines_that_were_fitted_or_cut_after_snapping_follow_the_control_points(addon, fake, library, tmp_path):
    """Fit Strokes and Remove Hidden Lines leave snapped lines without paths for some segments, or with guides of curves."""
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    bpy.ops.rototoon.snap()
    outlines, document, gp = addon("exchange.outlines"), addon("capture.document"), addon("blender.grease_pencil")
    reports = addon("common.reports")
    bpy.context.scene.frame_set(5)
    ob.data.layers.active = ob.data.layers["Snapped"]
    assert bpy.ops.rototoon.fit_strokes() == {"FINISHED"}
    handle = gp.drawings(ob.data.layers["Snapped"])[7][0]
    segments = gp.get(handle, gp.SEGMENT, int(gp.offsets(handle)[-1]))
    gp.put(handle, gp.SEGMENT, np.where(segments == 1, 0, segments))
    whole = document.read(ob, results=True).document
    for part in whole["parts"]:
        assert set(part["tracks"]) - set(part["curves"]) == {"5", "7"}
    found = outlines.outlines(whole, 0, True)
    assert {len(points) for points in found[1].frames.values()} == {len(found[1].frames[5])}
    assert bpy.ops.rototoon.contours_to_mask() == {"FINISHED"}
    reports.take()
    assert bpy.ops.rototoon.export_document(filepath=str(tmp_path / "out.json")) == {"FINISHED"}
    (report,) = reports.take()
    assert report.kind == "WARNING" and "fitted or cut since, on 5 and 7; Snap to Ink makes them again" in report.text
    bpy.ops.rototoon.snap()
    assert len(document.read(ob, results=True).document["parts"][0]["curves"]) == 9


def test_a_mask_that_was_made_by_hand_is_never_replaced(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    mine = bpy.data.masks.new(ob.name)
    mine.layers.new(name="garbage").splines.new()
    with pytest.raises(RuntimeError, match=r'did not make \("garbage"\): rename that mask, or choose another name in Mask'):
        bpy.ops.rototoon.contours_to_mask()
    assert [layer.name for layer in mine.layers] == ["garbage"] and len(mine.layers[0].splines) == 1
    assert bpy.ops.rototoon.contours_to_mask(name="roto") == {"FINISHED"}
    # Nor a layer that was added to one that was made here.
    bpy.data.masks["roto"].layers.new(name="holdout")
    with pytest.raises(RuntimeError, match=r'The mask "roto" has layers that Contours to Mask did not make \("holdout"\)'):
        bpy.ops.rototoon.contours_to_mask(name="roto")
    assert "holdout" in bpy.data.masks["roto"].layers

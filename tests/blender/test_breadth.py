"""What else is in artists' files: several scenes, instances, modifiers, frame steps, NLA, masks, styles, other versions, appended
objects. What is not supported is in docs/src/measurements/limits.md."""

import json
import os
import subprocess
from pathlib import Path

import bpy
import numpy as np
import pytest
import shots
from bpy_extras.object_utils import world_to_camera_view
from conftest import ROOT
from live_stage import settle
from mathutils import Matrix, Vector

VERSIONS = ["4.5.15", "5.2.3", "5.3.0"]


def truth():
    return np.stack([shots.square(k) for k in range(shots.COUNT)])


def square(addon, ob):
    """The tracked square in pixels, on all frames."""
    found = addon("scripting").tracks(ob)
    return found["Part 2" if "Part 2" in found else "square"].pixels


def tracked(addon, ob):
    """Tracks and checks the square against the keys in between."""
    assert bpy.ops.rototoon.track() == {"FINISHED"}
    assert square(addon, ob) == pytest.approx(truth(), abs=2e-3)


def test_two_scenes_with_a_capture_each(addon, fake, tmp_path):
    first = shots.two_keys(addon, tmp_path / "one")
    home = bpy.context.window.scene
    other = bpy.data.scenes.new("Second")
    bpy.context.window.scene = other
    second = shots.two_keys(addon, tmp_path / "two")
    assert second != first and other.camera != home.camera
    tracked(addon, second)
    before = shots.snapshot(second)
    assert len(shots.layer_of(first).frames) == 2
    bpy.context.window.scene = home
    tracked(addon, first)
    assert shots.snapshot(second) == before


def test_one_object_in_two_scenes_is_seen_through_the_current_one(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    # The field Camera is empty, so the current scene's camera counts.
    ob.rototoon.camera = None
    tracked(addon, ob)
    other = bpy.data.scenes.new("Second")
    other.collection.objects.link(ob)
    camera = bpy.context.scene.camera.copy()
    other.collection.objects.link(camera)
    camera.matrix_world = Matrix.Translation((0.5, 0, 0)) @ camera.matrix_world
    other.camera = camera
    other.render.resolution_x, other.render.resolution_y = shots.SIZE
    bpy.context.window.scene = other
    bpy.context.view_layer.update()
    # The same strokes, seen from half a unit further to the right: 160 pixels are 10 units.
    assert square(addon, ob) == pytest.approx(truth() - (8, 0), abs=2e-3)


def test_live_waits_for_the_scene_of_its_object(addon, fake, tmp_path):
    live = addon("capture.live")
    ob = shots.two_keys(addon, tmp_path)
    ob.rototoon.live = True
    home = bpy.context.window.scene
    bpy.context.window.scene = bpy.data.scenes.new("Second")
    try:
        assert {live.step(float("inf")) for _ in range(20)} == {live.BLOCKED}
        assert len(shots.layer_of(ob).frames) == 2
        bpy.context.window.scene = home
        settle(live)
        assert len(shots.layer_of(ob).frames) == shots.COUNT
    finally:
        live.reset()


def test_an_instanced_collection_changes_nothing(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    group = bpy.data.collections.new("Group")
    group.objects.link(ob)
    instance = bpy.data.objects.new("Instance", None)
    instance.instance_type, instance.instance_collection = "COLLECTION", group
    instance.location = (3, 0, 1)
    bpy.context.scene.collection.objects.link(instance)
    tracked(addon, ob)
    bpy.context.view_layer.objects.active = instance
    with pytest.raises(RuntimeError, match="Make a Grease Pencil object active first"):
        bpy.ops.rototoon.track()


def test_modifiers_are_not_looked_at(addon, fake, tmp_path):
    """The contours are the drawings, not what modifiers make of them."""
    ob = shots.two_keys(addon, tmp_path)
    offset = ob.modifiers.new("Offset", "GREASE_PENCIL_OFFSET")
    offset.location = (0.7, 0.0, 0.3)
    ob.modifiers.new("Subdivide", "GREASE_PENCIL_SUBDIV")
    bpy.context.view_layer.update()
    tracked(addon, ob)
    assert [part.count for part in ob.rototoon.parts] == [4, 4] and len(ob.modifiers) == 2


@pytest.mark.parametrize("aspect", [(2.0, 1.0), (1.0, 2.0)])
def test_pixel_aspect(addon, fake, tmp_path, aspect):
    """The footage is fitted into the camera's frame as the background image is, so keys stay where they were drawn."""
    render = bpy.context.scene.render
    render.pixel_aspect_x, render.pixel_aspect_y = aspect
    ob = shots.two_keys(addon, tmp_path)
    tracked(addon, ob)


@pytest.mark.parametrize("kind", ["image", "clip"])
def test_squeezed_footage_fills_the_frame_that_shows_it(addon, tmp_path, kind):
    """Pixels of two to one, in the scene and in the picture: Blender shows the picture over the whole frame."""
    ob = shots.set_up(tmp_path)
    render, entry = bpy.context.scene.render, ob.rototoon.camera.data.background_images[0]
    render.pixel_aspect_x = 2
    if kind == "image":
        entry.image.display_aspect = (2, 1)
    else:
        entry.source, entry.clip = "MOVIE_CLIP", bpy.data.movieclips.load(bpy.path.abspath(entry.image.filepath))
        entry.clip.display_aspect = (1, 0.5)
        # Blender draws backgrounds without it.
        entry.clip.tracking.camera.pixel_aspect = 1.5
    bpy.context.view_layer.update()
    width, height = shots.SIZE
    for x, y in ((0, 0), (width, height), (width, 0)):
        place = shots.mapping(addon, ob).to_layer(np.array([[x, y]], float))[0]
        seen = world_to_camera_view(bpy.context.scene, ob.rototoon.camera, ob.matrix_world @ Vector(place))
        assert (seen.x * width, (1 - seen.y) * height) == pytest.approx((x, y), abs=1e-3)


def test_frame_step_leaves_out_no_frame(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    bpy.context.scene.frame_step = 2
    tracked(addon, ob)
    assert len(shots.layer_of(ob).frames) == shots.COUNT


def test_markers_and_strips_stay(addon, fake, tmp_path):
    """An object moved by a strip of the NLA editor: the contours stay on the picture on every frame."""
    ob = shots.set_up(tmp_path)
    marker = bpy.context.scene.timeline_markers.new("cut", frame=5)
    for frame, x in ((1, 0.0), (9, 2.0)):
        ob.location.x = x
        ob.keyframe_insert("location", frame=frame)
    action = ob.animation_data.action
    strip = ob.animation_data.nla_tracks.new().strips.new("move", 1, action)
    if hasattr(strip, "action_slot") and strip.action_slot is None:
        strip.action_slot = action.slots[0]
    ob.animation_data.action = None
    scripting = addon("scripting")
    for frame in (1, 9):
        scripting.set_key(ob, frame, {"square": shots.square(frame - 1)})
    assert scripting.track(ob).contours == 7
    track = scripting.tracks(ob)["square"]
    assert track.pixels == pytest.approx(truth(), abs=2e-3)
    assert np.ptp(track.world[:, 0, 0]) == pytest.approx(64 * 10 / 160, abs=1e-3)
    gp = addon("blender.grease_pencil")
    local = [gp.positions(handle, 4)[0, 0] for handle, _ in gp.drawings(shots.layer_of(ob)).values()]
    assert np.ptp(local) == pytest.approx(4.0 - 2.0, abs=1e-3), "the strip moves the object, so the strokes move less"
    assert marker.frame == 5 and len(bpy.context.scene.timeline_markers) == 1


def test_a_gap_in_the_sequence_is_a_warning(addon, fake, tmp_path):
    shots.draw_sequence(tmp_path / "frames")
    (tmp_path / "frames/shot_006.png").unlink()
    reports = addon("common.reports")
    reports.take()
    bpy.ops.rototoon.setup(filepath=str(tmp_path / "frames/shot_001.png"))
    assert (bpy.context.object.rototoon.first, bpy.context.object.rototoon.last) == (1, 5)
    (report,) = reports.take()
    assert report.kind == "WARNING" and report.warnings == ("3 pictures beyond a gap are left out: Hold Gaps takes them in",)


def test_missing_numbers_hold_the_picture_before_them(addon, fake, tmp_path):
    shots.draw_sequence(tmp_path / "frames")
    for number in (2, 3, 6):
        (tmp_path / f"frames/shot_{number:03}.png").unlink()
    reports = addon("common.reports")
    reports.take()
    bpy.ops.rototoon.setup(filepath=str(tmp_path / "frames/shot_004.png"), hold_gaps=True)
    ob = bpy.context.object
    assert (ob.rototoon.first, ob.rototoon.last, ob.rototoon.hold_gaps) == (1, 9, True)
    (report,) = reports.take()
    assert report.warnings == ("3 frames without a file show the picture before",)
    plan, footage = addon("lines.plan"), addon("blender.footage")
    shown = footage.fields(ob, footage.pattern_of(ob))
    assert shown["gaps"] == "held"
    assert plan.held_pictures(shown, 1, 9, 0) == {2, 3, 6}
    assert plan.held_pictures({**shown, "gaps": None}, 1, 9, 0) == set()
    # A hold at the end has no file either.
    ob.rototoon.last = 12
    assert footage.pattern_of(ob)
    ob.rototoon.hold_gaps = False
    with pytest.raises(addon("blender.errors").Problem, match="No picture"):
        footage.pattern_of(ob)


def test_a_document_keeps_that_gaps_are_held(addon, fake, tmp_path):
    shots.draw_sequence(tmp_path / "frames")
    (tmp_path / "frames/shot_006.png").unlink()
    bpy.ops.rototoon.setup(filepath=str(tmp_path / "frames/shot_001.png"), hold_gaps=True)
    addon("scripting").set_key(bpy.context.object, 1, {"square": shots.square(0)})
    path = tmp_path / "project.json"
    bpy.ops.rototoon.export_document(filepath=str(path))
    document = json.loads(path.read_text())
    assert document["footage"]["gaps"] == "held"
    bpy.ops.rototoon.import_document(filepath=str(path))
    assert bpy.context.object.rototoon.hold_gaps and bpy.context.object.rototoon.extra in ("", "{}")
    document["footage"]["gaps"] = "looped"
    path.write_text(json.dumps(document))
    with pytest.raises(RuntimeError, match='footage.gaps: found "looped", expected "held"'):
        bpy.ops.rototoon.import_document(filepath=str(path))


def test_scene_rate_does_not_resample_the_pictures(addon, fake, tmp_path):
    """One picture for each frame of the scene, whatever the rates."""
    ob = shots.two_keys(addon, tmp_path)
    bpy.context.scene.render.fps = 60
    ob.rototoon.fps = 12
    tracked(addon, ob)
    assert sorted(f.frame_number for f in shots.layer_of(ob).frames) == list(range(1, 10))


def test_layers_with_masks_keep_them(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    mask = ob.data.layers.new("Mask")
    mask.frames.new(1).drawing.add_strokes([4])
    layer = ob.data.layers.active = shots.layer_of(ob)
    bpy.ops.grease_pencil.layer_mask_add(name="Mask")
    layer.use_masks = True
    assert len(layer.mask_layers) == 1
    before = shots.snapshot(ob)[0]["Mask", 1]
    tracked(addon, ob)
    assert layer.use_masks and [each.name for each in layer.mask_layers] == ["Mask"]
    assert shots.snapshot(ob)[0]["Mask", 1] == before


STYLE = {
    "vertex_color": (0.2, 0.4, 0.6, 1.0), "fill_color": (0.9, 0.1, 0.3, 1.0), "rotation": 0.5, "softness": 0.25,
    "start_cap": 1, "end_cap": 1, "fill_opacity": 0.5, "aspect_ratio": 2.0, "u_translation": 0.5, "u_scale": 2.0,
    "uv_rotation": 0.75, "uv_translation": (0.25, 0.5), "uv_scale": (2.0, 3.0),
}  # fmt: skip


@pytest.mark.parametrize("name", STYLE)
def test_styles_of_the_keys_are_on_the_tracked_strokes(addon, fake, tmp_path, name):
    ob = shots.two_keys(addon, tmp_path)
    gp = addon("blender.grease_pencil")
    handles = gp.drawings(shots.layer_of(ob))
    count = 8 if gp.TYPES[name][1] == "POINT" else 2
    for frame in (1, 9):
        gp.put(handles[frame][0], name, np.full_like(gp.blank(name, count), STYLE[name]))
    bpy.ops.rototoon.track()
    bpy.ops.rototoon.snap()
    for layer in ("Contours", "Snapped"):
        handle = gp.drawings(ob.data.layers[layer])[5][0]
        starts = gp.offsets(handle)
        count = int(starts[-1]) if gp.TYPES[name][1] == "POINT" else 2
        found = gp.get(handle, name, count)
        assert found is not None and found == pytest.approx(np.full_like(found, STYLE[name])), layer


def test_caps_are_those_that_blender_knows(addon, fake, tmp_path):
    """The attributes are Blender's own: what its stroke says is what was set."""
    ob = shots.two_keys(addon, tmp_path)
    for frame in shots.layer_of(ob).frames:
        for stroke in frame.drawing.strokes:
            stroke.start_cap, stroke.end_cap, stroke.aspect_ratio, stroke.fill_opacity = 1, 1, 2.0, 0.5
    bpy.ops.rototoon.track()
    drawing = next(f.drawing for f in shots.layer_of(ob).frames if f.frame_number == 5)
    for stroke in drawing.strokes:
        assert (stroke.start_cap, stroke.end_cap, stroke.aspect_ratio, stroke.fill_opacity) == (1, 1, 2.0, 0.5)


# -- other files ---------------------------------------------------------------------------------------------------------


def saved(addon, folder):
    """A tracked and corrected object in a file of its own."""
    ob = shots.two_keys(addon, folder)
    bpy.ops.rototoon.track()
    shots.move(addon, ob, 4, 2, (5.0, -3.0), which=[1])
    bpy.ops.rototoon.track()
    path = folder / "shot.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return ob.name, path


def goes_on(addon, ob):
    """Track knows the keys, the pin and the pictures, and gives the same again."""
    before = shots.snapshot(ob)
    assert bpy.ops.rototoon.track() == {"FINISHED"}
    state = addon("capture.sessions").known(ob).session.state
    assert list(state["parts"][1]["pins"]) == ["4"] and Path(state["footage"]["pattern"] % 1).is_file()
    assert shots.snapshot(ob) == before


@pytest.mark.parametrize("unsaved", [False, True])
def test_append(addon, fake, tmp_path, unsaved):
    name, path = saved(addon, tmp_path / "home")
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    if not unsaved:
        (tmp_path / "other").mkdir()
        bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "other/other.blend"))
    with bpy.data.libraries.load(str(path), link=False) as (_, into):
        into.objects = [name, "Camera"]
    for ob in into.objects:
        bpy.context.scene.collection.objects.link(ob)
    bpy.context.scene.camera = bpy.data.objects["Camera"]
    bpy.context.scene.render.resolution_x, bpy.context.scene.render.resolution_y = shots.SIZE
    ob = bpy.context.view_layer.objects.active = bpy.data.objects[name]
    bpy.context.view_layer.update()
    pattern = str(tmp_path / "home/frames/shot_%03d.png")
    assert ob.rototoon.pattern == (pattern if unsaved else "//../home/frames/shot_%03d.png")
    goes_on(addon, ob)


def test_link(addon, fake, tmp_path):
    """A linked object can be read and exported, not changed."""
    name, path = saved(addon, tmp_path / "home")
    wanted = addon("scripting").tracks(bpy.context.object)["Part 2"].pixels
    (tmp_path / "other").mkdir()
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "other/other.blend"))
    with bpy.data.libraries.load(str(path), link=True, relative=True) as (_, into):
        into.objects = [name, "Camera"]
    for ob in into.objects:
        bpy.context.scene.collection.objects.link(ob)
    bpy.context.scene.camera = into.objects[1]
    bpy.context.scene.render.resolution_x, bpy.context.scene.render.resolution_y = shots.SIZE
    bpy.context.view_layer.objects.active = ob = into.objects[0]
    bpy.context.view_layer.update()
    assert addon("scripting").tracks(ob)["Part 2"].pixels == pytest.approx(wanted)
    bpy.ops.rototoon.export_document(filepath=str(tmp_path / "out.json"))
    exported = json.loads((tmp_path / "out.json").read_text())
    assert exported["footage"]["pattern"] == "home/frames/shot_%03d.png" and exported["parts"][1]["pins"]
    with pytest.raises(RuntimeError, match="is linked from another file"):
        bpy.ops.rototoon.track()
    before = bpy.data.objects[name].rototoon.pattern
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "again.blend"))
    assert into.objects[0].rototoon.pattern == before


OTHER = """
import sys
sys.path.insert(0, sys.argv[1])
import conftest
import bpy
conftest.install()
bpy.ops.wm.open_mainfile(filepath=sys.argv[2])
ob = bpy.data.objects[sys.argv[3]]
found = conftest.module("scripting").tracks(ob)
for name, track in found.items():
    print("TRACK", name, track.frames.tolist(), track.pixels.round(2).tolist())
import stand_in
conftest.module("capture.sessions").make = stand_in.Session.from_document
bpy.context.view_layer.objects.active = ob
print("AGAIN", bpy.ops.rototoon.track(), conftest.module("scripting").parts(ob)[1].keys)
bpy.ops.wm.save_as_mainfile(filepath=sys.argv[2])
sys.stdout.flush()
import os
os._exit(0)
"""


@pytest.mark.parametrize("version", VERSIONS)
def test_a_file_goes_to_another_version_and_back(addon, fake, tmp_path, version):
    target = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
    python = target / f"venv-bpy-{version}/bin/python"
    if bpy.app.version_string.startswith(version):
        pytest.skip("this is that version")
    if not python.exists():
        pytest.skip(f"there is no {python}")
    name, path = saved(addon, tmp_path)
    wanted = addon("scripting").tracks(bpy.context.object)
    (tmp_path / "other.py").write_text(OTHER)
    own = {key: value for key, value in os.environ.items() if key != "BLENDER_USER_RESOURCES"}
    command = [str(python), str(tmp_path / "other.py"), str(ROOT / "tests/blender"), str(path), name]
    ended = subprocess.run(command, capture_output=True, text=True, check=False, env=own, cwd=tmp_path, timeout=600)
    assert ended.returncode == 0, ended.stdout + ended.stderr
    for part, track in wanted.items():
        assert f"TRACK {part} {track.frames.tolist()} {track.pixels.round(2).tolist()}" in ended.stdout
    assert "AGAIN {'FINISHED'} (1, 9)" in ended.stdout
    bpy.ops.wm.open_mainfile(filepath=str(path))
    ob = bpy.data.objects[name]
    for part, track in addon("scripting").tracks(ob).items():
        assert track.pixels == pytest.approx(wanted[part].pixels, abs=1e-4)
        assert track.is_key.tolist() == wanted[part].is_key.tolist()
    goes_on(addon, ob)


def test_lines_without_a_place_and_objects_without_a_size_are_told(addon, fake, tmp_path):
    """Drawings of scripts and drivers may hold them. The message says where, and nothing changes."""
    ob = shots.two_keys(addon, tmp_path)
    gp = addon("blender.grease_pencil")
    handle = gp.drawings(shots.layer_of(ob))[9][0]
    good = gp.positions(handle, 8)
    bad = good.copy()
    bad[1] = np.nan
    before = shots.snapshot(ob)
    gp.put(handle, "position", bad)
    for name in ("track", "match_contours", "new_key", "contours_to_mask"):
        with pytest.raises(RuntimeError, match='A line on frame 9 of the layer "Contours" has a point without a place'):
            bpy.ops.rototoon.__getattr__(name)()
    gp.put(handle, "position", good)
    ob.scale = (0, 1, 1)
    bpy.context.view_layer.update()
    with pytest.raises(RuntimeError, match="has a scale of 0: set the scale to 1"):
        bpy.ops.rototoon.track()
    assert shots.snapshot(ob) == before
    ob.scale = (1, 1, 1)
    bpy.context.view_layer.update()
    assert bpy.ops.rototoon.track() == {"FINISHED"}


def test_a_key_where_the_footage_has_no_picture_is_told_in_frames_of_the_scene(addon, library, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    for frame in (-3, 40, 41):
        shots.draw(addon, ob, frame, [shots.square(2)])
    before = shots.snapshot(ob)
    where = 'for the contours on the layer "Contours" on -3 and 40 and 41: delete or move them; it has frames 1 to 9'
    for name, options in (("track", {}), ("export_document", {"filepath": str(tmp_path / "out.json")})):
        with pytest.raises(RuntimeError, match=where):
            getattr(bpy.ops.rototoon, name)(**options)
    assert shots.snapshot(ob) == before and not (tmp_path / "out.json").exists()
    layer = shots.layer_of(ob)
    for frame in (-3, 40, 41):
        layer.frames.remove(frame)
    assert bpy.ops.rototoon.track() == {"FINISHED"}

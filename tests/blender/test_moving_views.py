"""What moves under a drawing without a keyframe on its object: a layer with an animated transform, and a scene whose markers change its camera."""

import json

import bpy
import numpy as np
import pytest
import shots
from mathutils import Matrix

HALF = 0.5
"""Scene units: 8 pixels, since 160 pixels are 10 units."""


def slide(ob):
    """Moves the contours' layer by half a unit from frame 1 to frame 9."""
    layer = shots.layer_of(ob)
    for frame, along in ((1, 0.0), (9, HALF)):
        layer.translation = (along, 0, 0)
        layer.keyframe_insert("translation", frame=frame)
    bpy.context.scene.frame_set(1)


def to_strip(ob):
    """Puts the animation of an object's drawings into a strip."""
    own = ob.data.animation_data
    strip = own.nla_tracks.new().strips.new("slide", 1, own.action)
    if hasattr(strip, "action_slot"):
        strip.action_slot = own.action_slot
    own.action = None
    bpy.context.scene.frame_set(1)


def other_camera(scene):
    """A second camera half a unit to the right, which the scene gets on frame 5."""
    first = scene.camera
    second = first.copy()
    scene.collection.objects.link(second)
    second.matrix_world = Matrix.Translation((HALF, 0, 0)) @ first.matrix_world
    for frame, camera in ((1, first), (5, second)):
        scene.timeline_markers.new(camera.name, frame=frame).camera = camera
    scene.frame_set(1)
    return second


def drawn_on(addon, ob, frame):
    """The pixels of the square on a frame, by a look at that frame alone."""
    bpy.context.scene.frame_set(frame)
    return shots.pixels(addon, ob, frame)[0][1]


@pytest.mark.parametrize("strip", [False, True])
def test_keys_on_a_layer_that_moves_by_itself(addon, tmp_path, strip):
    ob = shots.set_up(tmp_path)
    slide(ob)
    if strip:
        to_strip(ob)
    scripting = addon("scripting")
    scripting.set_key(ob, 1, {"square": shots.square(0)})
    scripting.set_key(ob, 9, {"square": shots.square(8)})
    assert drawn_on(addon, ob, 9) == pytest.approx(shots.square(8), abs=2e-3)
    assert drawn_on(addon, ob, 1) == pytest.approx(shots.square(0), abs=2e-3)


def test_a_layer_whose_name_has_quotes(addon, tmp_path):
    ob = shots.set_up(tmp_path)
    shots.layer_of(ob).name = ob.rototoon.contours_layer = 'My "lines"'
    slide(ob)
    assert not addon("blender.placement").Mapper(ob, [1, 9], {}, [ob.rototoon.contours_layer]).still


def test_other_animation_of_drawings_does_not_move_them(addon, tmp_path):
    ob = shots.set_up(tmp_path)
    shots.layer_of(ob).keyframe_insert("opacity", frame=1)
    assert addon("blender.placement").Mapper(ob, [1, 9], {}, [ob.rototoon.contours_layer]).still


def test_keys_where_markers_change_the_camera(addon, tmp_path):
    ob, scene = shots.set_up(tmp_path), bpy.context.scene
    ob.rototoon.camera = None
    first, second = scene.camera, other_camera(scene)
    scripting = addon("scripting")
    scripting.set_key(ob, 1, {"square": shots.square(0)})
    scripting.set_key(ob, 9, {"square": shots.square(8)})
    assert drawn_on(addon, ob, 9) == pytest.approx(shots.square(8), abs=2e-3) and scene.camera == second
    assert drawn_on(addon, ob, 1) == pytest.approx(shots.square(0), abs=2e-3) and scene.camera == first


def test_the_footages_own_camera_stays_whatever_the_markers_say(addon, tmp_path):
    ob = shots.set_up(tmp_path)
    assert ob.rototoon.camera is not None
    other_camera(bpy.context.scene)
    assert addon("blender.placement").Mapper(ob, [1, 9], {}, [ob.rototoon.contours_layer]).still


def test_hidden_lines_look_at_every_frame_where_the_view_moves(addon, tmp_path):
    ob = shots.set_up(tmp_path)
    shots.draw(addon, ob, 1, [shots.square(0)])
    frames_between = addon("strokes.hidden").frames_between
    assert frames_between(ob, 1, 9) == [1]
    slide(ob)
    assert frames_between(ob, 1, 9) == list(range(1, 10))


def test_hidden_lines_look_at_every_frame_where_a_reference_image_moves(addon, tmp_path):
    ob = shots.set_up(tmp_path, plane="REFERENCE")
    shots.draw(addon, ob, 1, [shots.square(0)])
    ob.rototoon.reference.keyframe_insert("location", frame=1)
    assert addon("strokes.hidden").frames_between(ob, 1, 9) == list(range(1, 10))


@pytest.mark.parametrize(("frame", "share"), [(3, 0.25), (-2, 0.5), (-7, 0.75), (0, 0.0)])
def test_the_scene_comes_back_to_a_moment_between_two_frames(addon, frame, share):
    scene = bpy.context.scene
    scene.frame_set(frame, subframe=share)
    moment = scene.frame_current, scene.frame_subframe
    with addon("blender.frames").kept(scene):
        scene.frame_set(10)
    assert (scene.frame_current, scene.frame_subframe) == moment
    assert scene.frame_current_final == pytest.approx(frame + share)


def test_what_is_not_keyed_yet_stays(addon, tmp_path):
    ob, scene = shots.set_up(tmp_path), bpy.context.scene
    addon("scripting").set_key(ob, 1, {"square": shots.square(0)})
    ob.keyframe_insert("location", frame=1)
    rig = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
    scene.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    rig.data.edit_bones.new('arm.L "2"').tail = (0, 0, 1)
    bpy.ops.object.mode_set(mode="OBJECT")
    bone = rig.pose.bones[0]
    rig["open"] = 0.25
    bone["grip"] = 1
    for owner, path in ((bone, "location"), (bone, "rotation_quaternion"), (bone, '["grip"]'), (rig, '["open"]'), (rig, "hide_render")):
        owner.keyframe_insert(path, frame=1)
    scene.frame_set(9)
    bone.location, bone.rotation_quaternion[1], bone["grip"], rig["open"], rig.hide_render = (1, 2, 3), 0.5, 3, 0.75, True
    bpy.context.view_layer.objects.active = ob
    assert bpy.ops.rototoon.new_key() == {"FINISHED"}
    assert tuple(bone.location) == (1, 2, 3) and tuple(bone.rotation_quaternion) == (1, 0.5, 0, 0)
    assert (bone["grip"], rig["open"], rig.hide_render, scene.frame_current) == (3, 0.75, True, 9)
    scene.frame_set(1)
    scene.frame_set(9)
    assert tuple(bone.location) == (0, 0, 0), "nothing was keyed"


def moving_camera():
    """The scene's camera goes half a unit to the right from frame 1 to frame 9."""
    camera = bpy.context.scene.camera
    before = camera.location.x
    for frame, along in ((1, 0.0), (9, HALF)):
        camera.location.x = before + along
        camera.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_set(1)


def test_a_single_key_is_tracked_through_a_moving_camera(addon, library, tmp_path):
    ob = shots.set_up(tmp_path)
    moving_camera()
    addon("scripting").set_key(ob, 1, {"square": shots.square(0)})
    assert bpy.ops.rototoon.track() == {"FINISHED"}
    found = addon("scripting").tracks(ob)["square"]
    assert list(found.frames) == list(range(1, 10))
    assert found.pixels == pytest.approx(np.stack([shots.square(k) for k in range(9)]), abs=1.5)
    assert drawn_on(addon, ob, 9) == pytest.approx(found.pixels[8], abs=2e-3)


@pytest.fixture
def steps():
    """The frames to which the scene is set."""
    found = []

    def note(scene, *_):
        found.append(scene.frame_current)

    bpy.app.handlers.frame_change_post.append(note)
    yield found
    bpy.app.handlers.frame_change_post.remove(note)


def test_a_key_looks_at_its_own_frame_and_that_of_the_key_beside_it(addon, tmp_path, steps):
    ob = shots.set_up(tmp_path)
    moving_camera()
    scripting = addon("scripting")
    for frame in (1, 5, 9):
        scripting.set_key(ob, frame, {"square": shots.square(frame - 1)})
    steps.clear()
    scripting.set_key(ob, 7, {"square": shots.square(6)})
    assert set(steps) == {1, 7}
    steps.clear()
    corners = shots.square(7)
    # One point more: it is matched to the key beside it.
    scripting.set_key(ob, 8, {"square": np.insert(corners, 1, corners[:2].mean(0), 0)})
    assert set(steps) == {1, 7, 8}
    for frame in (7, 8):
        assert drawn_on(addon, ob, frame)[0] == pytest.approx(shots.square(frame - 1)[0], abs=2e-3)


def test_make_part_draws_with_a_look_at_its_own_frame(addon, tmp_path, steps):
    ob = shots.set_up(tmp_path)
    moving_camera()
    for frame in (1, 9):
        addon("scripting").set_key(ob, frame, {"square": shots.square(frame - 1)})
    bpy.context.scene.frame_set(4)
    steps.clear()
    addon("lines.operators.make_part")._draw(ob, 4, shots.diamond(3))
    assert set(steps) == {4}
    assert drawn_on(addon, ob, 4) == pytest.approx(shots.diamond(3), abs=2e-3)


def test_corrections_of_a_document_come_in_through_a_moving_camera(addon, tmp_path):
    picked = shots.draw_sequence(tmp_path / "frames")
    keys, pins = {"1": shots.square(0).tolist()}, {"5": {"0": [50.0, 40.0]}}
    footage = {"pattern": "frames/shot_%03d.png", "first": 1, "last": 9, "fps": 24, "width": 160, "height": 90}
    (tmp_path / "given.json").write_text(json.dumps({"rototoon": 1, "footage": footage, "parts": [{"name": "square", "keys": keys, "pins": pins}]}))
    bpy.ops.rototoon.setup(filepath=str(picked))
    moving_camera()
    assert bpy.ops.rototoon.import_document(filepath=str(tmp_path / "given.json"), into="ACTIVE") == {"FINISHED"}
    assert drawn_on(addon, bpy.context.object, 5)[0] == pytest.approx([50.0, 40.0], abs=2e-3)


def following(camera, keyed=True):
    """Lets the camera follow a curve, as Blender's menu Parent › Follow Path does. Only the curve's data are animated."""
    curve = bpy.data.curves.new("Path", "CURVE")
    curve.dimensions = "3D"
    spline = curve.splines.new("POLY")
    spline.points.add(1)
    spline.points[0].co, spline.points[1].co = (0, 0, 0, 1), (3, 0, 0, 1)
    path = bpy.data.objects.new("Path", curve)
    bpy.context.scene.collection.objects.link(path)
    for ob in bpy.context.view_layer.objects:
        ob.select_set(ob in (camera, path))
    bpy.context.view_layer.objects.active = path
    bpy.ops.object.parent_set(type="FOLLOW" if keyed else "OBJECT")
    bpy.context.scene.frame_set(1)


def on_bone(layer, constrained=True):
    """Hangs a layer on a bone. It copies the place of an object that moves by half a unit, and the armature has no animation."""
    armature = bpy.data.armatures.new("Rig")
    rig, target = bpy.data.objects.new("Rig", armature), bpy.data.objects.new("Target", None)
    for ob in (rig, target):
        bpy.context.scene.collection.objects.link(ob)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    bone = armature.edit_bones.new("Bone")
    bone.head, bone.tail = (0, 0, 0), (0, 0, 1)
    bpy.ops.object.mode_set(mode="OBJECT")
    for frame, along in ((1, 0.0), (9, HALF)):
        target.location = (along, 0, 0)
        target.keyframe_insert("location", frame=frame)
    if constrained:
        rig.pose.bones["Bone"].constraints.new("COPY_LOCATION").target = target
    layer.parent, layer.parent_bone = rig, "Bone"
    bpy.context.scene.frame_set(1)


@pytest.mark.parametrize("moves", [True, False])
def test_a_camera_that_follows_a_path(addon, tmp_path, moves):
    ob = shots.set_up(tmp_path)
    following(ob.rototoon.camera, moves)
    assert addon("blender.placement").Mapper(ob, [1, 9], {}, [ob.rototoon.contours_layer]).still != moves


@pytest.mark.parametrize("moves", [True, False])
def test_a_layer_on_a_bone_with_a_constraint(addon, tmp_path, moves):
    ob = shots.set_up(tmp_path)
    on_bone(shots.layer_of(ob), moves)
    assert addon("blender.placement").Mapper(ob, [1, 9], {}, [ob.rototoon.contours_layer]).still != moves


def test_keys_are_the_same_on_whichever_frame_they_are_read(addon, tmp_path):
    ob = shots.set_up(tmp_path)
    on_bone(shots.layer_of(ob))
    scripting = addon("scripting")
    scripting.set_key(ob, 1, {"square": shots.square(0)})
    scripting.set_key(ob, 9, {"square": shots.square(8)})
    read = addon("capture.document").read
    documents = []
    for frame in (1, 9):
        bpy.context.scene.frame_set(frame)
        documents.append(read(ob).document)
    assert documents[0] == documents[1]
    assert drawn_on(addon, ob, 9) == pytest.approx(shots.square(8), abs=2e-3)


def test_a_camera_on_a_point_of_a_mesh_that_is_deformed(addon, tmp_path):
    ob = shots.set_up(tmp_path)
    mesh = bpy.data.objects.new("Mesh", bpy.data.meshes.new("Mesh"))
    bpy.context.scene.collection.objects.link(mesh)
    mesh.modifiers.new("Wave", "WAVE")
    camera, placement = ob.rototoon.camera, addon("blender.placement")
    camera.parent = mesh
    assert placement.Mapper(ob, [1, 9], {}, [ob.rototoon.contours_layer]).still
    camera.parent_type = "VERTEX"
    assert not placement.Mapper(ob, [1, 9], {}, [ob.rototoon.contours_layer]).still

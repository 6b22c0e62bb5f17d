"""Armatures: their bones told by name, their motion as clips, and bones that follow clips in the view's plane."""

import math

import bpy
import layouts
import numpy as np
import pytest
from mathutils import Euler, Matrix, Vector

RIG = {
    "hips": ("", (0, 0, 1.0), (0, 0, 1.15)),
    "spine": ("hips", (0, 0, 1.15), (0, 0.02, 1.3)),
    "chest": ("spine", (0, 0.02, 1.3), (0, 0, 1.5)),
    "neck": ("chest", (0, 0, 1.5), (0, 0, 1.6)),
    "head": ("neck", (0, 0, 1.6), (0, 0, 1.85)),
}
for _side, _way in (("L", 1), ("R", -1)):
    RIG |= {
        f"shoulder.{_side}": ("chest", (0, 0, 1.45), (0.15 * _way, 0, 1.45)),
        f"upper_arm.{_side}": (f"shoulder.{_side}", (0.18 * _way, 0, 1.45), (0.45 * _way, 0.02, 1.45)),
        f"forearm.{_side}": (f"upper_arm.{_side}", (0.45 * _way, 0.02, 1.45), (0.7 * _way, 0, 1.45)),
        f"hand.{_side}": (f"forearm.{_side}", (0.7 * _way, 0, 1.45), (0.8 * _way, 0, 1.45)),
        f"thigh.{_side}": ("hips", (0.1 * _way, 0, 1.0), (0.1 * _way, -0.02, 0.55)),
        f"shin.{_side}": (f"thigh.{_side}", (0.1 * _way, -0.02, 0.55), (0.1 * _way, 0, 0.1)),
        f"foot.{_side}": (f"shin.{_side}", (0.1 * _way, 0, 0.1), (0.1 * _way, -0.15, 0.0)),
    }


@pytest.fixture(autouse=True)
def needs_library(library):
    """All tests here."""


def armature(rig=RIG, name="Rig"):
    """An armature that stands with its arms spread, facing -Y."""
    data = bpy.data.armatures.new(name)
    ob = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(ob)
    bpy.context.view_layer.objects.active = ob
    bpy.ops.object.mode_set(mode="EDIT")
    for bone, (parent, head, tail) in rig.items():
        made = data.edit_bones.new(bone)
        made.head, made.tail = head, tail
        made.parent = data.edit_bones.get(parent)
    bpy.ops.object.mode_set(mode="OBJECT")
    return ob


def walk(addon, count=8):
    """A clip's postures (count, 17, 2) in pixels: a figure that swings its limbs and goes to the right."""
    names = addon("rototoon.style").KEY_POINTS
    made = np.zeros((count, 17, 2))
    for frame in range(count):
        phase = math.sin(2 * math.pi * frame / count)
        place = {"pelvis": np.array([100.0 + 6 * frame, 200.0 + 2 * phase])}
        hang = lambda angle, length: length * np.array([math.sin(angle), math.cos(angle)])  # noqa: E731 - 0 is down
        for point, parent, angle, length in (
            ("chest", "pelvis", math.pi - 0.2, 30), ("neck", "chest", math.pi - 0.3, 25), ("head", "neck", math.pi - 0.1, 12),
            ("head_top", "head", math.pi, 20),
            ("l_shoulder", "neck", 1.4, 5), ("l_elbow", "l_shoulder", 0.7 * phase, 22),
            ("l_wrist", "l_elbow", 0.7 * phase + 0.5, 20),
            ("r_shoulder", "neck", -1.4, 5), ("r_elbow", "r_shoulder", -0.7 * phase, 22),
            ("r_wrist", "r_elbow", 0.5 - 0.7 * phase, 20),
            ("l_hip", "pelvis", 1.5, 6), ("l_knee", "l_hip", -0.6 * phase, 40), ("l_ankle", "l_knee", -0.6 * phase - 0.3, 38),
            ("r_hip", "pelvis", -1.5, 6), ("r_knee", "r_hip", 0.6 * phase, 40), ("r_ankle", "r_knee", 0.6 * phase - 0.3, 38),
        ):  # fmt: skip
            place[point] = place[parent] + hang(angle, length)
        made[frame] = [place[name] for name in names]
    return made


def put(addon, folder, postures, character="boy", motion="walk", fps=24):
    style = addon("rototoon.style")
    entry = {"character": character, "motion": motion, "points": np.asarray(postures).tolist()}
    file = {"rototoon_clips": 1, "fps": fps, "keypoints": list(style.KEY_POINTS), "clips": [entry]}
    style.add_to_library(str(folder), file)


def angles(addon, points):
    """By driven limb the directions in the picture, y up."""
    names, limbs = addon("rototoon.style").KEY_POINTS, addon("bones.driving").LIMBS
    ends = [(names.index(a), names.index(b)) for a, b in limbs]
    along = np.stack([points[..., b, :] - points[..., a, :] for a, b in ends], -2)
    return np.arctan2(-along[..., 1], along[..., 0])


def apart(a, b):
    """Largest angle between two sets of directions."""
    return np.abs((a - b + math.pi) % (2 * math.pi) - math.pi).max()


def saved(addon, folder, character, motion="walk"):
    found = addon("rototoon.style").read_library(str(folder), character, motion).clips["clips"]
    return np.array(found[0]["points"])


@pytest.mark.parametrize(
    "names, missing",
    [
        (
            "Hips Spine Spine1 Spine2 Neck Head LeftShoulder LeftArm LeftForeArm LeftHand RightShoulder RightArm "
            "RightForeArm RightHand LeftUpLeg LeftLeg LeftFoot RightUpLeg RightLeg RightFoot",
            [],
        ),
        (
            "mixamorig:Hips mixamorig:Spine mixamorig:Spine2 mixamorig:Neck mixamorig:Head mixamorig:LeftArm "
            "mixamorig:LeftForeArm mixamorig:LeftHand mixamorig:RightArm mixamorig:RightForeArm mixamorig:RightHand "
            "mixamorig:LeftUpLeg mixamorig:LeftLeg mixamorig:LeftFoot mixamorig:RightUpLeg mixamorig:RightLeg",
            [],
        ),
        (
            "pelvis spine_01 spine_02 neck_01 head upperarm_l lowerarm_l hand_l upperarm_r lowerarm_r hand_r thigh_l calf_l "
            "foot_l thigh_r calf_r foot_r",
            [],
        ),
        ("Pelvis Chest Head L_Shoulder L_Elbow L_Wrist R_Shoulder R_Elbow L_Hip L_Knee L_Ankle R_Hip R_Knee", []),
        ("root blob tentacle.L tentacle.R", ["all"]),
    ],
)
def test_bones_are_told_by_name(addon, names, missing):
    bone_names = addon("bones.names")
    bones, parents = {}, {}
    spine = ""
    for number, name in enumerate(names.split()):
        side, word = bone_names.plain(name)
        parent = spine if not side else parents.get(side, spine)
        at = np.array([0.0, 0.0, float(number)])
        bones[name] = bone_names.Bone(parent, at, at + (0, 0, 0.5))
        if side:
            parents[side] = name
        else:
            spine = name
    table = bone_names.guess(bones)
    if missing:
        assert table == {}
        return
    assert set(table) == set(addon("rototoon.style").KEY_POINTS), set(addon("rototoon.style").KEY_POINTS) - set(table)
    assert len(set(table.values())) == len(table), "no two key points on one spot"
    assert bone_names.plain(table["l_elbow"][0])[0] == "l"


def test_a_clip_of_an_armature(addon, tmp_path):
    ob = armature()
    ob.location, ob.scale = (3, 2, 1), (2, 2, 2)
    bone = ob.pose.bones["upper_arm.L"]
    bone.rotation_mode = "XYZ"
    for frame, turn in ((1, 0.0), (11, 1.0)):
        bone.rotation_euler = Euler((0, 0, turn))
        bone.keyframe_insert("rotation_euler", frame=frame)
    scene = bpy.context.scene
    scene.frame_set(5)
    settings = {"character": "rig", "motion": "wave", "folder": str(tmp_path), "view": "FRONT"}
    assert bpy.ops.rototoon.save_clip_from_armature(**settings) == {"FINISHED"}
    assert scene.frame_current == 5
    points = saved(addon, tmp_path, "rig", "wave")
    assert points.shape == (11, 17, 2)
    names = addon("rototoon.style").KEY_POINTS
    at = lambda frame, point: points[frame, names.index(point)]  # noqa: E731
    assert np.allclose(at(0, "pelvis"), (300, -300)) and np.allclose(at(0, "head_top"), (300, -470), atol=1e-3)
    assert np.allclose(at(0, "l_wrist"), (300 + 140, -100 - 290), atol=0.1), "x right, y down, the object's size"
    scene.frame_set(8)
    bpy.context.view_layer.update()
    tail = ob.matrix_world @ ob.pose.bones["forearm.L"].tail
    assert np.allclose(at(7, "l_wrist"), (100 * tail.x, -100 * tail.z), atol=0.01)
    assert [item.motion for item in addon("style.clip_browser").browser().clips] == ["wave"]


def test_bones_follow_a_clip_and_give_it_back(addon, tmp_path):
    shelf, postures = tmp_path / "clips", walk(addon)
    put(addon, shelf, postures)
    scene = bpy.context.scene
    scene.render.fps = 24
    for view, turned in (("FRONT", 0.0), ("RIGHT", 0.0), ("FRONT", 0.7)):
        bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
        ob = armature()
        ob.matrix_world = Matrix.Translation((1, 2, 3)) @ Matrix.Rotation(turned, 4, "Y") @ Matrix.Scale(1.5, 4)
        ob.pose.bones["forearm.L"].rotation_mode = "XYZ"
        ob.pose.bones["thigh.R"].rotation_mode = "AXIS_ANGLE"
        settings = {"content": "boy", "motion": "walk", "folder": str(shelf), "view": view, "start": 10, "mirror": "off"}
        assert bpy.ops.rototoon.drive_bones(**settings) == {"FINISHED"}
        settings = {"character": "rig", "motion": "walk", "folder": str(shelf), "view": view, "first": 10, "last": 17, "replace": view != "FRONT" or turned > 0}
        assert bpy.ops.rototoon.save_clip_from_armature(**settings) == {"FINISHED"}
        found = saved(addon, shelf, "rig")
        # The spine is three bones with a bend, and its first one carries the legs: near, not the same.
        assert apart(angles(addon, found)[:, 2:], angles(addon, postures)[:, 2:]) < 2e-3, view
        assert apart(angles(addon, found)[:, :2], angles(addon, postures)[:, :2]) < 0.25, view
        # Torso for torso the pelvis goes as far; feet on the ground decide its height.
        torso = lambda p: np.linalg.norm(np.diff(p[:, :3], axis=1), axis=2).sum(1).mean()  # noqa: E731
        went = (found[-1, 0] - found[0, 0]) / torso(found)
        assert np.allclose(went[0], (postures[-1, 0, 0] - postures[0, 0, 0]) / torso(postures), rtol=0.05, atol=0.01), view


def heights(ob, frames):
    """For each frame the height of the lower ankle and the way of the hips to the front, and of both legs how far knees are in front."""
    low, knees, hips = [], [], []
    for frame in frames:
        bpy.context.scene.frame_set(frame)
        bones = ob.pose.bones
        low.append(min(bones[f"foot.{side}"].head.z for side in "LR"))
        hips.append(-bones["hips"].head.y)
        for side in "LR":
            hip, knee, ankle = bones[f"thigh.{side}"].head, bones[f"shin.{side}"].head, bones[f"foot.{side}"].head
            share = (knee.z - hip.z) / (ankle.z - hip.z)
            knees.append(-(knee.y - hip.y - share * (ankle.y - hip.y)))
    return np.array(low), np.array(knees), np.array(hips)


def test_a_rig_that_looks_to_the_other_side_gets_the_mirrored_clip_and_stands_on_the_ground(addon, tmp_path):
    # Knees in front of a figure that looks right; it squats, jumps, and lands.
    postures = walk(addon, 12)
    names = addon("rototoon.style").KEY_POINTS
    for frame, lift in enumerate((0, 0, 6, 12, 6, 0, -40, -60, -40, 0, 0, 0)):
        for hip, knee, ankle in (("l_hip", "l_knee", "l_ankle"), ("r_hip", "r_knee", "r_ankle")):
            hip, knee, ankle = (names.index(point) for point in (hip, knee, ankle))
            squat = max(lift, 0)
            postures[frame, :11, 1] = postures[frame, :11, 1] + (0 if hip > 11 else lift)
            postures[frame, hip] = (100 + 6 * frame, 200 + lift)
            postures[frame, ankle] = (100 + 6 * frame, 276 + min(lift, 0))
            postures[frame, knee] = (112 + squat + 6 * frame, 238 + lift / 2)
    put(addon, tmp_path, postures)
    scene = bpy.context.scene
    scene.render.fps, scene.frame_end = 24, 9
    ob = armature()
    drive = {"content": "boy", "motion": "walk", "folder": str(tmp_path), "view": "RIGHT", "start": 1}
    addon("scripting").take_reports()
    assert bpy.ops.rototoon.drive_bones(**drive) == {"FINISHED"}
    said = addon("scripting").take_reports()[-1].text
    assert "the rig looks left and the clip right, so the clip is mirrored" in said
    assert "the frames go on to 12, beyond the end of the scene (9)" in said
    low, knees, hips = heights(ob, range(1, 13))
    assert (knees > 0.02).all(), "knees bend to the front, where the toes point"
    assert hips[-1] > hips[0] + 0.3, "and it goes to the front"
    ground = np.array([frame not in (6, 7, 8) for frame in range(12)])
    assert np.allclose(low[ground], 0.1, atol=1e-4), low
    assert low[7] > 0.3 and (low > 0.1 - 1e-4).all(), "a jump leaves the ground"
    assert bpy.ops.rototoon.drive_bones(mirror="off", **drive) == {"FINISHED"}
    assert (heights(ob, range(1, 13))[1] < -0.02).all()
    assert "mirrored" not in addon("scripting").take_reports()[-1].text


def test_existing_keys_are_not_touched(addon, tmp_path):
    put(addon, tmp_path, walk(addon), fps=12)
    ob = armature()
    bone = ob.pose.bones["thigh.L"]
    bone.keyframe_insert("rotation_quaternion", frame=1)
    bone.keyframe_insert("location", frame=1)
    own = ob.animation_data.action
    read = lambda: [  # noqa: E731
        (curve.data_path, curve.array_index, [tuple(key.co) for key in curve.keyframe_points])
        for bag in own.layers[0].strips[0].channelbags
        for curve in bag.fcurves
    ]
    before = read()
    bpy.context.scene.render.fps = 24
    assert bpy.ops.rototoon.drive_bones(content="boy", motion="walk", folder=str(tmp_path), start=5) == {"FINISHED"}
    made = ob.animation_data.action
    assert made is not own and own.use_fake_user and read() == before
    assert tuple(made.frame_range) == (5.0, 19.0), "8 postures of 12 a second, in a scene of 24"
    assert ob.animation_data.action_slot.target_id_type == "OBJECT"
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "rig.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "rig.blend"))
    assert {made_name.name for made_name in bpy.data.actions} == {"RigAction", "Rig walk"}
    ob = bpy.data.objects["Rig"]
    bpy.context.scene.frame_set(5)
    first = ob.pose.bones["shin.L"].matrix.copy()
    bpy.context.scene.frame_set(9)
    assert (ob.pose.bones["shin.L"].matrix.translation - first.translation).length > 0.05


def test_in_another_character_s_manner(addon, tmp_path):
    style = addon("rototoon.style")
    lean = [k for k, name in enumerate(style.KEY_POINTS) if k < 11]
    plain, wave = walk(addon, 12), walk(addon, 12)[:, :, :] * (1.0, 1.0)
    wave[:, 6:8, 1] -= 25
    old = wave.copy()
    c, s = math.cos(0.5), math.sin(0.5)
    old[:, lean] = (wave[:, lean] - wave[:, :1]) @ np.array([[c, s], [-s, c]]) + wave[:, :1]
    for character, motion, points in (("boy", "walk", plain), ("boy", "wave", wave), ("old", "wave", old)):
        put(addon, tmp_path, points, character, motion)
    leans = {}
    for manner in ("", "old"):
        ob = armature(name=f"Rig {manner}")
        wanted = {"content": "boy", "motion": "walk", "style": manner, "strength": 2.0, "folder": str(tmp_path)}
        assert bpy.ops.rototoon.drive_bones(**wanted) == {"FINISHED"}
        bpy.context.scene.frame_set(4)
        up = ob.pose.bones["neck"].head - ob.pose.bones["hips"].head
        leans[manner] = math.atan2(up.x, up.z)
    assert leans["old"] > leans[""] + 0.15, leans


def test_chosen_bones_and_wrong_use(addon, tmp_path):
    put(addon, tmp_path, walk(addon))
    renamed = {f"x{k}": (p and f"x{list(RIG).index(p)}", a, b) for k, (p, a, b) in enumerate(RIG.values())}
    ob = armature(renamed)
    with pytest.raises(RuntimeError, match="no bone is known for pelvis, chest"):
        bpy.ops.rototoon.drive_bones(content="boy", motion="walk", folder=str(tmp_path))
    assert bpy.ops.rototoon.guess_bones() == {"FINISHED"}
    layouts.draw(bpy.types.ROTOTOON_PT_bones)
    told = addon("bones.names").guess(
        {name: addon("bones.names").Bone(p, np.array(a), np.array(b)) for name, (p, a, b) in RIG.items()}
    )
    for item in ob.rototoon.bones:
        name, item.along = told[item.name]
        item.bone = f"x{list(RIG).index(name)}"
    bpy.ops.rototoon.guess_bones()
    assert addon("bones.key_points").chosen(ob)["l_knee"] == (f"x{list(RIG).index('shin.L')}", 0.0)
    assert bpy.ops.rototoon.drive_bones(content="boy", motion="walk", folder=str(tmp_path)) == {"FINISHED"}
    with pytest.raises(RuntimeError, match='Found 0 clips "run" by "boy"'):
        bpy.ops.rototoon.drive_bones(content="boy", motion="run", folder=str(tmp_path))
    with pytest.raises(RuntimeError, match="No library chosen"):
        bpy.ops.rototoon.save_clip_from_armature()
    bpy.context.view_layer.objects.active = None
    assert not bpy.ops.rototoon.drive_bones.poll()


def test_seen_through_the_camera(addon, tmp_path):
    data = bpy.data.cameras.new("Camera")
    camera = bpy.data.objects.new("Camera", data)
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.scene.camera = camera
    data.type, data.ortho_scale = "ORTHO", 4.0
    direction = Vector((3, 5, -1))
    camera.matrix_world = Matrix.Translation((-6, -10, 3)) @ direction.to_track_quat("-Z", "Y").to_matrix().to_4x4()
    bpy.context.view_layer.update()
    postures = walk(addon)
    put(addon, tmp_path, postures)
    armature()
    bpy.ops.rototoon.drive_bones(content="boy", motion="walk", folder=str(tmp_path), start=1)
    bpy.ops.rototoon.save_clip_from_armature(character="rig", motion="walk", folder=str(tmp_path), first=1, last=8)
    assert apart(angles(addon, saved(addon, tmp_path, "rig"))[:, 2:], angles(addon, postures)[:, 2:]) < 2e-3


def test_undo_takes_the_keys_back(addon, tmp_path):
    put(addon, tmp_path, walk(addon))
    ob = armature()
    ob.pose.bones["head"].keyframe_insert("rotation_quaternion", frame=3)
    bpy.ops.ed.undo_push(message="before")
    bpy.ops.rototoon.guess_bones("EXEC_DEFAULT", True)
    bpy.ops.rototoon.drive_bones("EXEC_DEFAULT", True, content="boy", motion="walk", folder=str(tmp_path))
    ob = bpy.data.objects["Rig"]
    assert ob.animation_data.action.name == "Rig walk"
    bpy.ops.ed.undo()
    ob = bpy.data.objects["Rig"]
    assert ob.animation_data.action.name == "RigAction" and len(bpy.data.actions) == 1 and len(ob.rototoon.bones) == 17
    bpy.ops.ed.undo()
    assert len(bpy.data.objects["Rig"].rototoon.bones) == 0


def hips(ob, frames):
    """Where the hips are on frames, along X."""
    found = []
    for frame in frames:
        bpy.context.scene.frame_set(frame)
        found.append(ob.pose.bones["hips"].head.x)
    return found


def test_driven_again_the_motion_begins_where_it_did(addon, tmp_path):
    put(addon, tmp_path, walk(addon))
    bpy.context.scene.render.fps = 24
    ob = armature()
    foot = ob.pose.bones["foot.L"]
    for frame, turn in ((1, 0.5), (8, 1.5)):
        foot.rotation_quaternion = Euler((turn, 0, 0)).to_quaternion()
        foot.keyframe_insert("rotation_quaternion", frame=frame)
    drive = {"content": "boy", "motion": "walk", "folder": str(tmp_path), "view": "FRONT", "start": 1}
    frames = (1, 4, 8)
    bpy.context.scene.frame_set(8)
    bpy.ops.rototoon.drive_bones(**drive)
    assert bpy.context.scene.frame_current == 8
    assert foot.rotation_quaternion.to_euler().x == pytest.approx(0.5, abs=1e-5), "feet keep the pose of the start"
    first = hips(ob, frames)
    for playhead in (8, 4, 1):
        bpy.context.scene.frame_set(playhead)
        bpy.ops.rototoon.drive_bones(**drive)
        assert hips(ob, frames) == pytest.approx(first, abs=1e-5)


def test_an_action_is_not_replaced_in_tweak_mode(addon, tmp_path):
    put(addon, tmp_path, walk(addon))
    ob = armature()
    drive = {"content": "boy", "motion": "walk", "folder": str(tmp_path), "view": "FRONT"}
    bpy.ops.rototoon.drive_bones(**drive)
    data = ob.animation_data
    track = data.nla_tracks.new()
    track.strips.new("walk", 1, data.action)
    data.action = None
    track.select = True
    data.use_tweak_mode = True
    assert data.use_tweak_mode
    actions = len(bpy.data.actions)
    with pytest.raises(RuntimeError, match="in tweak mode"):
        bpy.ops.rototoon.drive_bones(**drive)
    assert len(bpy.data.actions) == actions
    data.use_tweak_mode = False
    assert bpy.ops.rototoon.drive_bones(**drive) == {"FINISHED"}


def test_a_rig_in_rest_position_makes_no_clip(addon, tmp_path):
    ob = armature()
    ob.data.pose_position = "REST"
    with pytest.raises(RuntimeError, match='"Rig" is in Rest Position'):
        bpy.ops.rototoon.save_clip_from_armature(character="rig", motion="wave", folder=str(tmp_path))


def test_a_pose_on_the_first_frame_that_is_not_keyed_yet_stays(addon, tmp_path):
    put(addon, tmp_path, walk(addon))
    ob = armature()
    foot = ob.pose.bones["foot.L"]
    foot.rotation_quaternion = Euler((0.5, 0, 0)).to_quaternion()
    foot.keyframe_insert("rotation_quaternion", frame=1)
    bpy.context.scene.frame_set(1)
    foot.rotation_quaternion = Euler((0.9, 0, 0)).to_quaternion()
    bpy.ops.rototoon.drive_bones(content="boy", motion="walk", folder=str(tmp_path), view="FRONT", start=1)
    assert foot.rotation_quaternion.to_euler().x == pytest.approx(0.9, abs=1e-5)

"""Clips, their library, translation and reshaping through the Python API."""

import copy
import json
import math

import pytest
from rototoon import Cancelled, RototoonError, style

FRAMES = 8


def ring(x, top, bottom, half):
    """Eight points: from the top right down, from the bottom left up."""
    down = [top + step * (bottom - top) / 3 for step in range(4)]
    return [[x + half, y] for y in down] + [[x - half, y] for y in reversed(down)]


def limb(start, end, part, places):
    points = [{"part": part, "at": place} for place in places]
    return {"from": start, "to": end, "start": {"points": points[:2]}, "end": {"points": points[2:]}}


def turned(points, centre, angle):
    c, s = math.cos(angle), math.sin(angle)
    return [[centre[0] + c * (x - centre[0]) - s * (y - centre[1]), centre[1] + s * (x - centre[0]) + c * (y - centre[1])] for x, y in points]


def figure(frames=1, lean=0.0, swing=0.0):
    """A body, an arm and a leg; the arm swings, the body leans about the hip."""

    def part(name, depth, points, centre, amount):
        keys = {str(f): turned(points, centre, lean + amount * math.sin(2 * math.pi * f / FRAMES)) for f in range(frames)}
        return {"name": name, "closed": True, "depth": depth, "keys": keys}

    hip = (50, 62)
    parts = [
        part("leg", 0, ring(50, 60, 100, 6), hip, -swing),
        part("body", 1, ring(50, 20, 62, 12), hip, 0.0),
        part("arm", 2, ring(64, 22, 58, 5), (64, 24), swing),
    ]
    parts[0]["keys"] = figure(frames, 0.0, swing)["parts"][0]["keys"] if lean else parts[0]["keys"]
    limbs = [
        limb("pelvis", "neck", "body", [3, 4, 0, 7]),
        limb("r_shoulder", "r_elbow", "arm", [0, 7, 1.5, 5.5]),
        limb("r_elbow", "r_wrist", "arm", [1.5, 5.5, 3, 4]),
        limb("r_hip", "r_ankle", "leg", [0, 7, 3, 4]),
    ]
    footage = {"pattern": "f_%d.png", "first": 0, "last": max(frames, 2) - 1, "fps": 12, "width": 120, "height": 120}
    return {"rototoon": 1, "footage": footage, "parts": parts, "limbs": limbs}


@pytest.fixture
def shelf(tmp_path):
    """A library: plain walks and waves, old waves and leans."""
    folder = str(tmp_path / "clips")
    for character, motion, swing, lean in (
        ("plain", "walk", 0.4, 0.0),
        ("plain", "wave", 0.8, 0.0),
        ("old", "wave", 0.6, 0.4),
    ):
        made = style.capture_clip(figure(FRAMES, lean, swing), character, motion)
        style.add_to_library(folder, made.clips, "test")
    return folder


def test_contours_become_clips():
    made = style.capture_clip(figure(FRAMES, swing=0.5), "anna", "walk", first=2, last=5)
    clip = made.clips["clips"][0]
    assert (made.first, len(clip["points"]), clip["character"]) == (2, 4, "anna")
    assert made.clips["keypoints"] == list(style.KEY_POINTS)
    assert clip["points"][0][0] == pytest.approx([50, 62], abs=1e-6)
    assert "l_elbow" in made.guessed and "r_elbow" not in made.guessed


def test_lost_contours_are_told():
    shot = figure(FRAMES, swing=0.5)
    arm = next(part for part in shot["parts"] if part["name"] == "arm")
    arm["tracks"] = {frame: arm["keys"].pop(frame) for frame in ("2", "3")}
    arm["confidence"] = {"2": [0.1] * len(arm["tracks"]["2"]), "3": [0.7] * len(arm["tracks"]["3"])}
    assert style.capture_clip(figure(FRAMES), "anna", "walk").doubts == []
    (doubt,) = style.capture_clip(shot, "anna", "walk").doubts
    assert doubt.startswith('part "arm" (r_shoulder to r_elbow, ') and doubt.endswith("): lost on 2; doubtful on 3")


def test_a_clip_tells_its_side_and_when_it_is_in_the_air():
    posture = [[0, -90], [0, -115], [0, -140], [0, -150], [0, -165]]
    posture += [[0, -135], [-12, -110], [0, -85]] * 2 + [[0, -88], [14, -44], [0, 0]] * 2
    lifted = [[[x, y - 50 * (frame in (3, 4))] for x, y in posture] for frame in range(8)]
    stance = style.stance_of({"rototoon_clips": 1, "clips": [{"character": "a", "motion": "hop", "points": lifted}]})
    assert (stance.looks, [frame for frame, up in enumerate(stance.air) if up]) == ("right", [3, 4])
    mirrored = [[[-x, y] for x, y in posture]] * 8
    stance = style.stance_of({"rototoon_clips": 1, "clips": [{"character": "a", "motion": "stand", "points": mirrored}]})
    assert (stance.looks, any(stance.air)) == ("left", False)
    with pytest.raises(RototoonError, match="clips: found 0 clips, expected one"):
        style.stance_of({"rototoon_clips": 1, "clips": []})


def test_bodies_are_told_with_their_key_points_and_chains():
    human = style.skeleton("human")
    assert (human.name, human.points, human.parents) == ("human", style.KEY_POINTS, style.PARENTS)
    assert {chain.name: chain.role for chain in human.chains}["l_leg"] == "leg"
    dog = style.skeleton("quadruped")
    assert style.Chain("tail", ("tail_base", "tail_middle", "tail_tip"), "other") in dog.chains
    assert all(dog.parents[dog.points.index(b)] == dog.points.index(a) for chain in dog.chains for a, b in zip(chain.points, chain.points[1:]))
    points = [{"name": "foot", "at": [0, 0]}, {"name": "neck", "parent": "foot", "at": [1, 0]}]
    snail = {"name": "snail", "points": points, "chains": [{"name": "torso", "points": ["foot", "neck"], "role": "torso"}]}
    assert style.skeleton(snail) == style.Skeleton("snail", ("foot", "neck"), (0, 0), (style.Chain("torso", ("foot", "neck"), "torso"),))
    with pytest.raises(RototoonError, match='skeleton: found "fish", expected one of human, quadruped, bird'):
        style.skeleton("fish")
    snail["chains"][0]["role"] = "shell"
    with pytest.raises(RototoonError, match=r'skeleton\.chains\[0\]\.role: found "shell"'):
        style.skeleton(snail)


def test_a_library_is_searched(shelf):
    found = style.read_library(shelf, motion="wave", read=False)
    assert [entry["character"] for entry in found.entries] == ["plain", "old"]
    assert found.clips is None and found.troubles == []
    assert len(style.read_library(shelf).clips["clips"]) == 3


def test_a_clip_is_found_by_its_name_and_others_come_at_its_rate(tmp_path):
    folder = str(tmp_path / "clips")
    walk = style.capture_clip(figure(FRAMES, 0.0, 0.3), "plain", "walk").clips
    for character, motion, fps in (("plain", "walk", 25), ("plainer", "walk", 24), ("plain", "sleepwalk", 24)):
        style.add_to_library(folder, walk | {"fps": fps, "clips": [walk["clips"][0] | {"character": character, "motion": motion}]})
    found = style.read_library(folder, "plain", "walk", exact=True)
    assert [entry["file"] for entry in found.entries] == ["plain-walk.clip.json"]
    assert (found.clips["fps"], found.clips["clips"]) == (25, walk["clips"])
    assert style.read_library(folder, "plain", "walk").clips["fps"] == 24, "that of most"
    led = style.read_library(folder, rate_of=("plain", "walk")).clips
    assert (led["fps"], len(led["clips"])) == (25, 3)
    assert [clip["points"] for clip in led["clips"] if clip["motion"] == "walk"][0] == walk["clips"][0]["points"]
    assert len(style.read_library(folder, "", "walk", exact=True).clips["clips"]) == 2
    none = style.read_library(folder, "plain", "run", exact=True)
    assert (none.entries, none.troubles, none.clips["clips"]) == ([], [], [])


def test_clips_of_a_library_are_replaced_on_request_only(tmp_path):
    folder = str(tmp_path / "clips")
    walk = style.capture_clip(figure(FRAMES, 0.0, 0.3), "plain", "walk").clips
    jump = {**walk, "clips": [walk["clips"][0] | {"motion": "jump"}]}
    assert style.add_to_library(folder, walk, "shot 1") == []
    with pytest.raises(RototoonError, match=r'found "walk" by "plain" already \(.*, from "shot 1"\), expected another .* or "replace"'):
        style.add_files_to_library(folder, [(jump, "shot 2"), (walk, "shot 2")])
    assert [entry["source"] for entry in style.read_library(folder, read=False).entries] == ["shot 1"], "all or none"
    assert [entry["source"] for entry in style.add_to_library(folder, walk, "shot 2", replace=True)] == ["shot 1"]
    assert style.add_files_to_library(folder, [(jump, "shot 3")], replace=True) == []
    assert [entry["source"] for entry in style.read_library(folder, read=False).entries] == ["shot 2", "shot 3"]
    with pytest.raises(RototoonError, match="not a JSON document"):
        style.add_to_library(folder, walk | {"fps": float("nan")}, replace=True)


def test_a_manner_is_given_and_a_drawing_follows(shelf):
    clips = style.read_library(shelf).clips
    seen = []
    walk = style.translate_clip(
        clips, style="old", motion="walk", content="plain", progress=lambda done, step: seen.append((done, step)) or True
    )
    clip = walk["clips"][0]
    assert (clip["character"], clip["motion"], len(clip["points"])) == ("old", "walk", FRAMES)
    assert seen[0][0] == 0 and seen[-1][0] == 1
    neck, pelvis = clip["points"][0][2], clip["points"][0][0]
    assert neck[0] - pelvis[0] > 5, "the old man leans"
    judged = style.translate_and_judge(clips, style="old", motion="walk", content="plain")
    assert judged.clips == walk and "too small to rehearse on" in judged.notes[0]
    made = style.reshape(figure(), walk)
    slow = style.reshape({**figure(), "footage": {**figure()["footage"], "fps": 24}}, walk)
    assert slow.notes[0].startswith("the clip has 12 frames a second and the document 24") and made.notes == []
    assert made.given == [] and made.document["footage"]["last"] == FRAMES - 1
    body = made.document["parts"][1]
    assert sorted(map(int, body["tracks"])) == list(range(FRAMES))
    assert all(len(points) == 8 for points in body["tracks"].values())
    again = style.capture_clip(made.document, "doll", "walk").clips["clips"][0]["points"]
    for drawn, wanted in zip(again, clip["points"]):
        angle = lambda p: math.atan2(p[2][0] - p[0][0], p[0][1] - p[2][1])  # noqa: E731
        assert angle(drawn) == pytest.approx(angle(wanted), abs=0.05)


def bird(frames):
    """A bird's body, a wing that beats, a leg."""
    drawing = figure(frames, swing=0.5)
    drawing["skeleton"] = "bird"
    drawing["limbs"] = [
        limb("pelvis", "breast", "body", [3, 4, 0, 7]),
        limb("l_shoulder", "l_elbow", "arm", [0, 7, 1.5, 5.5]),
        limb("l_elbow", "l_wing_tip", "arm", [1.5, 5.5, 3, 4]),
        limb("l_hip", "l_toes", "leg", [0, 7, 3, 4]),
    ]
    return drawing


def test_other_bodies_have_clips_of_their_own(tmp_path, shelf):
    made = style.capture_clip(bird(FRAMES), "tit", "flutter")
    clip = made.clips["clips"][0]
    assert (made.clips["rototoon_clips"], len(clip["points"][0]), "l_wrist" in made.guessed) == (2, 23, True)
    style.add_to_library(shelf, made.clips)
    found = style.read_library(shelf).clips
    bodies = {c["character"]: style.skeleton_of(found, c) for c in found["clips"]}
    assert bodies == {"plain": "human", "old": "human", "tit": "bird"}
    # Birds are left out of account where a human's manner is learned.
    walk = style.translate_clip(found, style="old", motion="walk", content="plain")
    assert style.skeleton_of(walk, walk["clips"][0]) == "human"
    moved = style.reshape(bird(1), walk, chains=[["l_arm", "l_wing"]])
    assert "tail" in moved.still and "l_wing" not in moved.still and "r_wing" in moved.still
    assert moved.document["skeleton"] == "bird"
    own = style.reshape(bird(1), made.clips)
    assert own.still == []
    with pytest.raises(RototoonError, match=r'chains: found "fin", expected a chain of "bird"'):
        style.reshape(bird(1), walk, chains=[["l_arm", "fin"]])
    with pytest.raises(RototoonError, match=r'skeleton: found "fish", expected one of human, quadruped, bird'):
        style.capture_clip(bird(1) | {"skeleton": "fish"}, "tit", "flutter")


def test_work_can_be_stopped(shelf):
    clips = style.read_library(shelf).clips
    with pytest.raises(Cancelled):
        style.translate_clip(clips, style="old", motion="walk", content="plain", progress=lambda _done, _step: False)
    with pytest.raises(Cancelled):
        style.reshape(figure(), clips, progress=lambda _done, _step: False, character="old")


def test_what_is_wrong_is_named(shelf):
    clips = style.read_library(shelf).clips
    with pytest.raises(RototoonError, match='any character, any motion: found 3 such clips, expected the names of one: "walk" by "plain", "wave" by "plain"'):
        style.reshape(figure(), clips)
    with pytest.raises(RototoonError, match='character "plain", motion "wavy": found no such clip among 3, expected one; there are "wave" by "plain", '):
        style.reshape(figure(), clips, character="plain", motion="wavy")
    with pytest.raises(RototoonError, match="limbs: found none"):
        style.capture_clip({**figure(), "limbs": []}, "anna", "walk")
    off = copy.deepcopy(figure())
    off["limbs"][1]["end"]["points"][0] = {"part": "arm", "drawn": {"0": [300, 300]}}
    with pytest.raises(RototoonError, match=r"limbs\[1\] \(r_shoulder to r_elbow\).end.points\[0\].drawn, frame 0: found a point"):
        style.capture_clip(off, "anna", "walk")
    with pytest.raises(RototoonError, match="preset: found \"best\", expected one of rototoon"):
        style.translate_clip(clips, style="old", motion="walk", content="plain", preset="best")
    with pytest.raises(RototoonError, match="unknown field"):
        style.reshape(figure(), clips, colour="red")
    broken = json.loads(json.dumps(clips))
    broken["clips"][0]["points"][1].pop()
    with pytest.raises(RototoonError, match="frame 1: found 16 key points, expected 17"):
        style.translate_clip(broken, style="old", motion="walk", content="plain")

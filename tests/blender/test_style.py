"""Limbs drawn in Blender, clips in a library, and a drawing that follows them, with the native library in the extension."""

import json
import math
import shutil

import bpy
import numpy as np
import pytest
import shots

SIZE = shots.SIZE


@pytest.fixture(autouse=True)
def needs_library(library):
    """All tests here."""


def ring(x, top, bottom, half):
    """Eight points: from the top right down, from the bottom left up."""
    down = np.linspace(top, bottom, 4)
    return np.array([[x + half, y] for y in down] + [[x - half, y] for y in down[::-1]])


def turned(points, centre, angle):
    c, s = math.cos(angle), math.sin(angle)
    return (np.asarray(points) - centre) @ np.array([[c, s], [-s, c]]) + centre


def figure(swing=0.0, lean=0.0):
    """Contours of a leg, a body and an arm in a picture of 160 × 90 pixels."""
    return [
        turned(ring(60, 48, 80, 5), (60, 50), -swing),
        turned(ring(60, 16, 52, 10), (60, 50), lean),
        turned(turned(ring(72, 18, 46, 4), (72, 20), swing), (60, 50), lean),
    ]


LINES = {
    "pelvis": (1, 3.0, 4.0),
    "neck": (1, 0.0, 7.0),
    "r_shoulder": (2, 0.0, 7.0),
    "r_elbow": (2, 1.5, 5.5),
    "r_wrist": (2, 3.0, 4.0),
    "r_hip": (0, 0.0, 7.0),
    "r_ankle": (0, 3.0, 4.0),
    "r_knee": (0, 1.5, 5.5),
}
"""Key points with their part and the two places of its contour that the line joins."""


def performer(addon, folder, swing=0.6, lean=0.0):
    """A figure keyed on every other picture; its contours swing and lean."""
    ob = shots.set_up(folder)
    for frame in range(1, shots.COUNT + 1):
        moment = math.sin(2 * math.pi * (frame - 1) / (shots.COUNT - 1))
        shots.draw(addon, ob, frame, figure(swing * moment, lean + 0.1 * moment))
        bpy.context.scene.frame_set(frame)
        bpy.ops.rototoon.match_contours()
    bpy.context.scene.frame_set(1)
    shots.limb_lines(addon, ob, figure(0.0, lean), LINES)
    return ob


def test_lines_across_limbs_make_limbs(addon, tmp_path):
    ob = performer(addon, tmp_path)
    made = addon("style.limbs").defined(ob)
    assert [(limb["from"], limb["to"]) for limb in made] == [
        ("pelvis", "neck"),
        ("neck", "r_shoulder"),
        ("r_shoulder", "r_elbow"),
        ("r_elbow", "r_wrist"),
        ("pelvis", "r_hip"),
        ("r_hip", "r_knee"),
        ("r_knee", "r_ankle"),
    ]
    names = {part.name for part in ob.rototoon.parts}
    assert {point["part"] for limb in made for end in ("start", "end") for point in limb[end]["points"]} <= names
    path = tmp_path / "out.json"
    bpy.ops.rototoon.export_document(filepath=str(path))
    assert json.loads(path.read_text())["limbs"] == made


def second_drawing(addon, tmp_path, shelf, contours=None):
    """A drawing on one frame with limbs, in a folder of its own. It has the library `shelf`."""
    folder = tmp_path / "doll"
    folder.mkdir()
    ob = shots.set_up(folder)
    contours = figure() if contours is None else contours
    shots.draw(addon, ob, 1, contours)
    shots.limb_lines(addon, ob, contours, LINES)
    ob.rototoon.clips_folder = shelf
    return ob


def test_capture_clip_style_reshape(addon, tmp_path):
    shelf = str(tmp_path / "clips")
    for character, motion, swing, lean in (
        ("plain", "walk", 0.6, 0.0),
        ("plain", "wave", 1.0, 0.0),
        ("old", "wave", 0.8, 0.4),
    ):
        folder = tmp_path / f"{character} {motion}"
        folder.mkdir()
        ob = performer(addon, folder, swing, lean)
        assert bpy.ops.rototoon.save_clip(character=character, motion=motion, folder=shelf) == {"FINISHED"}
    # A little larger.
    ob = second_drawing(addon, tmp_path, shelf, [(contour - (60, 80)) * 1.05 + (80, 82) for contour in figure()])
    before = dict(shots.pixels(addon, ob, 1))
    names = [part.name for part in ob.rototoon.parts]
    bpy.ops.rototoon.depth_mark(front=names[0], behind=names[1])
    bpy.ops.rototoon.depth_mark(front=names[1], behind=names[2])
    assert bpy.ops.rototoon.reshape_drawing(character="plain", motion="walk") == {"FINISHED"}
    frames = sorted(frame.frame_number for frame in shots.layer_of(ob).frames)
    assert frames == list(range(1, shots.COUNT + 2))
    kinds = {frame.frame_number: frame.keyframe_type for frame in shots.layer_of(ob).frames}
    assert kinds[1] != "GENERATED" and kinds[2] == "GENERATED"
    assert all(np.array_equal(points, before[number]) for number, points in shots.pixels(addon, ob, 1))
    orders = {tuple(number for number, _ in shots.pixels(addon, ob, frame)) for frame in frames[1:]}
    assert orders == {(3, 2, 1)}, "the marks turn the drawing's order round"
    wrist = lambda frame: dict(shots.pixels(addon, ob, frame))[3][[3, 4]].mean(0)  # noqa: E731
    swung = [wrist(frame) for frame in range(2, shots.COUNT + 2)]
    assert np.ptp([point[0] for point in swung]) > 15

    lean = lambda frame: math.atan2(*(_axis(addon, ob, frame) * (1, -1)))  # noqa: E731
    upright = np.mean([lean(frame) for frame in range(2, shots.COUNT + 2)])
    apply = {"motion": "walk", "content": "plain", "style": "old", "strength": 2.0}
    scripting = addon("scripting")
    bpy.context.scene.frame_end = shots.COUNT + 1
    scripting.take_reports()
    assert bpy.ops.rototoon.apply_motion(**apply) == {"FINISHED"}
    report = scripting.take_reports()[-1]
    assert report.kind == "WARNING" and "the library is too small to rehearse on" in report.text, report
    assert "beyond the end" not in report.text
    bent = np.mean([lean(frame) for frame in range(2, shots.COUNT + 2)])
    assert bent > upright + 0.1, (upright, bent)
    bpy.context.scene.frame_end = shots.COUNT
    assert bpy.ops.rototoon.apply_motion(**{**apply, "strength": 0.0}) == {"FINISHED"}
    said = scripting.take_reports()[-1].text
    assert "with a strength of 0 the result is the content's own motion" in said
    assert f"the frames go on to {shots.COUNT + 1}, beyond the end of the scene ({shots.COUNT})" in said
    assert abs(np.mean([lean(frame) for frame in range(2, shots.COUNT + 2)]) - upright) < 0.02
    bpy.ops.rototoon.clear_generated()
    assert [frame.frame_number for frame in shots.layer_of(ob).frames] == [1]


def _axis(addon, ob, frame):
    """From the foot of the body to its top."""
    body = dict(shots.pixels(addon, ob, frame))[2]
    return body[[0, 7]].mean(0) - body[[3, 4]].mean(0)


def test_stopped_and_wrong_use_change_nothing(addon, tmp_path):
    ob = performer(addon, tmp_path)
    shelf = str(tmp_path / "clips")
    with pytest.raises(RuntimeError, match="No library chosen"):
        bpy.ops.rototoon.save_clip(character="plain", motion="walk")
    assert bpy.ops.rototoon.save_clip(character="plain", motion="walk", folder=shelf) == {"FINISHED"}
    with pytest.raises(RuntimeError, match="has a key after the drawing"):
        bpy.ops.rototoon.reshape_drawing(character="plain", motion="walk", folder=shelf)
    folder = tmp_path / "doll"
    folder.mkdir()
    ob = shots.set_up(folder)
    shots.draw(addon, ob, 1, figure())
    with pytest.raises(RuntimeError, match="has no limbs"):
        bpy.ops.rototoon.reshape_drawing(character="plain", motion="walk", folder=shelf)
    shots.limb_lines(addon, ob, figure(), LINES)
    before = shots.snapshot(ob)
    with pytest.raises(RuntimeError, match="has no clips"):
        bpy.ops.rototoon.apply_motion(motion="walk", content="plain", style="old", folder=str(tmp_path / "none"))
    with pytest.raises(RuntimeError, match='found "nobody"'):
        bpy.ops.rototoon.apply_motion(motion="walk", content="plain", style="nobody", folder=shelf)
    jobs = addon("common.jobs")
    start = jobs.Worker.start
    try:
        jobs.Worker.start = lambda self: (self.cancel(), start(self))
        assert bpy.ops.rototoon.reshape_drawing(character="plain", motion="walk", folder=shelf) == {"CANCELLED"}
    finally:
        jobs.Worker.start = start
    assert shots.snapshot(ob) == before


def test_clips_of_other_bodies_are_used_where_they_can_be(addon, tmp_path):
    performer(addon, tmp_path)
    shelf = tmp_path / "clips"
    assert bpy.ops.rototoon.save_clip(character="plain", motion="walk", folder=str(shelf)) == {"FINISHED"}
    clips = {"rototoon_clips": 2, "skeleton": "bird", "clips": [{"character": "tit", "motion": "fly", "points": [[[0, 0]] * 23]}]}
    (shelf / "tit-fly.clip.json").write_text(json.dumps(clips))
    found = addon("style.clip_library").read(str(shelf))
    assert [(row.character, row.body.name, row.human, row.trouble) for row in found.rows] == [
        ("plain", "human", True, ""),
        ("tit", "bird", False, ""),
    ]
    assert found.characters() == ["plain", "tit"] and found.troubles == []
    assert found.characters(human=True) == ["plain"] and found.motions(human=True) == ["walk"]


def test_save_clip_names_lost_and_doubtful_contours(addon, tmp_path, monkeypatch):
    performer(addon, tmp_path)
    module, scripting = addon("style.operators.save_clip"), addon("scripting")
    read = module.document.read

    def doubtful(ob, **how):
        reading = read(ob, **how)
        arm = reading.document["parts"][2]
        arm["tracks"] = {frame: arm["keys"].pop(frame) for frame in list(arm["keys"])[2:5]}
        arm["confidence"] = {frame: [share] * 8 for frame, share in zip(arm["tracks"], (0.2, 0.6, 0.9))}
        return reading

    monkeypatch.setattr(module.document, "read", doubtful)
    scripting.take_reports()
    assert bpy.ops.rototoon.save_clip(character="me", motion="walk", folder=str(tmp_path / "clips")) == {"FINISHED"}
    report = scripting.take_reports()[-1]
    assert report.kind == "WARNING", report
    assert "the clip has what lost and doubtful contours show: part " in report.text
    assert 'part "Part 3" (neck to r_shoulder, r_shoulder to r_elbow, r_elbow to r_wrist): lost on 3; doubtful on 4' in report.text, report.text


def test_marks_are_kept_with_the_document(addon, tmp_path):
    ob = shots.set_up(tmp_path)
    shots.draw(addon, ob, 1, figure())
    shots.limb_line(addon, ob, figure(), LINES["pelvis"], "pelvis")
    names = [part.name for part in ob.rototoon.parts]
    assert bpy.ops.rototoon.depth_mark(front=names[2], behind=names[1]) == {"FINISHED"}
    assert bpy.ops.rototoon.depth_mark(front=names[1], behind=names[2]) == {"FINISHED"}
    assert addon("style.limbs").marks(ob) == [{"front": names[1], "behind": names[2]}]
    with pytest.raises(RuntimeError, match='No part "hat"; the object has'):
        bpy.ops.rototoon.depth_mark(front="hat", behind=names[1])


def test_a_clip_of_the_same_name_is_only_replaced_on_request(addon, tmp_path):
    shelf, scripting = tmp_path / "clips", addon("scripting")
    performer(addon, tmp_path)
    save = {"character": "me", "motion": "walk", "folder": str(shelf)}
    assert bpy.ops.rototoon.save_clip(**save) == {"FINISHED"}
    before = {path.name: path.read_bytes() for path in shelf.iterdir()}
    other = tmp_path / "other"
    other.mkdir()
    performer(addon, other, 0.3)
    with pytest.raises(RuntimeError, match=r'found "walk" by "me" already \(me-walk.clip.json, 9 frames\), expected another .* or "replace"'):
        bpy.ops.rototoon.save_clip(**save)
    assert {path.name: path.read_bytes() for path in shelf.iterdir()} == before
    scripting.take_reports()
    assert bpy.ops.rototoon.save_clip(**save, replace=True) == {"FINISHED"}
    assert scripting.take_reports()[-1].text.endswith("; replaced 1 clip of the same character and motion")
    assert (shelf / "me-walk.clip.json").read_bytes() != before["me-walk.clip.json"]
    assert not bpy.context.window_manager.operator_properties_last("rototoon.save_clip").replace, "it is asked for each time"


def test_a_reshaped_drawing_on_one_picture_is_exported_with_all_its_frames(addon, tmp_path):
    shelf = str(tmp_path / "clips")
    performer(addon, tmp_path)
    bpy.ops.rototoon.save_clip(character="plain", motion="walk", folder=shelf)
    picked = shots.draw_sequence(tmp_path / "doll", count=1)
    bpy.ops.rototoon.setup(filepath=str(picked))
    bpy.context.view_layer.update()
    ob = bpy.context.object
    shots.draw(addon, ob, 1, figure())
    shots.limb_lines(addon, ob, figure(), LINES)
    assert bpy.ops.rototoon.reshape_drawing(character="plain", motion="walk", folder=shelf) == {"FINISHED"}
    path = tmp_path / "doll.json"
    assert bpy.ops.rototoon.export_document(filepath=str(path)) == {"FINISHED"}
    written = json.loads(path.read_text())
    last = max(int(frame) for frame in written["parts"][0]["tracks"])
    assert last > 1 and written["footage"]["last"] == last and written["footage"]["gaps"] == "held"
    assert ob.rototoon.last == 1, "the footage of the object is what it was"


def test_reshaping_again_leaves_corrected_contours(addon, tmp_path):
    shelf, scripting = str(tmp_path / "clips"), addon("scripting")
    for motion, swing in (("walk", 0.6), ("wave", 1.0)):
        folder = tmp_path / motion
        folder.mkdir()
        performer(addon, folder, swing)
        bpy.ops.rototoon.save_clip(character="plain", motion=motion, folder=shelf)
    ob = second_drawing(addon, tmp_path, shelf)
    bpy.ops.rototoon.reshape_drawing(character="plain", motion="walk")
    shots.move(addon, ob, 5, 3, (6.0, -3.0), which=[3])
    mine, others = dict(shots.pixels(addon, ob, 5)), dict(shots.pixels(addon, ob, 4))
    scripting.take_reports()
    for motion in ("walk", "wave"):
        bpy.ops.rototoon.reshape_drawing(character="plain", motion=motion)
        report = scripting.take_reports()[-1]
        assert report.kind == "WARNING" and 'your corrections stay: "Part 3" on 5; Release Pins' in report.text
        assert np.array_equal(dict(shots.pixels(addon, ob, 5))[3], mine[3])
    assert np.abs(dict(shots.pixels(addon, ob, 4))[3] - others[3]).max() > 1, "other frames follow the other clip"
    bpy.ops.rototoon.release_pins(which="ALL")
    bpy.ops.rototoon.reshape_drawing(character="plain", motion="walk")
    assert np.abs(dict(shots.pixels(addon, ob, 5))[3] - mine[3]).max() > 1
    assert "corrections" not in scripting.take_reports()[-1].text


def test_a_hidden_part_has_no_contour_in_a_motion(addon, tmp_path):
    shelf, scripting = str(tmp_path / "clips"), addon("scripting")
    performer(addon, tmp_path)
    bpy.ops.rototoon.save_clip(character="plain", motion="walk", folder=shelf)
    ob = second_drawing(addon, tmp_path, shelf)
    bpy.ops.rototoon.reshape_drawing(character="plain", motion="walk")
    frames = sorted(addon("capture.contours").read(ob).part(3).made)
    hidden = frames[2:4]
    for frame in hidden:
        bpy.context.scene.frame_set(frame)
        ob.rototoon.active_part = 2
        assert bpy.ops.rototoon.hide_part() == {"FINISHED"}
    bpy.context.scene.frame_set(1)
    scripting.take_reports()
    assert bpy.ops.rototoon.reshape_drawing(character="plain", motion="walk") == {"FINISHED"}
    found = addon("capture.contours").read(ob)
    assert sorted(found.part(3).made) == [frame for frame in frames if frame not in hidden]
    assert sorted(found.part(2).made) == frames
    report = scripting.take_reports()[-1]
    assert report.kind == "WARNING" and f'no contour: "Part 3" on {hidden[0]} and {hidden[1]}; Part Is Hidden' in report.text, report
    assert "own motion" not in report.text


def test_a_clip_that_is_not_there_is_named_with_those_that_are(addon, tmp_path):
    shelf = str(tmp_path / "clips")
    performer(addon, tmp_path)
    bpy.ops.rototoon.save_clip(character="plain", motion="walk", folder=shelf)
    second_drawing(addon, tmp_path, shelf)
    for character, motion, text in (
        ("old", "walk", 'has no clip "walk" by "old"; "plain" has it: choose one of its 1 clip'),
        ("plain", "run", 'has no clip "run" by "plain"; "plain" has "walk"'),
        ("old", "run", 'has no clip "run" by "old": choose one'),
    ):
        with pytest.raises(RuntimeError, match=text):
            bpy.ops.rototoon.reshape_drawing(character=character, motion=motion, folder=shelf)


def test_a_clip_moves_a_drawing_at_its_own_rate_whatever_the_library_has(addon, tmp_path):
    shelf, only = tmp_path / "clips", tmp_path / "only"
    style = addon("rototoon.style")
    bpy.context.scene.render.fps = 25
    performer(addon, tmp_path)
    bpy.ops.rototoon.save_clip(character="anna", motion="walk", folder=str(only))
    bpy.ops.rototoon.save_clip(character="anna", motion="walk", folder=str(shelf))
    clip = style.read_library(str(only)).clips
    for character, motion in (("bert", "walk"), ("bert", "run"), ("carl", "walk")):
        style.add_to_library(str(shelf), clip | {"fps": 24, "clips": [clip["clips"][0] | {"character": character, "motion": motion}]})
    ob = second_drawing(addon, tmp_path, str(only))

    def moved(folder):
        assert bpy.ops.rototoon.reshape_drawing(character="anna", motion="walk", folder=str(folder)) == {"FINISHED"}
        frames = sorted(frame.frame_number for frame in shots.layer_of(ob).frames)
        return [np.concatenate([points for _, points in shots.pixels(addon, ob, frame)]) for frame in frames]

    alone, among_others = moved(only), moved(shelf)
    assert len(alone) == len(among_others)
    assert all(np.array_equal(a, b) for a, b in zip(alone, among_others))


def test_a_clip_file_copied_over_another_stops_only_the_clip_that_is_gone(addon, tmp_path):
    shelf = tmp_path / "clips"
    performer(addon, tmp_path)
    for character in ("anna", "bert"):
        for motion in ("walk", "run"):
            bpy.ops.rototoon.save_clip(character=character, motion=motion, folder=str(shelf))
    second_drawing(addon, tmp_path, str(shelf))
    shutil.copy(shelf / "anna-walk.clip.json", shelf / "anna-run.clip.json")
    rows = addon("style.clip_library").read(str(shelf)).rows
    said = 'anna-run.clip.json: found a second clip of character "anna" and motion "walk"; the clip in anna-walk.clip.json is used'
    assert [(row.character, row.motion) for row in rows] == [("anna", "walk"), ("bert", "run"), ("bert", "walk"), ("anna-run", "")]
    assert [row.trouble != "" for row in rows] == [False, False, False, True] and rows[3].trouble.endswith(said)
    for character, motion in (("anna", "walk"), ("bert", "run")):
        assert bpy.ops.rototoon.reshape_drawing(character=character, motion=motion) == {"FINISHED"}
    with pytest.raises(RuntimeError, match='has no clip "run" by "anna"; "anna" has "walk"'):
        bpy.ops.rototoon.reshape_drawing(character="anna", motion="run")
    (shelf / "bert-run.clip.json").write_text("{")
    with pytest.raises(RuntimeError, match="bert-run.clip.json: found text that is not JSON"):
        bpy.ops.rototoon.reshape_drawing(character="bert", motion="run")

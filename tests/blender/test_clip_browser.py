"""The browser of skeleton clips: what it lists, filters, draws and plays, with damaged files among the others."""

from types import SimpleNamespace

import bpy
import layouts
import numpy as np
import pytest
import shots

REST = {
    "pelvis": (0, 0), "chest": (0, -25), "neck": (0, -50), "head": (0, -60), "head_top": (0, -80),
    "l_shoulder": (8, -48), "l_elbow": (10, -24), "l_wrist": (11, 0), "r_shoulder": (-8, -48), "r_elbow": (-10, -24),
    "r_wrist": (-11, 0), "l_hip": (6, 2), "l_knee": (7, 40), "l_ankle": (8, 78), "r_hip": (-6, 2), "r_knee": (-7, 40),
    "r_ankle": (-8, 78),
}  # fmt: skip


@pytest.fixture(autouse=True)
def needs_library(library):
    """All tests here."""


def postures(addon, count=12, swing=20.0):
    """Arms that swing: (count, 17, 2)."""
    names = addon("rototoon.style").KEY_POINTS
    rest = np.array([REST[name] for name in names], float)
    made = np.tile(rest, (count, 1, 1))
    for frame in range(count):
        for name, way in (("l_wrist", 1), ("r_wrist", -1)):
            made[frame, names.index(name), 0] += way * swing * np.sin(2 * np.pi * frame / count)
    return made


def fill(addon, folder, *clips):
    """Puts clips of (character, motion) into a library."""
    style = addon("rototoon.style")
    for number, (character, motion) in enumerate(clips):
        points = postures(addon, 12, 10.0 + 5 * number).tolist()
        entry = {"character": character, "motion": motion, "points": points}
        file = {"rototoon_clips": 1, "fps": 12, "keypoints": list(style.KEY_POINTS), "clips": [entry]}
        style.add_to_library(str(folder), file, "shot.blend")


def shelf(addon, tmp_path):
    folder = tmp_path / "clips"
    fill(addon, folder, ("anna", "walk"), ("bert", "walk"), ("anna", "jump"))
    return folder


def test_clips_are_listed_and_filtered(addon, tmp_path):
    folder = shelf(addon, tmp_path)
    ob = shots.set_up(tmp_path)
    ob.rototoon.clips_folder = str(folder)
    browser = addon("style.clip_browser").browser()
    listed = [(item.character, item.motion, item.frames) for item in browser.clips]
    assert listed == [("anna", "jump", 12), ("anna", "walk", 12), ("bert", "walk", 12)]
    row = SimpleNamespace(bitflag_filter_item=1 << 30)
    filtered = bpy.types.ROTOTOON_UL_clips.filter_items
    shown = lambda: [bool(flag) for flag in filtered(row, bpy.context, browser, "clips")[0]]  # noqa: E731
    browser.motion = "WALK"
    assert shown() == [False, True, True]
    browser.character = "ann"
    assert shown() == [False, True, False]
    fill(addon, folder, ("zoe", "sit"))
    browser.active = 2
    assert bpy.ops.rototoon.refresh_clips() == {"FINISHED"}
    assert len(browser.clips) == 4 and browser.clips[browser.active].character == "bert"


def test_labels_are_offered(addon, tmp_path):
    ob = shots.set_up(tmp_path)
    ob.rototoon.clips_folder = str(shelf(addon, tmp_path))
    clip_browser = addon("style.clip_browser")
    assert clip_browser.motions() == ["jump", "walk"] and clip_browser.motions("bert") == ["walk"]
    assert clip_browser.characters("jump") == ["anna"]
    assert clip_browser.offered(clip_browser.characters(), "E") == ["bert"]


def test_damaged_files_are_listed_as_such(addon, tmp_path):
    folder = shelf(addon, tmp_path)
    damaged = next(file for file in folder.iterdir() if "bert" in file.name)
    damaged.write_text('{"rototoon_clips": 1, "clips": [')
    (folder / "stray.clip.json").write_text("no clip at all")
    ob = shots.set_up(tmp_path)
    ob.rototoon.clips_folder = str(folder)
    clip_browser = addon("style.clip_browser")
    browser = clip_browser.browser()
    assert [(item.character, bool(item.trouble)) for item in browser.clips] == [
        ("anna", False),
        ("anna", False),
        ("bert", True),
        ("stray", True),
    ]
    assert damaged.name in browser.clips[2].trouble
    browser.active = 2
    assert clip_browser.chosen() is None and clip_browser.characters() == ["anna"]
    said = layouts.labels(layouts.draw(bpy.types.ROTOTOON_PT_style))
    assert any("JSON" in text for text in said), said
    (folder / "library.json").write_text("damaged as well")
    bpy.ops.rototoon.refresh_clips()
    assert sum(not item.trouble for item in browser.clips) == 2
    assert any("not an index" in trouble for trouble in clip_browser.shelf().troubles)


def test_the_panel_hands_on_the_chosen_clip(addon, tmp_path):
    ob = shots.set_up(tmp_path)
    layouts.draw(bpy.types.ROTOTOON_PT_style)
    ob.rototoon.clips_folder = str(shelf(addon, tmp_path))
    addon("style.clip_browser").browser().active = 1
    said = layouts.draw(bpy.types.ROTOTOON_PT_style)
    made = {entry[1]: entry[2] for entry in said if entry[0] == "operator"}
    assert vars(made["rototoon.reshape_drawing"]) == {"character": "anna", "motion": "walk"}
    assert vars(made["rototoon.apply_motion"]) == {"content": "anna", "motion": "walk"}
    assert ("list", "ROTOTOON_UL_clips") in said and any(entry[0] == "icon" for entry in said)
    assert "bert" in layouts.labels(said)
    for panel in (p for p in dir(bpy.types) if p.startswith("ROTOTOON_PT_")):
        kind = getattr(bpy.types, panel)
        if not hasattr(kind, "poll") or kind.poll(bpy.context):
            layouts.draw(kind)


def test_a_library_that_is_not_there_or_unsaved(addon, tmp_path):
    ob = shots.set_up(tmp_path)
    ob.rototoon.clips_folder = str(tmp_path / "nowhere")
    assert len(addon("style.clip_browser").browser().clips) == 0
    layouts.draw(bpy.types.ROTOTOON_PT_style)
    ob.rototoon.clips_folder = "//clips"
    with pytest.raises(RuntimeError, match="not saved"):
        bpy.ops.rototoon.refresh_clips()
    layouts.draw(bpy.types.ROTOTOON_PT_style)


def test_the_preferences_name_a_library(addon, tmp_path):
    shots.set_up(tmp_path)
    preferences = addon("blender.preferences").preferences()
    preferences.clips_folder = str(shelf(addon, tmp_path))
    try:
        assert bpy.ops.rototoon.refresh_clips() == {"FINISHED"}
        assert len(addon("style.clip_browser").browser().clips) == 3
    finally:
        preferences.clips_folder = ""


def test_the_figure_plays_with_the_scene(addon, tmp_path):
    ob = shots.set_up(tmp_path)
    ob.rototoon.clips_folder = str(shelf(addon, tmp_path))
    clip_preview, clip_browser = addon("ui.clip_preview"), addon("style.clip_browser")
    row = clip_browser.chosen()
    scene = bpy.context.scene
    scene.render.fps, scene.frame_start = 24, 1
    moments = []
    for frame in (1, 2, 3, 25, 0):
        scene.frame_set(frame)
        moments.append(clip_preview.posture_of(row, scene))
    assert moments == [0, 0, 1, 0, 11], "the clip has 12 frames a second, the scene 24"
    first, later = (clip_preview.pixels(row, k, 64) for k in (0, 3))
    assert first.shape == (64, 64, 4) and first.min() >= 0 and first.max() <= 1
    assert not np.array_equal(first, later)
    # The head is at the top, and Blender's pictures begin at the bottom.
    rows = np.flatnonzero(first[..., 3].any(1))
    assert first[rows[-1], :, 3].sum() > 0 and first[rows[-8], :, 3].sum() < first[rows[0] + 1 :, :, 3].sum()
    clip_preview.figure(row, scene)
    clip_preview.icon(row)


def test_the_figure_stands_beside_the_drawing(addon, tmp_path):
    ob = shots.set_up(tmp_path)
    ob.rototoon.clips_folder = str(shelf(addon, tmp_path))
    row = addon("style.clip_browser").chosen()
    gather = addon("ui.clip_preview").gather
    lines = np.concatenate([mark.points for mark in gather(ob, row, bpy.context.scene)])
    shots.draw(addon, ob, 1, [np.array([[20.0, 10], [60, 10], [60, 80], [20, 80]])])
    beside = np.concatenate([mark.points for mark in gather(ob, row, bpy.context.scene)])
    m = shots.mapping(addon, ob)
    matrix = np.linalg.inv(np.array(ob.matrix_world))
    seen = m.to_pixels(beside @ matrix[:3, :3].T + matrix[:3, 3])
    assert seen[:, 0].min() >= 59 and abs(seen[:, 1].max() - 80) < 1 and seen[:, 1].min() > 9
    assert not np.allclose(lines, beside)


def test_a_clip_of_another_rate_plays_at_its_speed(addon, tmp_path):
    style, folder = addon("rototoon.style"), shelf(addon, tmp_path)
    entry = {"character": "mocap", "motion": "walk", "points": postures(addon, 121).tolist()}
    style.add_to_library(str(folder), {"rototoon_clips": 1, "fps": 120, "keypoints": list(style.KEY_POINTS), "clips": [entry]}, "a.bvh")
    row = addon("style.clip_library").read(str(folder)).find("mocap", "walk")
    assert (row.frames, row.fps, len(row.postures), row.rate) == (121, 120, 13, 12)
    scene = bpy.context.scene
    scene.render.fps, scene.frame_start = 24, 1
    preview = addon("ui.clip_preview")
    shown = []
    for frame in (1, 3, 13, 25):
        scene.frame_set(frame)
        shown.append(preview.posture_of(row, scene))
    assert shown == [0, 1, 6, 12], "a second of film is a second of the clip"

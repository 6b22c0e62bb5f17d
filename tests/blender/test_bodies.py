"""Bodies other than a human's in Blender: limbs, clips, the library, and drawings that follow them."""

import json
import math

import bpy
import numpy as np
import pytest
import shots
from test_style import ring, turned

SNAIL = {
    "name": "snail",
    "points": [
        {"name": "foot", "at": [0, 0]},
        {"name": "neck", "parent": "foot", "at": [1, 0]},
        {"name": "l_eye", "parent": "neck", "at": [1.3, -0.5]},
        {"name": "r_eye", "parent": "neck", "at": [1.2, -0.5]},
    ],
    "mirror": [["l_eye", "r_eye"]],
    "chains": [
        {"name": "torso", "points": ["foot", "neck"], "role": "torso"},
        {"name": "r_stalk", "points": ["neck", "r_eye"], "role": "other"},
    ],
}


@pytest.fixture(autouse=True)
def needs_library(library):
    """All tests here."""


def lying(left, right, y, half):
    """Eight points of a bar: along its top to the right, along its bottom back."""
    along = np.linspace(left, right, 4)
    return np.array([[x, y - half] for x in along] + [[x, y + half] for x in along[::-1]])


def dog(wag=0.0, step=0.0):
    """Contours of a hind leg, a body and a tail in a picture of 160 × 90 pixels. The dog looks right."""
    return [
        turned(ring(55, 44, 82, 4), (55, 46), step),
        lying(50, 110, 44, 9),
        turned(lying(20, 52, 40, 3), (52, 40), wag),
    ]


LINES = {
    "pelvis": (1, 0.0, 7.0),
    "withers": (1, 3.0, 4.0),
    "tail_base": (2, 3.0, 4.0),
    "tail_middle": (2, 1.5, 5.5),
    "tail_tip": (2, 0.0, 7.0),
    "r_hip": (0, 0.0, 7.0),
    "r_knee": (0, 1.0, 6.0),
    "r_hock": (0, 2.0, 5.0),
    "r_hindpaw": (0, 3.0, 4.0),
}
"""Key points with their part and the two places of its contour that the line joins."""


def animal(addon, folder, count=shots.COUNT, wag=0.5):
    """A dog that wags its tail on `count` pictures, with limbs."""
    folder.mkdir(exist_ok=True)
    ob = shots.set_up(folder)
    for frame in range(1, count + 1):
        moment = math.sin(2 * math.pi * (frame - 1) / (shots.COUNT - 1))
        shots.draw(addon, ob, frame, dog(wag * moment, 0.3 * moment))
        bpy.context.scene.frame_set(frame)
        bpy.ops.rototoon.match_contours()
    bpy.context.scene.frame_set(1)
    assert bpy.ops.rototoon.choose_body(body="quadruped") == {"FINISHED"}
    shots.limb_lines(addon, ob, dog(), LINES)
    return ob


def said(addon):
    """The last report."""
    return addon("common.reports").take()[-1].text


def test_the_menu_has_the_key_points_of_the_body(addon, tmp_path):
    ob = shots.set_up(tmp_path)
    shots.draw(addon, ob, 1, dog())
    shots.limb_line(addon, ob, dog(), LINES["r_hock"])
    with pytest.raises(TypeError, match="r_hock"):
        bpy.ops.rototoon.define_limbs(point="r_hock")
    assert bpy.ops.rototoon.choose_body(body="quadruped") == {"FINISHED"}
    assert bpy.ops.rototoon.define_limbs(point="r_hock") == {"FINISHED"}
    assert json.loads(ob.rototoon.extra)["skeleton"] == "quadruped"
    assert addon("style.limbs").body_name(ob) == "Quadruped"


def test_a_dog_is_captured_listed_and_followed(addon, tmp_path):
    shelf = tmp_path / "clips"
    ob = animal(addon, tmp_path / "dog")
    made = addon("style.limbs").defined(ob)
    assert [(limb["from"], limb["to"]) for limb in made] == [
        ("pelvis", "withers"),
        ("pelvis", "tail_base"),
        ("tail_base", "tail_middle"),
        ("tail_middle", "tail_tip"),
        ("pelvis", "r_hip"),
        ("r_hip", "r_knee"),
        ("r_knee", "r_hock"),
        ("r_hock", "r_hindpaw"),
    ]
    body = made[0]["start"]["points"][0]["part"]
    assert [limb["to"] for limb in made if limb.get("carries") == [body]] == ["tail_base", "r_hip"]
    assert bpy.ops.rototoon.save_clip(character="rex", motion="wag", folder=str(shelf)) == {"FINISHED"}
    clip = json.loads(next(shelf.glob("*.clip.json")).read_text())
    assert clip.get("skeleton", clip["clips"][0].get("skeleton")) == "quadruped"

    ob.rototoon.clips_folder = str(shelf)
    clip_browser, clip_preview = addon("style.clip_browser"), addon("ui.clip_preview")
    row = clip_browser.chosen()
    assert row is not None and not row.human and row.body.name == "quadruped"
    assert row.postures.shape == (shots.COUNT, len(row.body.points), 2)
    picture = clip_preview.pixels(row, 0, 64)
    assert 100 < np.count_nonzero(picture[..., 3]) < 2000
    assert clip_browser.characters() == ["rex"] and clip_browser.characters(human=True) == []

    doll = animal(addon, tmp_path / "doll", count=1)
    doll.rototoon.clips_folder = str(shelf)
    assert bpy.ops.rototoon.reshape_drawing(character="rex", motion="wag") == {"FINISHED"}
    frames = range(2, shots.COUNT + 2)
    tip = [dict(shots.pixels(addon, doll, frame))[3][[0, 7]].mean(0) for frame in frames]
    assert np.ptp([point[1] for point in tip]) > 20, "the tail wags"


def test_a_human_moves_an_animal_by_chains(addon, tmp_path):
    import test_style

    shelf = str(tmp_path / "clips")
    (tmp_path / "man").mkdir()
    test_style.performer(addon, tmp_path / "man")
    assert bpy.ops.rototoon.save_clip(character="man", motion="walk", folder=shelf) == {"FINISHED"}
    ob = animal(addon, tmp_path / "dog", count=1)
    call = lambda chains: bpy.ops.rototoon.reshape_drawing(character="man", motion="walk", folder=shelf, chains=chains)  # noqa: E731
    with pytest.raises(RuntimeError, match="expected pairs such as"):
        call("r_arm")
    with pytest.raises(RuntimeError, match="wing"):
        call("r_arm = wing")
    assert call("") == {"FINISHED"}
    text = said(addon)
    assert "no chain of the clip moves" in text and "tail" in text
    rigid = _reach(addon, ob)
    assert call("r_arm = tail") == {"FINISHED"}
    assert "tail" not in said(addon)
    assert _reach(addon, ob) > rigid + 5, "the arm swings the tail"


def _reach(addon, ob):
    """How far the tip of the tail turns about its base, in pixels."""
    parts = [dict(shots.pixels(addon, ob, frame))[3] for frame in range(2, shots.COUNT + 2)]
    return np.ptp([part[[0, 7]].mean(0)[1] - part[[3, 4]].mean(0)[1] for part in parts])


def test_lines_and_limbs_of_both_bodies_stay(addon, tmp_path):
    ob = animal(addon, tmp_path, count=1)
    limbs = addon("style.limbs")
    assert limbs.count_lines(ob) == len(LINES)
    assert bpy.ops.rototoon.choose_body(body="bird") == {"FINISHED"}
    # A bird has no withers and no hocks. Of the tail it has the base and the tip.
    assert "no r_hindpaw, r_hock, tail_middle, withers" in said(addon)
    assert limbs.count_lines(ob) == 5
    assert [(limb["from"], limb["to"]) for limb in limbs.defined(ob)] == [
        ("pelvis", "tail_base"),
        ("tail_base", "tail_tip"),
        ("pelvis", "r_hip"),
        ("r_hip", "r_knee"),
    ]
    before = shots.snapshot(ob)
    ob.data.layers[limbs.LAYER].lock = True
    with pytest.raises(RuntimeError, match="locked"):
        bpy.ops.rototoon.choose_body(body="human")
    assert shots.snapshot(ob) == before


def test_limbs_without_lines_that_do_not_fit_are_told(addon, tmp_path):
    ob = animal(addon, tmp_path, count=1)
    limbs = addon("style.limbs")
    ob.data.layers.remove(ob.data.layers[limbs.LAYER])
    assert bpy.ops.rototoon.choose_body(body="human") == {"FINISHED"}
    assert [(limb["from"], limb["to"]) for limb in limbs.defined(ob)] == [("pelvis", "r_hip"), ("r_hip", "r_knee")]
    assert "6 limbs do not fit this body" in said(addon)
    assert "skeleton" not in json.loads(ob.rototoon.extra)


@pytest.mark.parametrize("wrapped", [False, True])
def test_a_body_of_ones_own(addon, tmp_path, wrapped):
    path = tmp_path / "snail.json"
    path.write_text(json.dumps({"rototoon_clips": 2, "skeleton": SNAIL, "clips": []} if wrapped else SNAIL))
    ob = shots.set_up(tmp_path)
    shots.draw(addon, ob, 1, dog())
    assert bpy.ops.rototoon.choose_body(body="file", filepath=str(path)) == {"FINISHED"}
    shots.limb_lines(addon, ob, dog(), {"foot": (1, 0.0, 7.0), "neck": (1, 3.0, 4.0), "r_eye": (2, 0.0, 7.0)})
    limbs = addon("style.limbs")
    assert [(limb["from"], limb["to"]) for limb in limbs.defined(ob)] == [("foot", "neck"), ("neck", "r_eye")]
    assert limbs.body_name(ob) == "snail"
    out = tmp_path / "out.json"
    bpy.ops.rototoon.export_document(filepath=str(out))
    assert json.loads(out.read_text())["skeleton"] == SNAIL


def test_wrong_bodies_change_nothing(addon, tmp_path):
    ob = animal(addon, tmp_path, count=1)
    before = shots.snapshot(ob)
    path = tmp_path / "body.json"
    lame = json.loads(json.dumps(SNAIL))
    lame["points"][2]["parent"] = "shell"
    for text, found in (
        ("snail", "body.json: found no JSON"),
        ("{}", "body.json: found neither points nor the field skeleton"),
        ('{"skeleton": "fish"}', 'body.json: skeleton: found "fish"'),
        (json.dumps(lame), 'parent: found "shell"'),
    ):
        path.write_text(text)
        with pytest.raises(RuntimeError, match=found):
            bpy.ops.rototoon.choose_body(body="file", filepath=str(path))
    with pytest.raises(RuntimeError, match="No such file"):
        bpy.ops.rototoon.choose_body(body="file", filepath=str(tmp_path / "none.json"))
    with pytest.raises(RuntimeError, match="No file chosen"):
        bpy.ops.rototoon.choose_body(body="file")
    assert shots.snapshot(ob) == before

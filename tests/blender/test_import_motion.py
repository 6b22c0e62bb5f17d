"""Motion capture files as clips of the library."""

import bpy
import pytest
import shots

FIGURE = {
    "Hips": (None, (0, 10, 0)), "Spine": ("Hips", (0, 2, 0)), "Neck": ("Spine", (0, 2, 0)), "Head": ("Neck", (0, 1, 0)),
    "LeftArm": ("Spine", (2, 2, 0)), "LeftForeArm": ("LeftArm", (2, 0, 0)), "LeftHand": ("LeftForeArm", (2, 0, 0)),
    "RightArm": ("Spine", (-2, 2, 0)), "RightForeArm": ("RightArm", (-2, 0, 0)), "RightHand": ("RightForeArm", (-2, 0, 0)),
    "LeftUpLeg": ("Hips", (1, 0, 0)), "LeftLeg": ("LeftUpLeg", (0, -5, 0)), "LeftFoot": ("LeftLeg", (0, -4, 0)),
    "RightUpLeg": ("Hips", (-1, 0, 0)), "RightLeg": ("RightUpLeg", (0, -5, 0)), "RightFoot": ("RightLeg", (0, -4, 0)),
}  # fmt: skip
"""Parent and offset of each joint."""
ENDS = {"Head": (0, 1.5, 0), "LeftHand": (1, 0, 0), "RightHand": (-1, 0, 0), "LeftFoot": (0, 0, 1), "RightFoot": (0, 0, 1)}


@pytest.fixture(autouse=True)
def needs_library(library):
    """All tests here."""


def joint(name):
    parent, offset = FIGURE[name]
    places = "" if parent else "Xposition Yposition Zposition "
    head = f"{'JOINT' if parent else 'ROOT'} {name}\n{{\nOFFSET {offset[0]} {offset[1]} {offset[2]}\n"
    channels = f"CHANNELS {3 if parent else 6} {places}Zrotation Xrotation Yrotation\n"
    children = "".join(joint(child) for child, (above, _) in FIGURE.items() if above == name)
    end = "End Site\n{{\nOFFSET {} {} {}\n}}\n".format(*ENDS[name]) if name in ENDS else ""
    return f"{head}{channels}{children}{end}}}\n"


def motion(frames=4):
    """The figure walks along x, one unit a frame."""
    lines = [" ".join(map(str, [frame, 10, 0] + [0] * (3 * len(FIGURE)))) for frame in range(frames)]
    return f"HIERARCHY\n{joint('Hips')}MOTION\nFrames: {frames}\nFrame Time: 0.04\n" + "\n".join(lines) + "\n"


def shot(tmp_path):
    ob = shots.set_up(tmp_path)
    ob.rototoon.clips_folder = str(tmp_path / "clips")
    captured = tmp_path / "anna"
    captured.mkdir()
    return captured


def listed(addon):
    return [(item.character, item.motion, item.frames) for item in addon("style.clip_browser").browser().clips]


def test_a_file_is_named_after_its_folder_and_itself(addon, tmp_path):
    file = shot(tmp_path) / "stroll.bvh"
    file.write_text(motion())
    assert bpy.ops.rototoon.import_motion(filepath=str(file), view="front") == {"FINISHED"}
    assert listed(addon) == [("anna", "stroll", 4)]
    clip = addon("style.clip_browser").shelf().find("anna", "stroll")
    names = addon("rototoon.style").KEY_POINTS
    pelvis, neck, hand = (clip.postures[:, names.index(name)] for name in ("pelvis", "neck", "l_wrist"))
    assert pelvis[:, 0] - pelvis[0, 0] == pytest.approx([0, 0.25, 0.5, 0.75], abs=1e-6), "torso lengths, as it goes"
    assert (neck - pelvis)[0] == pytest.approx([0, -1], abs=1e-6)
    assert (hand - pelvis)[0] == pytest.approx([1.5, -1], abs=1e-6)
    assert clip.fps == pytest.approx(25)
    bpy.ops.rototoon.import_motion(filepath=str(file), view="front", way=False, character="Bo", motion="still")
    still = addon("style.clip_browser").shelf().find("Bo", "still").postures[:, 0]
    assert still == pytest.approx(0, abs=1e-9)


def test_several_files_are_several_clips_or_none(addon, tmp_path):
    folder = shot(tmp_path)
    (folder / "a.bvh").write_text(motion(3))
    (folder / "b.bvh").write_text(motion(5))
    chosen = {"directory": str(folder), "files": [{"name": "a.bvh"}, {"name": "b.bvh"}]}
    assert bpy.ops.rototoon.import_motion(**chosen, view="angle", angle=30) == {"FINISHED"}
    assert listed(addon) == [("anna", "a", 3), ("anna", "b", 5)]
    (folder / "c.bvh").write_text(motion(2))
    (folder / "damaged.bvh").write_text(motion().replace("OFFSET 0 2 0", "OFFSET 0 two 0", 1))
    chosen["files"] = [{"name": "c.bvh"}, {"name": "damaged.bvh"}]
    with pytest.raises(RuntimeError, match=r"damaged\.bvh: .*line \d+.*two"):
        bpy.ops.rototoon.import_motion(**chosen)
    bpy.ops.rototoon.refresh_clips()
    assert len(listed(addon)) == 2, "a file that cannot be read leaves the library as it was"


def test_files_that_are_not_there_or_not_of_a_figure(addon, tmp_path):
    folder = shot(tmp_path)
    with pytest.raises(RuntimeError, match="No file chosen"):
        bpy.ops.rototoon.import_motion()
    with pytest.raises(RuntimeError, match=r"gone\.bvh"):
        bpy.ops.rototoon.import_motion(filepath=str(folder / "gone.bvh"))
    (folder / "crane.bvh").write_text(motion().replace("LeftForeArm", "Boom"))
    with pytest.raises(RuntimeError, match="l_elbow"):
        bpy.ops.rototoon.import_motion(filepath=str(folder / "crane.bvh"))


def test_a_pelvis_of_another_name_is_told(addon, tmp_path):
    file = shot(tmp_path) / "stroll.bvh"
    file.write_text(motion().replace("ROOT Hips", "ROOT COG"))
    scripting = addon("scripting")
    scripting.take_reports()
    assert bpy.ops.rototoon.import_motion(filepath=str(file), view="front") == {"FINISHED"}
    report = scripting.take_reports()[-1]
    assert report.kind == "WARNING"
    assert 'stroll.bvh: the pelvis is "COG", on which both thighs hang, not "Spine"' in report.text
    clip = addon("style.clip_browser").shelf().find("anna", "stroll")
    assert (clip.postures[0, 2] - clip.postures[0, 0]) == pytest.approx([0, -1], abs=1e-6), "the torso is the unit"

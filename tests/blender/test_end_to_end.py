"""The main job with the native library in the extension: keys in, tracked strokes out, corrected, snapped, saved."""

import bpy
import numpy as np
import pytest
import shots


@pytest.fixture(autouse=True)
def needs_library(library):
    """All tests here."""


def worst(addon, ob, frame):
    """Largest distance of a tracked point from the truth, in pixels."""
    truth = {1: shots.diamond, 2: shots.square}
    return max(
        np.linalg.norm(points - truth[number](frame - 1), axis=1).max()
        for number, points in shots.pixels(addon, ob, frame)
    )


def test_keys_in_tracked_strokes_out(addon, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    assert bpy.ops.rototoon.track() == {"FINISHED"}
    assert len(shots.layer_of(ob).frames) == 9
    assert max(worst(addon, ob, frame) for frame in range(1, 10)) < 3
    session = addon("capture.sessions").known(ob).session
    assert session.track().solved == 0
    shots.move(addon, ob, 5, 1, (3.0, 2.0), which=[0])
    pinned = dict(shots.pixels(addon, ob, 5))[1][0]
    bpy.ops.rototoon.track()
    assert np.array_equal(dict(shots.pixels(addon, ob, 5))[1][0], pinned)
    assert session.track().solved == 0
    assert "pins" in session.document()["parts"][0]


def test_drawn_afresh_is_matched_and_tracked(addon, tmp_path):
    ob = shots.set_up(tmp_path)
    shots.draw(addon, ob, 1, [shots.diamond(0), shots.square(0)])
    square = np.roll(shots.square(4)[::-1], 1, 0)
    dense = np.concatenate([np.linspace(a, b, 6)[:-1] for a, b in zip(square, np.roll(square, -1, 0))])
    shots.draw(addon, ob, 5, [dense, np.roll(shots.diamond(4), 1, 0)])
    bpy.ops.rototoon.track()
    assert [number for number, _ in shots.pixels(addon, ob, 5)] == [2, 1]
    assert len(ob.rototoon.parts) == 2
    assert max(worst(addon, ob, frame) for frame in range(2, 5)) < 3


@pytest.mark.parametrize("by", ["layer", "material", "order"])
def test_look_alikes_are_told_apart_as_the_artist_did(addon, tmp_path, by):
    """Two equal legs lie in one place on the first key, as in a walk, and stand apart on the next."""
    ob = shots.set_up(tmp_path)
    gp = addon("blender.grease_pencil")
    ob.data.materials.append(ob.data.materials[0].copy())
    names = ["Contours.far", "Contours.near"] if by == "layer" else ["Contours", "Contours"]
    turned = by != "order"

    def leg(foot):
        return np.array([[75.0, 30], [85, 30], [foot + 4, 80], [foot - 4, 80]])

    for frame, feet in ((1, (80, 80)), (9, (50, 110))):
        legs = list(zip(names, feet, (0, 1), strict=True))
        # On the second key the near leg is drawn first.
        for name, foot, material in legs[::-1] if turned and frame == 9 else legs:
            ob.rototoon.contours_layer = name
            if ob.data.layers.get(name) is None:
                ob.data.layers.new(name)
            drawing = shots.draw(addon, ob, frame, [leg(foot)])
            if by == "material":
                found = gp.value(drawing, "material_index", len(drawing.strokes))
                found[-1] = material
                gp.put(drawing, "material_index", found)
    ob.rototoon.contours_layer = "Contours"
    bpy.ops.rototoon.match_contours()
    found = addon("capture.contours").read(ob)
    mapper = addon("capture.document").mapper_of(ob, found)
    feet = [mapper.at(part.keys[9].layer, 9).to_pixels(part.keys[9].points)[2:, 0].mean() for part in found.parts]
    assert feet == pytest.approx([50, 110], abs=0.1)


def test_snapped_line_lies_on_the_ink(addon, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    bpy.ops.rototoon.snap()
    curves = addon("capture.snapping").read(ob)
    assert sorted(curves) == [(part, frame) for part in (1, 2) for frame in range(1, 10)]
    outline = shots.square(4)
    line = np.concatenate(curves[2, 5])
    inner = outline.mean(0) + (outline - outline.mean(0)) * 0.8
    # Between the outer edge of the ink (and a pixel more) and the fill.
    assert (line >= outline.min(0) - 1.5).all() and (line <= outline.max(0) + 1.5).all()
    assert not ((line > inner.min(0)) & (line < inner.max(0))).all(1).any()


def test_stopped_in_the_library(addon, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    before = shots.snapshot(ob)
    jobs = addon("common.jobs")
    start = jobs.Worker.start
    try:
        jobs.Worker.start = lambda self: (self.cancel(), start(self))
        assert bpy.ops.rototoon.track() == {"CANCELLED"}
    finally:
        jobs.Worker.start = start
    assert shots.snapshot(ob) == before
    assert bpy.ops.rototoon.track() == {"FINISHED"}


def test_picture_that_cannot_be_read(addon, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    (tmp_path / "frames/shot_004.png").write_bytes(b"no picture")
    before = shots.snapshot(ob)
    with pytest.raises(RuntimeError, match="shot_004.png"):
        bpy.ops.rototoon.track()
    assert shots.snapshot(ob) == before


def test_snap_after_opening_the_file_again(addon, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "shot.blend"))
    assert bpy.ops.rototoon.snap() == {"FINISHED"}
    assert len(bpy.context.object.data.layers["Snapped"].frames) == 9
    bpy.ops.rototoon.export_document(filepath=str(tmp_path / "out.json"))
    with addon("rototoon").Session.open(tmp_path / "out.json") as session:
        assert session.parts() == ["Part 1", "Part 2"]
        assert len(session.curves("Part 2", 5)) == 4


def test_footage_that_is_drawn_again_under_the_same_names_is_read_again(addon, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    late = [number - 2 * np.sin(np.pi * number / 8) for number in range(9)]
    for number in range(1, 8):
        (tmp_path / "frames" / f"shot_{number + 1:03}.png").write_bytes(shots.drawn(late[number]))
    bpy.ops.rototoon.track()
    assert "the pictures have changed and were read again" in addon("scripting").take_reports()[-1].text
    points = dict(shots.pixels(addon, ob, 5))[2]
    assert np.linalg.norm(points - shots.square(late[4]), axis=1).max() < 3

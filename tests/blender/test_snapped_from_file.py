"""Snap to Ink follows the contours that the file has, whatever the session had before, and missing contours are named. With the real library."""

import json

import bpy
import numpy as np
import pytest
import shots
from line_stage import said


@pytest.fixture
def tracked(addon, library, tmp_path):
    """Two parts with keys on 1 and 9."""
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    return ob


def off(addon, ob, frame):
    """How far the ends of snapped paths are off the contours of a frame, in pixels."""
    paths = addon("capture.snapping").read(ob)
    contours = dict(shots.pixels(addon, ob, frame))
    return max(np.abs(np.array([path[0] for path in paths[number, frame]]) - contour).max() for number, contour in contours.items())


def lines(addon, ob):
    """Number of snapped lines by frame."""
    gp = addon("blender.grease_pencil")
    return {frame: len(gp.offsets(handle)) - 1 for frame, (handle, _) in gp.drawings(ob.data.layers["Snapped"]).items()}


def delete_first(addon, ob, frame):
    gp = addon("blender.grease_pencil")
    gp.remove_strokes(gp.drawings(shots.layer_of(ob))[frame][0], [0])


def reopened(tmp_path):
    path = str(tmp_path / "shot.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    return bpy.context.object


def test_a_move_that_was_taken_back_is_not_followed(addon, tracked):
    gp = addon("blender.grease_pencil")
    bpy.ops.rototoon.snap()
    handle = gp.drawings(shots.layer_of(tracked))[5][0]
    before = gp.positions(handle, int(gp.offsets(handle)[-1])).copy()
    shots.move(addon, tracked, 5, 1, (9.0, 0.0), which=[0])
    bpy.ops.rototoon.snap()
    assert off(addon, tracked, 5) < 0.01
    gp.put(gp.drawings(shots.layer_of(tracked))[5][0], "position", before)
    bpy.ops.rototoon.snap()
    assert off(addon, tracked, 5) < 0.01


def test_a_track_that_was_taken_back_is_not_followed(addon, tracked):
    name = tracked.name
    shots.move(addon, tracked, 1, 1, (6.0, 4.0))
    bpy.ops.ed.undo_push(message="tracked")
    first = dict(shots.pixels(addon, tracked, 5))
    tracked.rototoon.preset = "liang2012"
    bpy.ops.rototoon.track()
    assert any(np.abs(first[number] - points).max() > 0.5 for number, points in shots.pixels(addon, tracked, 5))
    bpy.ops.ed.undo_push(message="tracked again")
    bpy.ops.ed.undo()
    ob = bpy.data.objects[name]
    assert all(np.array_equal(first[number], points) for number, points in shots.pixels(addon, ob, 5))
    bpy.ops.rototoon.snap()
    assert off(addon, ob, 5) < 0.01


@pytest.mark.parametrize("reopen", [False, True])
def test_a_part_is_snapped_wherever_it_has_a_contour(addon, tracked, tmp_path, reopen):
    delete_first(addon, tracked, 5)
    ob = reopened(tmp_path) if reopen else tracked
    bpy.ops.rototoon.snap()
    assert lines(addon, ob) == {frame: 1 if frame == 5 else 2 for frame in range(1, 10)}


def test_export_names_parts_whose_contours_are_missing(addon, tracked, tmp_path):
    bpy.ops.rototoon.snap()
    bpy.ops.rototoon.export_document(filepath=str(tmp_path / "whole.json"))
    assert said(addon).warnings == ()
    delete_first(addon, tracked, 5)
    (gone,) = {number for number, _ in shots.pixels(addon, tracked, 6)} - {number for number, _ in shots.pixels(addon, tracked, 5)}
    name = next(part.name for part in tracked.rototoon.parts if part.number == gone)
    bpy.ops.rototoon.snap()
    path = tmp_path / "out.json"
    bpy.ops.rototoon.export_document(filepath=str(path))
    assert said(addon).warnings == (f'tracks are left out: "{name}", since its contours on 5 are missing; Track draws them again',)
    parts = {part["name"]: part for part in json.loads(path.read_text())["parts"]}
    assert "tracks" not in parts[name] and len(parts[name]["curves"]) == 8
    assert all("tracks" in part for part in parts.values() if part["name"] != name)
    bpy.ops.rototoon.track()
    bpy.ops.rototoon.export_document(filepath=str(path))
    assert all("tracks" in part for part in json.loads(path.read_text())["parts"])


def test_a_part_with_one_key_keeps_its_track_up_to_the_missing_contour(addon, library, tmp_path):
    ob = shots.set_up(tmp_path)
    shots.draw(addon, ob, 3, [shots.square(2)])
    bpy.ops.rototoon.track()
    offset = ob.rototoon.frame_offset
    read = addon("capture.document").read
    whole = [int(frame) + offset for frame in read(ob, results=True).document["parts"][0]["tracks"]]
    assert whole[0] < 2 and whole[-1] > 6
    delete_first(addon, ob, 6)
    kept = [int(frame) + offset for frame in read(ob, results=True).document["parts"][0]["tracks"]]
    assert kept == list(range(whole[0], 6))
    gaps = read(ob, results=True, gaps=True)
    assert gaps.missing == {"Part 1": [6]} and len(gaps.document["parts"][0]["tracks"]) == len(whole) - 1

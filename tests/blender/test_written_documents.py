"""What Export Document writes of results: old snapped lines are named, and computed numbers are rounded."""

import json

import bpy
import pytest
import shots
from line_stage import said


def exported(path):
    assert bpy.ops.rototoon.export_document(filepath=str(path)) == {"FINISHED"}
    return json.loads(path.read_text())


@pytest.fixture
def snapped(addon, fake, tmp_path):
    """Two tracked and snapped parts."""
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    assert bpy.ops.rototoon.snap() == {"FINISHED"}
    return ob


def corrected(addon, ob):
    shots.move(addon, ob, 4, 2, (5.0, -3.0), which=[1])
    bpy.ops.rototoon.track()


def test_snapped_lines_of_the_contour_are_not_named(addon, snapped, tmp_path):
    exported(tmp_path / "new.json")
    assert said(addon).warnings == ()


def test_snapped_lines_that_are_older_than_the_contour_are_named(addon, snapped, tmp_path):
    name = snapped.rototoon.parts[1].name
    corrected(addon, snapped)
    before = addon("capture.document").read(snapped, results=True).document
    document = exported(tmp_path / "old.json")
    (warning,) = said(addon).warnings
    assert warning.startswith(f'snapped lines are older than the contours: "{name}" on ') and "4" in warning
    assert warning.endswith("; Snap to Ink makes them again")
    assert list(document["parts"][1]["curves"]) == list(before["parts"][1]["curves"])
    bpy.ops.rototoon.contours_to_mask()
    assert said(addon).warnings == (warning,)
    bpy.ops.rototoon.contours_to_mask(use_snapped=False)
    assert said(addon).warnings == ()
    bpy.ops.rototoon.snap()
    exported(tmp_path / "again.json")
    assert said(addon).warnings == ()


def test_snapped_lines_that_the_artist_moved_are_not_old(addon, snapped, tmp_path):
    gp = addon("blender.grease_pencil")
    handle = gp.drawings(snapped.data.layers["Snapped"])[4][0]
    points = gp.positions(handle, int(gp.offsets(handle)[-1]))
    gp.put(handle, "position", points + 0.05)
    exported(tmp_path / "mine.json")
    assert said(addon).warnings == ()


def test_computed_numbers_are_rounded_and_the_artists_are_exact(addon, snapped, tmp_path):
    corrected(addon, snapped)
    exact = addon("capture.document").read(snapped, results=True).document
    document = exported(tmp_path / "numbers.json")
    for known, part in zip(exact["parts"], document["parts"], strict=True):
        assert part["keys"] == known["keys"] and part.get("pins") == known.get("pins")
        for frame, points in part["tracks"].items():
            made = known["keys"].get(frame, []) + list(known.get("pins", {}).get(frame, {}).values())
            for point, place in zip(points, known["tracks"][frame], strict=True):
                assert point == (place if place in made else [round(value, 4) for value in place])
        numbers = [value for paths in part["curves"].values() for path in paths for point in path for value in point]
        numbers += [value for values in part["confidence"].values() for value in values]
        assert numbers and all(value == round(value, 4) for value in numbers)
    assert any(place != [round(value, 4) for value in place] for place in exact["parts"][1]["pins"]["4"].values()), "a pin shows that it is exact"

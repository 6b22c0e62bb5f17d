"""Conform to New Footage, and drawings that are held: what a layer shows on a picture it shows on it afterwards."""

import bpy
import pytest
import shots
from test_conform import GIVEN, delivered, film, frames, said  # noqa: F401 - fixtures
from test_strokes import add
from test_tween import figure

ONE, TWO = [[(0, 0), (1, 0.5)]], [[(0, 0), (1, 0.5)], [(0, 1), (1, 1.5)]]


def shown(addon, ob, numbers):
    """By frame the number of strokes that are shown, 0 for a blank drawing; `None` without one."""
    gp = addon("blender.grease_pencil")
    found = {frame: gp.shown(ob.data.layers["Lines"], frame) for frame in numbers}
    return {frame: None if each is None else len(gp.offsets(each[1])) - 1 for frame, each in found.items()}


def blank(addon, ob, frame):
    gp = addon("blender.grease_pencil")
    gp.make_frames(ob.data.layers["Lines"], [frame], gp.KEYFRAME)


def test_a_blank_key_ends_its_drawing_although_its_picture_is_gone(addon, film, delivered):  # noqa: F811
    film.data.layers.new("Lines")
    add(addon, film, "Lines", 1, ONE)
    blank(addon, film, 7)
    bpy.ops.rototoon.conform(filepath=delivered, **GIVEN)
    # The pictures of 8 and 9 are on 7 and 8.
    assert shown(addon, film, range(1, 9)) == dict.fromkeys(range(1, 7), 1) | {7: 0, 8: 0}


def test_a_held_drawing_goes_to_the_next_picture_that_shows_it(addon, film, delivered):  # noqa: F811
    film.data.layers.new("Lines")
    add(addon, film, "Lines", 1, ONE)
    add(addon, film, "Lines", 7, TWO)
    bpy.ops.rototoon.conform(filepath=delivered, **GIVEN)
    assert shown(addon, film, range(1, 9)) == dict.fromkeys(range(1, 7), 1) | {7: 2, 8: 2}
    assert not any("Lines" in text and "left over" in text for text in said(addon).warnings)


def test_a_drawing_on_the_picture_that_is_gone_alone_is_left_over(addon, film, delivered):  # noqa: F811
    film.data.layers.new("Lines")
    add(addon, film, "Lines", 7, TWO)
    add(addon, film, "Lines", 8, ONE)
    bpy.ops.rototoon.conform(filepath=delivered, **GIVEN)
    assert shown(addon, film, range(1, 9)) == dict.fromkeys(range(1, 7)) | {7: 1, 8: 1}
    assert any('layer "Lines": the drawing on 7: left over' in text for text in said(addon).warnings)


def test_in_betweens_go_along_with_a_key_that_is_held(addon, film, delivered):  # noqa: F811
    film.data.layers.new("Lines")
    add(addon, film, "Lines", 1, figure())
    add(addon, film, "Lines", 7, figure(0.3, 0.1))
    film.data.layers.active = film.data.layers["Lines"]
    bpy.ops.rototoon.in_between(frames="ALL")
    bpy.ops.rototoon.conform(filepath=delivered, **GIVEN)
    assert not any("in-betweens" in text for text in said(addon).warnings)
    found = addon("tween.keys").frames_of(film.data.layers["Lines"], addon("tween.records").read(film.data)["Lines"])
    assert (found.keys, found.made) == ([1, 7], [2, 3, 4, 5, 6])
    spans = addon("tween.records").read(film.data)["Lines"].spans
    assert {first: span.last for first, span in spans.items()} == {1: 7}


@pytest.fixture
def twos(addon, library, fake, tmp_path):
    """A film on twos, which comes again on ones. Gives the object, and what delivers it."""
    old, new = tmp_path / "old", tmp_path / "new"
    for folder, count, step in ((old, 10, 2), (new, 5, 1)):
        folder.mkdir()
        for number in range(count):
            (folder / f"a_{number + 1:03d}.png").write_bytes(shots.drawn(number // step))
    bpy.ops.rototoon.setup(filepath=str(old / "a_001.png"))
    bpy.context.object.data.layers.new("Lines")
    return bpy.context.object, lambda: bpy.ops.rototoon.conform(filepath=str(new / "a_001.png"), timing="SCENE")


def test_a_blank_key_takes_no_frame_of_a_drawing(addon, twos):
    """The line is on the first frame of a drawing, the blank key on the second."""
    ob, again = twos
    add(addon, ob, "Lines", 3, ONE)
    blank(addon, ob, 4)
    again()
    assert shown(addon, ob, range(1, 6)) == {1: None, 2: 1, 3: 0, 4: 0, 5: 0}

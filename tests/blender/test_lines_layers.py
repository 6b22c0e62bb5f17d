"""Carry Strokes on several layers whose drawings are on different frames. With the real library."""

import bpy
import line_shots as ls
import pytest
from line_stage import film, pictures, traced  # noqa: F401 - fixtures
from line_stage import away, number_of


def counts(addon, ob, layer):
    gp = addon("blender.grease_pencil")
    return {frame: len(gp.offsets(handle)) - 1 for frame, (handle, _) in gp.drawings(ob.data.layers[layer]).items()}


def messages(addon):
    return [each.text for each in addon("common.reports").take()]


def test_a_layer_beside_that_of_trace_drawing_gets_its_own_strokes_only(addon, traced):
    ls.put(addon, traced, "Red", 1, [(ls.lines(0)[0][0] + 2.0, True)])
    traced.data.layers.active = traced.data.layers["Red"]
    bpy.ops.rototoon.carry_strokes(layers="ALL")
    assert counts(addon, traced, "Red") == dict.fromkeys(range(1, 7), 1)
    assert counts(addon, traced, "Lines") == dict.fromkeys(range(1, 7), 6)


@pytest.mark.parametrize("frame", [1, 2])
def test_new_lines_are_on_one_layer_and_on_no_line_that_has_a_stroke(addon, film, frame):
    ls.put(addon, film, "A", 1, [(ls.lines(0)[0][0], True)])
    ls.put(addon, film, "B", frame, [(ls.lines(frame - 1)[1][0], True)])
    film.data.layers.active = film.data.layers["B"]
    messages(addon)
    bpy.ops.rototoon.carry_strokes(layers="ALL", new_lines=True)
    assert all("no line" not in each for each in messages(addon))
    assert counts(addon, film, "A") == dict.fromkeys(range(1, 7), 1)
    # The drawing of the artist has the one stroke that was drawn there.
    assert counts(addon, film, "B") == {**dict.fromkeys(range(1, 7), 5), frame: 1}
    (body,) = ls.strokes(addon, film, "A", 4).values()
    assert all(away(body, points) > 5 for points in ls.strokes(addon, film, "B", 4).values())


def test_what_was_moved_to_another_layer_is_not_drawn_anew_on_its_first_one(addon, traced):
    gp = addon("blender.grease_pencil")
    body = number_of(addon, traced, 0)
    ls.put(addon, traced, "Red", 1, [(ls.lines(0)[0][0], True)])
    handle, _ = gp.drawings(traced.data.layers["Lines"])[3]
    gp.remove_strokes(handle, [gp.value(handle, gp.TRACK, len(gp.offsets(handle)) - 1).tolist().index(body)])
    bpy.ops.rototoon.carry_strokes(layers="ALL")
    assert counts(addon, traced, "Red") == dict.fromkeys(range(1, 7), 1)
    assert counts(addon, traced, "Lines") == dict.fromkeys(range(1, 7), 5)

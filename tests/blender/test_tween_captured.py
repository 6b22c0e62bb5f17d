"""In-betweens that follow captured contours: strokes that lie on a tracked part go as that went in the footage."""

import json
import math

import bpy
import numpy as np
import pytest
import shots
from test_strokes import add, drawing_object
from test_tween import drawn_again, mark, move, points

pytestmark = pytest.mark.usefixtures("library")

LAST = 11


def bar(frame, out=1.1):
    """A bar that swings out and back from frame 1 to 11, of which the drawings on these two say nothing."""
    share = (frame - 1) / (LAST - 1)
    angle = 0.2 * share + out * math.sin(math.pi * share)
    return np.linspace(0, 3, 21)[:, None] * [math.cos(angle), math.sin(angle)]


def capture(addon, ob, frames, keys, shape=bar, layer="Contours"):
    """A tracked part on the contour layer: the artist's strokes on the keys, generated ones on the other frames."""
    gp = addon("blender.grease_pencil")
    found = ob.rototoon.parts.add()
    found.name, found.number, found.count = "Arm", len(ob.rototoon.parts), len(shape(keys[0]))
    for frame in frames:
        handle = add(addon, ob, layer, frame, [shape(frame)])
        gp.put(handle, gp.PART, np.array([found.number]))
        gp.put(handle, gp.MADE, np.array([frame not in keys]))
        gp.put(handle, gp.CONTROL, np.arange(found.count))
    kinds = {frame: gp.KEYFRAME if frame in keys else gp.GENERATED for frame in frames}
    gp.set_keyframe_type(ob.data.layers[layer], kinds)


def arm(addon, frames=range(1, LAST + 1), shape=bar):
    """An object with a captured arm, and a drawing of it on two keys."""
    ob = drawing_object(addon, ("Contours", "Lines"))
    capture(addon, ob, frames, (1, LAST), shape)
    for frame in (1, LAST):
        add(addon, ob, "Lines", frame, [bar(frame)])
    bpy.context.scene.frame_set(1)
    return ob


def off(addon, ob, shape=bar):
    """How far the drawings between are from the arm, at most."""
    return max(np.abs(points(addon, ob, frame)[0] - shape(frame)).max() for frame in range(2, LAST))


def test_a_stroke_swings_as_the_contour_on_which_it_lies(addon):
    ob = arm(addon)
    assert bpy.ops.rototoon.in_between(spacing="LINEAR") == {"FINISHED"}
    assert off(addon, ob) < 0.002
    kept = json.loads(ob.data["rototoon_tween"])["Lines"]["spans"]["1"]["choices"]
    assert kept["follow"] is True
    assert bpy.ops.rototoon.in_between(spacing="LINEAR", follow=False) == {"FINISHED"}
    assert off(addon, ob) > 1.5, "two drawings do not tell"
    mark(addon, ob)
    bpy.ops.rototoon.update_in_betweens()
    assert drawn_again(addon, ob) == [], "an update keeps the choice"
    bpy.ops.rototoon.in_between(spacing="LINEAR")
    assert off(addon, ob) < 0.002


def test_on_twos_every_drawing_follows(addon):
    ob = arm(addon)
    assert bpy.ops.rototoon.in_between(step=2) == {"FINISHED"}
    assert np.abs(points(addon, ob, 5)[0] - bar(5)).max() < 0.002


@pytest.mark.parametrize("frames", [[f for f in range(1, LAST + 1) if f != 6], range(1, LAST), []])
def test_a_part_that_is_not_known_all_the_way_is_not_followed(addon, frames):
    ob = arm(addon, frames)
    bpy.ops.rototoon.in_between(spacing="LINEAR")
    assert off(addon, ob) > 1.5
    mark(addon, ob)
    bpy.ops.rototoon.in_between(spacing="LINEAR", follow=False)
    assert drawn_again(addon, ob) == [], "where nothing is captured the choice is none"


def test_a_contour_that_is_no_place_is_not_followed(addon):
    ob = arm(addon)
    move(addon, ob, 4, by=np.nan, layer="Contours")
    assert bpy.ops.rototoon.in_between(spacing="LINEAR") == {"FINISHED"}
    assert off(addon, ob) > 1.5


def test_layers_that_lie_elsewhere_and_what_carries_them(addon):
    away = np.array([5.0, -2.0])
    ob = arm(addon, shape=lambda frame: bar(frame) - away)
    ob.data.layers["Contours"].translation = (away[0], 0, away[1])
    bpy.context.view_layer.update()
    bpy.ops.rototoon.in_between(spacing="LINEAR")
    assert off(addon, ob) < 0.002, "the layer's own place counts"
    empty = bpy.data.objects.new("Body", None)
    bpy.context.scene.collection.objects.link(empty)
    ob.data.layers["Contours"].parent = empty
    bpy.context.view_layer.update()
    bpy.ops.rototoon.update_in_betweens()
    assert off(addon, ob) > 1.5, "what another thing carries moves against the lines"
    ob.data.layers["Lines"].parent = empty
    bpy.context.view_layer.update()
    bpy.ops.rototoon.update_in_betweens()
    assert off(addon, ob) < 0.002, "one thing carries both"


def test_what_hangs_on_a_peg_goes_with_that(addon):
    ob = arm(addon)
    bpy.ops.rototoon.in_between(spacing="LINEAR", pegs="LAYERS")
    assert off(addon, ob) > 1.5


def test_a_capture_that_changes_touches_its_own_span(addon):
    ob = arm(addon)
    add(addon, ob, "Lines", 19, [bar(LAST) + [2.0, 0.0]])
    bpy.ops.rototoon.in_between(frames="ALL")
    mark(addon, ob)
    bpy.ops.rototoon.update_in_betweens()
    assert drawn_again(addon, ob) == []
    move(addon, ob, 6, index=slice(None), by=0.5, layer="Contours")
    bpy.ops.rototoon.update_in_betweens()
    assert drawn_again(addon, ob) == list(range(2, LAST))
    assert points(addon, ob, 6)[0] == pytest.approx(bar(6) + [0.5, 0], abs=0.002)


def test_what_was_drawn_before_there_was_the_choice_stays(addon):
    ob = arm(addon)
    bpy.ops.rototoon.in_between(spacing="LINEAR", follow=False)
    kept = json.loads(ob.data["rototoon_tween"])
    del kept["Lines"]["spans"]["1"]["choices"]["follow"]
    ob.data["rototoon_tween"] = json.dumps(kept)
    mark(addon, ob)
    assert bpy.ops.rototoon.update_in_betweens() == {"FINISHED"}
    assert drawn_again(addon, ob) == []
    move(addon, ob, 1, by=0.01)
    bpy.ops.rototoon.update_in_betweens()
    assert drawn_again(addon, ob) == list(range(2, LAST)) and off(addon, ob) > 1.5


def test_drawings_follow_what_was_tracked_anew(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    ob.data.layers.new("Lines").frames.new(1)
    gp, st = addon("blender.grease_pencil"), addon("blender.strokes")
    gp.make_frames(ob.data.layers["Lines"], [9], gp.KEYFRAME)
    for frame in (1, 9):
        source, target = (gp.drawings(layer)[frame][0] for layer in (shots.layer_of(ob), ob.data.layers["Lines"]))
        st.add(target, st.chosen(st.read(source), [1]))
    bpy.context.scene.frame_set(1)

    def square(frame):
        handle = gp.drawings(ob.data.layers["Lines"])[frame][0]
        return shots.mapping(addon, ob, frame).to_pixels(gp.positions(handle, 4))

    bpy.ops.rototoon.in_between(spacing="EASE_IN")
    assert all(np.abs(square(frame) - shots.square(frame - 1)).max() < 0.05 for frame in range(2, 9))
    shots.move(addon, ob, 5, 2, (4.0, -9.0))
    bpy.ops.rototoon.track()
    bpy.ops.rototoon.update_in_betweens()
    assert np.abs(square(5) - shots.square(4) - (4.0, -9.0)).max() < 0.05
    assert np.abs(square(4) - shots.square(3)).max() < 0.05

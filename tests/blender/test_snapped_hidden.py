"""The layer with the hidden lines of snapped ones: Snap to Ink and Clear Generated take away what is old there, and nothing of the artist's."""

import bpy
import numpy as np
import pytest
import shots
from line_stage import kinds, said

LAYER = "Snapped Hidden"
FRAMES = range(1, 10)


@pytest.fixture
def cut(addon, fake, tmp_path):
    """Two parts that lie over each other, tracked, snapped, and cut: the hidden lines are on their own layer."""
    ob = shots.set_up(tmp_path)
    over = lambda f: shots.square(f).mean(0) + 1.2 * (shots.square(f) - shots.square(f).mean(0)) + (8, 3)  # noqa: E731
    for frame in (1, 9):
        shots.draw(addon, ob, frame, [shots.square(frame - 1), over(frame - 1)])
    bpy.ops.rototoon.track()
    bpy.ops.rototoon.snap()
    assert bpy.ops.rototoon.hidden_lines(action="MOVE", covers="CLOSED", frames="RANGE") == {"FINISHED"}
    assert set(kinds(addon, ob, LAYER)) == set(FRAMES) and strokes(addon, ob, 5)
    return ob


def strokes(addon, ob, frame, layer=LAYER):
    gp = addon("blender.grease_pencil")
    drawings = gp.drawings(ob.data.layers[layer])
    return len(gp.offsets(drawings[frame][0])) - 1 if frame in drawings else 0


def moved(addon, ob, frame, layer=LAYER):
    gp = addon("blender.grease_pencil")
    handle = gp.drawings(ob.data.layers[layer])[frame][0]
    gp.put(handle, "position", gp.positions(handle, int(gp.offsets(handle)[-1])) + np.float32(0.05))


def test_snap_takes_the_hidden_lines_away(addon, cut):
    bpy.ops.rototoon.snap()
    assert kinds(addon, cut, LAYER) == {}
    assert set(kinds(addon, cut, "Snapped")) == set(FRAMES)
    assert said(addon).warnings == ()


def test_clear_generated_clears_the_hidden_lines(addon, cut):
    bpy.ops.rototoon.clear_generated()
    assert kinds(addon, cut, LAYER) == {} and kinds(addon, cut, "Snapped") == {}
    assert bpy.ops.rototoon.clear_generated.poll() is False


def test_clear_generated_on_one_frame_clears_that_frame(addon, cut):
    bpy.context.scene.frame_set(5)
    bpy.ops.rototoon.clear_generated(frames="CURRENT")
    assert set(kinds(addon, cut, LAYER)) == set(FRAMES) - {5}


def test_clear_generated_leaves_snapped_lines_if_it_shall(addon, cut):
    bpy.ops.rototoon.clear_generated(snapped=False)
    assert set(kinds(addon, cut, LAYER)) == set(FRAMES)
    assert bpy.ops.rototoon.clear_generated() == {"FINISHED"}, "what is left can be cleared later"
    assert kinds(addon, cut, LAYER) == {}


@pytest.mark.parametrize("name", ["snap", "clear_generated"])
def test_hidden_lines_that_the_artist_changed_stay(addon, cut, name):
    moved(addon, cut, 4)
    getattr(bpy.ops.rototoon, name)()
    assert kinds(addon, cut, LAYER) == {4: "KEYFRAME"} and strokes(addon, cut, 4)
    assert "that you had changed on frame 4 stays, as a key" in said(addon).text


@pytest.mark.parametrize("name", ["snap", "clear_generated"])
def test_hidden_lines_of_a_snapped_drawing_that_stays_stay(addon, cut, name):
    moved(addon, cut, 6, "Snapped")
    getattr(bpy.ops.rototoon, name)()
    assert kinds(addon, cut, "Snapped")[6] == "KEYFRAME"
    assert kinds(addon, cut, LAYER) == {6: "GENERATED"} and strokes(addon, cut, 6)


@pytest.mark.parametrize("close", ["lock", "hide"])
def test_a_closed_layer_of_hidden_lines_stays_and_is_named(addon, cut, close):
    setattr(cut.data.layers[LAYER], close, True)
    bpy.ops.rototoon.snap()
    assert set(kinds(addon, cut, LAYER)) == set(FRAMES)
    (warning,) = said(addon).warnings
    assert warning.startswith(f'left as it was: the layer "{LAYER}" is ')


def test_cutting_twice_keeps_the_lines_generated(addon, cut):
    bpy.ops.rototoon.hidden_lines(action="MOVE", covers="CLOSED", frames="RANGE")
    bpy.ops.rototoon.snap()
    assert kinds(addon, cut, LAYER) == {}


def test_a_part_that_is_hidden_has_no_hidden_lines(addon, cut):
    gp = addon("blender.grease_pencil")
    before = {frame: strokes(addon, cut, frame) for frame in FRAMES}
    handle = gp.drawings(cut.data.layers[LAYER])[5][0]
    (number,) = set(gp.value(handle, gp.PART, before[5]).tolist())
    cut.rototoon.active_part = next(k for k, part in enumerate(cut.rototoon.parts) if part.number == number)
    bpy.context.scene.frame_set(5)
    bpy.ops.rototoon.hide_part()
    assert strokes(addon, cut, 5) == 0 and strokes(addon, cut, 4) == before[4]


@pytest.mark.usefixtures("library")
def test_a_layer_of_the_artist_that_is_called_hidden_covers_and_is_cut(addon):
    from test_strokes import add, circle, content, drawing_object

    ob = drawing_object(addon, ("Lines", "Arm Hidden", "Top"))
    add(addon, ob, "Lines", 1, [[(-2, 0), (2, 0)]])
    add(addon, ob, "Arm Hidden", 1, [circle((0, 0), 0.5)], cyclic=True)
    add(addon, ob, "Top", 1, [circle((0.5, 0), 0.2)], cyclic=True)
    bpy.context.scene.frame_set(1)
    bpy.ops.rototoon.hidden_lines(covers="CLOSED", action="MOVE")
    assert len(content(addon, ob, "Lines", 1).sizes) == 2 and "Lines Hidden" in ob.data.layers
    assert not content(addon, ob, "Arm Hidden", 1).strokes("cyclic").any()
    # What was moved aside neither covers nor is cut again.
    bpy.ops.rototoon.hidden_lines(covers="CLOSED", action="MOVE")
    assert addon("scripting").take_reports()[-1].text == "Nothing is hidden"


@pytest.mark.usefixtures("library")
def test_locked_layers_ask_nothing(addon):
    from test_strokes import add, drawing_object

    ob = drawing_object(addon)
    add(addon, ob, "Lines", 1, [[(-2, 0), (2, 0)]])
    ob.data.layers["Lines"].lock = True
    assert not addon("strokes.operators.hidden_lines").ROTOTOON_OT_hidden_lines._cuts_own_keys(ob)

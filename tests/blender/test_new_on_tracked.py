"""Strokes that an artist draws on tracked frames: corrections of known parts, or new parts."""

import bpy
import numpy as np
import pytest
import shots
from line_stage import opened

TURN = np.linspace(0, 2 * np.pi, 14, endpoint=False)
CIRCLE = np.column_stack([np.cos(TURN), np.sin(TURN)])
FAR = (130.0, 15.0)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Where the tracked scene is kept."""
    return tmp_path_factory.mktemp("tracked")


@pytest.fixture
def tracked(addon, library, folder):
    """The diamond (Part 1) and the square (Part 2), tracked with the real library from frame 1 to 9. The first test tracks them."""

    def track():
        shots.two_keys(addon, folder)
        bpy.ops.rototoon.track()

    return opened(folder / "frame", "tracked", track)


def keys(addon, ob):
    return {part.name: sorted(part.keys) for part in addon("capture.contours").read(ob).parts}


def said(addon, name):
    scripting = addon("scripting")
    scripting.take_reports()
    getattr(bpy.ops.rototoon, name)()
    return [(report.kind, report.text) for report in scripting.take_reports()][-1]


def tracked_contour(addon, ob, frame, part):
    return dict(shots.pixels(addon, ob, frame))[part]


def delete(addon, ob, frame, part):
    gp = addon("blender.grease_pencil")
    handle, _ = gp.drawings(shots.layer_of(ob))[frame]
    numbers = gp.value(handle, gp.PART, len(gp.offsets(handle)) - 1)
    gp.remove_strokes(handle, np.flatnonzero(numbers == part).tolist())


@pytest.mark.parametrize(
    "shape",
    [
        CIRCLE * 4 + FAR,
        CIRCLE * 14 + FAR,
        np.array([[0.0, 70], [160, 70], [160, 90], [0, 90]]),
        CIRCLE * 3 + shots.square(4).mean(0) + (4, -3),
        np.array([[-14.0, -14], [-9, -16], [-7, -28], [7, -28], [9, -16], [14, -14]]) + shots.square(4).mean(0),
        np.array([[150.0, 5], [152, 5], [152, 60], [150, 60]]),
    ],
    ids=["a small ball in the sky", "a ball in the sky", "the ground", "an eye", "a hat", "a cane"],
)
def test_a_new_part_on_a_tracked_frame_leaves_the_others_alone(addon, tracked, shape):
    before = {part: tracked_contour(addon, tracked, 5, part) for part in (1, 2)}
    shots.draw(addon, tracked, 5, [shape])
    _, text = said(addon, "track")
    assert keys(addon, tracked) == {"Part 1": [1, 9], "Part 2": [1, 9], "Part 3": [5]}
    for part, points in before.items():
        assert np.abs(tracked_contour(addon, tracked, 5, part) - points).max() < 0.5
    assert 'new parts: "Part 3" on 5' in text


@pytest.mark.parametrize("by", ["layer", "material"])
def test_a_layer_or_a_material_of_its_own_makes_a_new_part(addon, tracked, by):
    gp = addon("blender.grease_pencil")
    if by == "layer":
        tracked.data.layers.new("Contours.eye")
        tracked.rototoon.contours_layer = "Contours.eye"
    drawing = shots.draw(addon, tracked, 5, [shots.square(4) + (2.0, 0.0)])
    tracked.rototoon.contours_layer = "Contours"
    if by == "material":
        tracked.data.materials.append(tracked.data.materials[0].copy())
        values = gp.value(drawing, "material_index", len(drawing.strokes))
        values[-1] = len(tracked.data.materials) - 1
        gp.put(drawing, "material_index", values)
    bpy.ops.rototoon.match_contours()
    assert keys(addon, tracked) == {"Part 1": [1, 9], "Part 2": [1, 9], "Part 3": [5]}


@pytest.mark.parametrize("degrees", [0, 25])
def test_a_contour_drawn_again_near_the_tracked_one_is_its_key_and_named(addon, tracked, degrees):
    centre, angle = shots.square(4).mean(0), np.radians(degrees)
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    shots.draw(addon, tracked, 5, [np.roll((shots.square(4) - centre) @ turn + centre + (5.0, 2.0), 1, 0)[::-1]])
    kind, text = said(addon, "match_contours")
    assert (kind, text) == ("INFO", '1 stroke matched: "Part 2" on 5; 0 new parts')
    assert keys(addon, tracked)["Part 2"] == [1, 5, 9]


def test_a_contour_that_was_deleted_and_drawn_far_away_is_its_key(addon, tracked):
    delete(addon, tracked, 5, 2)
    shots.draw(addon, tracked, 5, [shots.square(4) + (70.0, 30.0)])
    kind, text = said(addon, "track")
    assert keys(addon, tracked) == {"Part 1": [1, 9], "Part 2": [1, 5, 9]}
    assert kind == "INFO" and 'new strokes are keys of "Part 2" on 5' in text


def test_a_lost_part_is_found_elsewhere_by_its_shape_and_size(addon, tracked):
    gp = addon("blender.grease_pencil")
    handle, _ = gp.drawings(shots.layer_of(tracked))[5]
    numbers = gp.value(handle, gp.PART, len(gp.offsets(handle)) - 1)
    gp.put(handle, gp.CONFIDENCE, np.where(np.repeat(numbers == 2, 4), 0.1, 0.95).astype(np.float32))
    shots.draw(addon, tracked, 5, [shots.square(4) + (70.0, 30.0)])
    bpy.ops.rototoon.match_contours()
    assert keys(addon, tracked) == {"Part 1": [1, 9], "Part 2": [1, 5, 9]}


def test_a_stroke_that_looks_like_a_sure_part_elsewhere_is_a_new_part_and_the_message_names_both(addon, tracked):
    shots.draw(addon, tracked, 5, [shots.square(4) + (70.0, 30.0)])
    kind, text = said(addon, "match_contours")
    assert keys(addon, tracked) == {"Part 1": [1, 9], "Part 2": [1, 9], "Part 3": [5]}
    assert kind == "WARNING" and 'frame 5: the new stroke is the new part "Part 3", though it looks like "Part 2"' in text


def test_a_doubtful_key_is_named_with_what_to_do(addon, tracked):
    shots.draw(addon, tracked, 5, [shots.square(4) * 0.7 + shots.square(4).mean(0) * 0.3])
    kind, text = said(addon, "track")
    assert keys(addon, tracked)["Part 2"] == [1, 5, 9] and kind == "WARNING"
    assert 'frame 5: the new stroke is taken as a key of "Part 2", but it has another size or shape' in text
    assert "undo, give it a material or a layer of its own" in text


def test_live_says_in_the_panel_what_it_doubts(addon, fake, live, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    ob.rototoon.live = True
    shots.draw(addon, ob, 5, [shots.square(4) * 0.7 + shots.square(4).mean(0) * 0.3])
    live.note(ob)
    now = 1e9
    for _ in range(50):
        if live.step(now) is None:
            break
        if live._run is not None:
            live._run.worker.join()
    assert live.status(ob)[0].startswith('frame 5: the new stroke is taken as a key of "Part 2"')


def test_a_part_that_was_deleted_leaves_a_stroke_of_another_size_alone(addon, tracked):
    delete(addon, tracked, 5, 2)
    shots.draw(addon, tracked, 5, [CIRCLE * 4 + FAR])
    bpy.ops.rototoon.match_contours()
    assert keys(addon, tracked) == {"Part 1": [1, 9], "Part 2": [1, 9], "Part 3": [5]}


def test_both_parts_drawn_again_on_a_tracked_frame_are_both_found(addon, tracked):
    shots.draw(addon, tracked, 5, [np.roll(shots.square(4), 2, 0) + 2.0, shots.diamond(4)[::-1] - 1.0])
    kind, text = said(addon, "match_contours")
    assert (kind, text) == ("INFO", '2 strokes matched: "Part 1" on 5, "Part 2" on 5; 0 new parts')
    assert keys(addon, tracked) == {"Part 1": [1, 5, 9], "Part 2": [1, 5, 9]}

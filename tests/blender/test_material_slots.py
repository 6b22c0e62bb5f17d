"""Material slots in another order, with other names, or fewer: what was painted and traced is as it was. With the real library."""

import bpy
import looks
import numpy as np
import pytest
from line_stage import attribute, film, handle_of, kinds, opened, pictures, said, traced  # noqa: F401 - fixtures
from test_paint import GREEN, LAYER, click, colour_at, places


@pytest.fixture
def painted(addon, film, pictures):  # noqa: F811
    """The film, painted from clicks on frame 1. It has a material that nothing uses."""

    def paint():
        looks.second_material(film)
        for place, colour in places(1):
            click(film, place, colour)
        assert bpy.ops.rototoon.fill_drawings() == {"FINISHED"}

    return opened(pictures, "painted with slots", paint)


def move_slot(ob, index, direction):
    ob.active_material_index = index
    assert bpy.ops.object.material_slot_move(direction=direction) == {"FINISHED"}


def swap_first(ob):
    move_slot(ob, 0, "DOWN")


def move_last_up(ob):
    move_slot(ob, len(ob.data.materials) - 1, "UP")


def remove_unused(ob):
    count = len(ob.data.materials)
    bpy.ops.object.material_slot_remove_unused()
    assert len(ob.data.materials) < count


def rename(ob):
    for material in ob.data.materials:
        material.name = f"My {material.name}"


CHANGES = [swap_first, move_last_up, remove_unused, rename]


def own(addon, ob, frame):
    """The strokes of a painted drawing that count as the artist's."""
    return len(addon("paint.sheets").read(ob, LAYER)[frame].own)


@pytest.mark.parametrize("change", CHANGES)
def test_painted_regions_stay_generated(addon, painted, change):
    before = {frame: own(addon, painted, frame) for frame in range(1, 7)}
    assert before == {1: 4, **dict.fromkeys(range(2, 7), 0)}
    change(painted)
    assert {frame: own(addon, painted, frame) for frame in range(1, 7)} == before
    click(painted, places(1)[1][0], GREEN)
    bpy.ops.rototoon.fill_drawings()
    for frame in range(1, 7):
        assert colour_at(addon, painted, frame, places(frame)[1][0]) == pytest.approx(GREEN, abs=1e-3), frame
    bpy.ops.rototoon.clear_fills()
    assert list(kinds(addon, painted, LAYER)) == [1]


@pytest.mark.parametrize("change", CHANGES)
def test_another_material_of_a_painted_region_is_a_change(addon, painted, change):
    change(painted)
    gp, handle = addon("blender.grease_pencil"), handle_of(addon, painted, LAYER, 3)
    index = attribute(addon, painted, LAYER, 3, "material_index")
    was, index[0] = index[0], next(int(k) for k in index if k != index[0])
    gp.put(handle, "material_index", index)
    assert own(addon, painted, 3) == 1
    index[0] = was
    gp.put(handle, "material_index", index)
    assert own(addon, painted, 3) == 0


def test_paint_of_a_file_of_the_version_before_is_generated(addon, painted):
    gp, drawings, st = (addon(name) for name in ("blender.grease_pencil", "lines.drawings", "blender.strokes"))
    for frame in range(2, 7):
        handle = handle_of(addon, painted, LAYER, frame)
        gp.put(handle, gp.LOOK, drawings.look_sums(st.read(handle)))
    assert all(own(addon, painted, frame) == 0 for frame in range(2, 7))


@pytest.mark.parametrize("before", [False, True])
def test_paint_of_an_earlier_blender_is_generated_when_its_fills_become_attributes(addon, film, monkeypatch, before):  # noqa: F811
    gp, drawings, st = (addon(name) for name in ("blender.grease_pencil", "lines.drawings", "blender.strokes"))
    monkeypatch.setattr(gp, "FILL_BY_ID", False)
    for place, colour in places(1):
        click(film, place, colour)
    bpy.ops.rototoon.fill_drawings()
    handles = {frame: handle_of(addon, film, LAYER, frame) for frame in range(2, 7)}
    for handle in handles.values() if before else ():
        gp.put(handle, gp.LOOK, drawings.look_sums(st.read(handle)))
    monkeypatch.setattr(gp, "FILL_BY_ID", True)
    for handle in handles.values():
        strokes = len(gp.offsets(handle)) - 1
        gp.put(handle, "fill_id", np.arange(1, strokes + 1, dtype=np.int32))
        gp.put(handle, "hide_stroke", np.ones(strokes, bool))
    assert all(own(addon, film, frame) == 0 for frame in handles)
    bpy.ops.rototoon.clear_fills()
    assert list(kinds(addon, film, LAYER)) == [1]


@pytest.mark.parametrize("change", [swap_first, rename])
def test_only_the_edited_stroke_is_edited_on_all_frames(addon, traced, change):  # noqa: F811
    gp = addon("blender.grease_pencil")
    looks.second_material(traced)
    change(traced)
    handle = handle_of(addon, traced, "Lines", 3)
    points = gp.positions(handle, int(gp.offsets(handle)[-1]))
    points[1, 2] += 0.05
    gp.put(handle, "position", points)
    number = attribute(addon, traced, "Lines", 3, gp.TRACK)[0]
    before = {frame: attribute(addon, traced, "Lines", frame, "radius") for frame in (2, 5)}
    bpy.context.scene.frame_set(3)
    bpy.ops.rototoon.spread_edits()
    assert said(addon).text == "1 edited stroke, on 5 other frames"
    for frame, radii in before.items():
        others = attribute(addon, traced, "Lines", frame, gp.LINE) != number
        assert np.array_equal(attribute(addon, traced, "Lines", frame, "radius")[others], radii[others])
    with pytest.raises(RuntimeError, match="No stroke on this frame differs"):
        bpy.ops.rototoon.spread_edits()

"""Remove Hidden Lines: over time, with fills that nobody sees, and of outlines without a line. With the real library."""

import bpy
import numpy as np
import pytest
from test_strokes import add, circle, content, drawing, drawing_object, fills

pytestmark = [pytest.mark.every_version, pytest.mark.usefixtures("library")]


def level(first=-3.0, last=3.0):
    x = np.linspace(first, last, 61)
    return np.stack([x, 0 * x], 1)


def cover(addon, ob, layer, frame, centre, radius=1.0):
    drawn = add(addon, ob, layer, frame, [circle(centre, radius, 400)], cyclic=True)
    fills(addon, ob, layer, frame, [1])
    return drawn


def behind(addon, layers=("Lines", "Front"), last=10):
    """A line from -3 to 3, held from frame 1 on, and empty layers in front of it."""
    ob = drawing_object(addon, layers)
    add(addon, ob, "Lines", 1, [level()])
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 1, last
    return ob


def ends(addon, ob, layer="Lines"):
    """By frame the first and the last x of each stroke."""
    found = {}
    for frame in sorted(addon("blender.grease_pencil").drawings(ob.data.layers[layer])):
        own = content(addon, ob, layer, frame)
        x = own.point["position"][:, 0]
        found[frame] = [(round(float(x[a]), 1), round(float(x[b - 1]), 1)) for a, b in zip(own.starts, own.starts[1:])]
    return found


def messages(addon):
    return " / ".join(each.text for each in addon("common.reports").take())


def test_what_an_earlier_run_moved_aside_shows_on_new_frames_too(addon):
    ob = behind(addon, ("Lines", "Front", "Front 2"))
    cover(addon, ob, "Front", 1, (0, 0))
    bpy.ops.rototoon.hidden_lines(action="MOVE", frames="RANGE")
    cover(addon, ob, "Front 2", 5, (2.5, 0), 0.2)
    bpy.ops.rototoon.hidden_lines(action="MOVE", frames="RANGE")
    assert ends(addon, ob) == {1: [(-3, -1), (1, 3)], 5: [(-3, -1), (1, 2.3), (2.7, 3)]}
    assert ends(addon, ob, "Lines Hidden") == {1: [(-1, 1)], 5: [(-1, 1), (2.3, 2.7)]}
    # A drawing that comes between is another one: nothing of the earlier one is hidden there.
    add(addon, ob, "Lines", 3, [level(-2, 0)])
    bpy.ops.rototoon.hidden_lines(action="MOVE", frames="RANGE")
    assert ends(addon, ob, "Lines Hidden") == {1: [(-1, 1)], 3: [(-1, 0)], 5: [(-1, 1), (2.3, 2.7)]}


@pytest.mark.parametrize("action", ["REMOVE", "MOVE"])
def test_frames_after_the_range_show_what_they_showed(addon, action):
    ob = behind(addon)
    gp = addon("blender.grease_pencil")
    cover(addon, ob, "Front", 1, (0, 0))
    cover(addon, ob, "Front", 20, (0, 50))
    bpy.ops.rototoon.hidden_lines(frames="RANGE", action=action)
    assert ends(addon, ob) == {1: [(-3, -1), (1, 3)], 20: [(-3, 3)]}
    assert gp.drawings(ob.data.layers["Lines"])[20][1] == gp.GENERATED
    if action == "MOVE":
        assert ends(addon, ob, "Lines Hidden") == {1: [(-1, 1)], 20: []}
    # Where the line is cut already, there is nothing to keep.
    bpy.ops.rototoon.hidden_lines(frames="RANGE", action=action)
    assert list(ends(addon, ob)) == [1, 20]


@pytest.mark.parametrize("frames, drawn", [("CURRENT", 5), ("RANGE", 15)])
def test_what_is_moved_aside_ends_with_its_drawing(addon, frames, drawn):
    ob = behind(addon, ("Lines", "Front", "Front 2"))
    cover(addon, ob, "Front", 1, (0, 0))
    add(addon, ob, "Lines", drawn, [level(-2, 2)])
    bpy.ops.rototoon.hidden_lines(frames=frames, action="MOVE")
    assert ends(addon, ob) == {1: [(-3, -1), (1, 3)], drawn: [(-2, 2)]}
    assert ends(addon, ob, "Lines Hidden") == {1: [(-1, 1)], drawn: []}
    bpy.context.scene.frame_set(drawn)
    bpy.ops.rototoon.hidden_lines(action="MOVE")
    assert ends(addon, ob, "Lines Hidden") == {1: [(-1, 1)], drawn: [(-1, 1)]}
    bpy.context.scene.frame_set(1)
    cover(addon, ob, "Front 2", 1, (2.5, 0), 0.2)
    bpy.ops.rototoon.hidden_lines(action="MOVE")
    assert ends(addon, ob, "Lines Hidden")[drawn] == [(-1, 1)]


def test_nothing_is_added_after_the_range_where_nothing_changes_there(addon):
    ob = behind(addon)
    cover(addon, ob, "Front", 1, (0, 0))
    bpy.ops.rototoon.hidden_lines(frames="RANGE")
    assert list(ends(addon, ob)) == [1]


def _clear_fill(alpha):
    def change(ob, layer, handle, gp):
        material = ob.data.materials[int(gp.value(handle, "material_index", 1)[0])]
        material.grease_pencil.fill_color[3] = alpha

    return change


def _fill_opacity(ob, layer, handle, gp):
    gp.put(handle, "fill_opacity", np.array([0.0]))


def _layer_opacity(value):
    def change(ob, layer, handle, gp):
        layer.opacity = value

    return change


def _hidden_material(ob, layer, handle, gp):
    ob.data.materials[int(gp.value(handle, "material_index", 1)[0])].grease_pencil.hide = True


def _masked(ob, layer, handle, gp):
    layer.use_masks = True
    ob.data.layers.new("Mask")
    ob.data.layers.active = layer
    bpy.ops.grease_pencil.layer_mask_add(name="Mask")


def _blended(ob, layer, handle, gp):
    layer.blend_mode = "MULTIPLY"


@pytest.mark.parametrize(
    "change, named",
    [
        (_clear_fill(0.0), False), (_clear_fill(0.2), True), (_fill_opacity, False), (_layer_opacity(0.0), False),
        (_layer_opacity(0.3), True), (_hidden_material, False), (_masked, True), (_blended, True),
    ],
)  # fmt: skip
def test_lines_behind_a_fill_that_does_not_hide_them_stay(addon, change, named):
    ob, gp = behind(addon), addon("blender.grease_pencil")
    if gp.FILL_BY_ID:
        # Lines and fills have materials of their own.
        ob.data.materials.append(ob.data.materials[0].copy())
    handle = cover(addon, ob, "Front", 1, (0, 0))
    if gp.FILL_BY_ID:
        gp.put(handle, "material_index", np.array([1]))
    change(ob, ob.data.layers["Front"], handle, gp)
    messages(addon)
    bpy.ops.rototoon.hidden_lines()
    assert ends(addon, ob) == {1: [(-3, 3)]}
    assert ('"Front": the fills are transparent, masked or blended' in messages(addon)) == named


@pytest.mark.parametrize("hides", [False, True])
def test_the_fill_is_that_of_the_material_that_the_object_shows(addon, hides):
    ob, gp = behind(addon), addon("blender.grease_pencil")
    handle = cover(addon, ob, "Front", 1, (0, 0))
    place = int(gp.value(handle, "material_index", 1)[0])
    slot, seen = ob.material_slots[place], ob.data.materials[place].copy()
    seen.grease_pencil.fill_color[3], ob.data.materials[place].grease_pencil.fill_color[3] = float(hides), float(not hides)
    slot.link, slot.material = "OBJECT", seen
    bpy.ops.rototoon.hidden_lines()
    assert ends(addon, ob) == {1: [(-3, -1), (1, 3)] if hides else [(-3, 3)]}


@pytest.mark.parametrize("slot", ["none", "empty", "mesh"])
def test_a_fill_without_a_material_hides_lines(addon, slot):
    ob = behind(addon)
    if not addon("blender.grease_pencil").FILL_BY_ID:
        pytest.skip("materials fill")
    cover(addon, ob, "Front", 1, (0, 0))
    if slot == "none":
        ob.data.materials.clear()
    else:
        ob.data.materials[0] = bpy.data.materials.new("Mesh") if slot == "mesh" else None
    bpy.ops.rototoon.hidden_lines()
    assert ends(addon, ob) == {1: [(-3, -1), (1, 3)]}


def test_a_mask_that_is_switched_off_changes_nothing(addon):
    ob, gp = behind(addon), addon("blender.grease_pencil")
    layer = ob.data.layers["Front"]
    _masked(ob, layer, cover(addon, ob, "Front", 1, (0, 0)), gp)
    layer.use_masks = False
    bpy.ops.rototoon.hidden_lines()
    assert ends(addon, ob) == {1: [(-3, -1), (1, 3)]}


def test_outlines_without_a_line_are_no_lines(addon):
    """Two solid blacks, one over the other."""
    ob, gp = drawing_object(addon), addon("blender.grease_pencil")
    handle = add(addon, ob, "Lines", 1, [circle((0, 0), 1, 80), circle((1, 0), 1, 80)], cyclic=True)
    fills(addon, ob, "Lines", 1, [1, 2])
    if gp.FILL_BY_ID:
        gp.put(handle, "hide_stroke", np.ones(2, bool))
    else:
        ob.data.materials[1].grease_pencil.show_stroke = False
    before = content(addon, ob, "Lines", 1)
    messages(addon)
    bpy.ops.rototoon.hidden_lines()
    assert messages(addon) == "Nothing is hidden" and content(addon, ob, "Lines", 1).equals(before)


@pytest.mark.parametrize("kind", ["CATMULL_ROM", "BEZIER", "NURBS"])
def test_curves_of_other_types_cover_and_are_said_not_to_be_cut(addon, kind):
    ob, gp = behind(addon), addon("blender.grease_pencil")
    # Drawings have points of their own after it, too.
    front = add(addon, ob, "Front", 1, [circle((0, 0), 1, 24), circle((0, 5), 1, 30)], cyclic=True)
    fills(addon, ob, "Front", 1, [1, 2])
    add(addon, ob, "Lines", 1, [level() + [0, 5]])
    front.set_types(type=kind, indices=[0])
    if kind == "NURBS":
        gp.put(front, "nurbs_order", np.array([4, 4], np.int8))
    messages(addon)
    bpy.ops.rototoon.hidden_lines()
    (lines,) = ends(addon, ob).values()
    assert np.abs(np.array(lines) - [(-3, -1), (1, 3)] * 2).max() < 0.06
    assert "cannot be cut" not in messages(addon)
    line = add(addon, ob, "Lines", 1, [level() + [0, 0.2], level() + [0, 3]])
    line.set_types(type=kind, indices=[4, 5])
    if kind == "NURBS":
        gp.put(line, "nurbs_order", np.full(6, 4, np.int8))
    bpy.ops.rototoon.hidden_lines()
    assert "not cut: 1 hidden line is a curve" in messages(addon) and len(content(addon, ob, "Lines", 1).sizes) == 6


def test_the_materials_that_the_object_shows_count(addon):
    """Slots that are linked to the object: the materials of its data are not seen."""
    ob, gp = behind(addon), addon("blender.grease_pencil")
    ob.data.materials.append(ob.data.materials[0].copy())
    gp.put(cover(addon, ob, "Front", 1, (0, 0)), "material_index", np.array([1]))
    slot = ob.material_slots[1]
    clear = slot.material.copy()
    clear.grease_pencil.fill_color[3] = 0.0
    slot.link, slot.material = "OBJECT", clear
    bpy.ops.rototoon.hidden_lines()
    assert ends(addon, ob) == {1: [(-3, 3)]}

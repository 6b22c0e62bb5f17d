"""Layers in groups, and new layers: what a hidden group hides, a group that has the name of a layer, and the layer on which the artist draws."""

import bpy
import pytest
import shots
from test_strokes import content, scene


def into_group(ob, layer, **options):
    """Puts a layer into a new group."""
    group = ob.data.layer_groups.new("Group")
    ob.data.layers.move_to_layer_group(layer, group)
    for name, value in options.items():
        setattr(group, name, value)
    return group


def test_what_a_hidden_group_hides_covers_no_line(addon, library):
    ob = scene(addon)
    group = into_group(ob, ob.data.layers["Front"], hide=True)
    before = content(addon, ob, "Back", 1)
    bpy.ops.rototoon.hidden_lines()
    assert content(addon, ob, "Back", 1).equals(before)
    group.hide = False
    bpy.ops.rototoon.hidden_lines()
    assert list(content(addon, ob, "Back", 1).sizes) == [11, 11]


def test_without_a_visible_layer_hidden_lines_say_so(addon):
    ob = scene(addon)
    for name in ("Back", "Front"):
        into_group(ob, ob.data.layers[name], hide=True)
    with pytest.raises(RuntimeError, match="No drawings are visible"):
        bpy.ops.rototoon.hidden_lines()


def test_contours_of_a_hidden_group_have_no_marks(addon, tmp_path):
    gp, overlay = addon("blender.grease_pencil"), addon("ui.overlay")
    ob = shots.set_up(tmp_path)
    drawing = shots.draw(addon, ob, 1, [shots.square(0)])
    gp.put(drawing, gp.MADE, [True])
    gp.put(drawing, gp.PIN, [True, False, False, False])
    gp.set_keyframe_type(shots.layer_of(ob), {1: gp.GENERATED})
    assert overlay.gather(ob, 1)
    into_group(ob, shots.layer_of(ob), hide=True)
    assert overlay.gather(ob, 1) == []


def test_the_artist_goes_on_drawing_on_the_active_layer(addon, tmp_path):
    gp, hierarchy = addon("blender.grease_pencil"), addon("blender.hierarchy")
    ob = shots.set_up(tmp_path)
    gp.layer(ob, ob.rototoon.snapped_layer)
    hierarchy.beside(ob, shots.layer_of(ob), "Contours Hidden")
    assert ob.data.layers.active == shots.layer_of(ob)


def test_the_first_layer_is_active(addon):
    gp = addon("blender.grease_pencil")
    ob = gp.new_object("Drawing", bpy.context.collection)
    assert ob.data.layers.active is None
    made = gp.layer(ob, "Lines")
    assert ob.data.layers.active == made


def named(ob, name):
    """Gives a group the name of a layer. Blender then has no layer of that name."""
    ob.data.layer_groups.new(name)
    return [layer.name for layer in ob.data.layers]


@pytest.mark.parametrize("call", ["trace_drawing", "paint_bucket"])
def test_a_group_of_a_layers_name_is_told_and_nothing_is_made(addon, tmp_path, call):
    ob = shots.set_up(tmp_path)
    setting, options = {"trace_drawing": ("lines_layer", {}), "paint_bucket": ("fills_layer", {"place": (30, 30)})}[call]
    name = getattr(ob.rototoon, setting)
    before = named(ob, name)
    with pytest.raises(RuntimeError, match=f'group of "{ob.name}" is called "{name}".*give the group another name'):
        getattr(bpy.ops.rototoon, call)(**options)
    assert [layer.name for layer in ob.data.layers] == before


def test_a_group_of_the_contours_name_is_told_to_scripts(addon, tmp_path):
    ob = shots.set_up(tmp_path)
    gp = addon("blender.grease_pencil")
    gp.remove_layer(ob, shots.layer_of(ob))
    before = named(ob, ob.rototoon.contours_layer)
    with pytest.raises(RuntimeError, match="give the group another name"):
        addon("scripting").set_key(ob, 1, {"square": shots.square(0)})
    assert [layer.name for layer in ob.data.layers] == before


def test_snap_says_that_a_group_has_the_layers_name(addon, library, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    before = named(ob, ob.rototoon.snapped_layer)
    for _ in range(2):
        with pytest.raises(RuntimeError, match="give the group another name"):
            bpy.ops.rototoon.snap()
    assert [layer.name for layer in ob.data.layers] == before


def test_the_new_layer_of_traced_lines_is_active(addon, library, tmp_path):
    ob = shots.set_up(tmp_path)
    assert bpy.ops.rototoon.trace_drawing(frames="CURRENT") == {"FINISHED"}
    assert ob.data.layers.active.name == ob.rototoon.lines_layer
    ob.data.layers.active = shots.layer_of(ob)
    bpy.ops.rototoon.trace_drawing()
    assert ob.data.layers.active == shots.layer_of(ob), "afterwards the artist chooses"


RESULTS = {"snap": ("snapped_layer", {}), "trace_drawing": ("lines_layer", {}), "paint_bucket": ("fills_layer", {"place": (30, 30)})}
"""By button the setting with the layer on which it draws."""


@pytest.mark.parametrize("call", RESULTS)
@pytest.mark.parametrize("name", ["Contours Results", "Contours.results"])
def test_a_layer_of_results_has_no_name_of_contours(addon, library, fake, tmp_path, call, name):
    ob = shots.two_keys(addon, tmp_path)
    bpy.ops.rototoon.track()
    setting, options = RESULTS[call]
    setattr(ob.rototoon, setting, name)
    before = shots.snapshot(ob)
    with pytest.raises(RuntimeError, match=f'The layer "{name}" counts as contours, since its name begins with "Contours"'):
        getattr(bpy.ops.rototoon, call)(**options)
    assert shots.snapshot(ob) == before and name not in ob.data.layers
    setattr(ob.rototoon, setting, "Contoursish")
    assert getattr(bpy.ops.rototoon, call)(**options) == {"FINISHED"}

"""Attributes of the artist's own on keys reach the strokes that Rototoon generates: tracked, snapped and carried ones."""

import bpy
import line_shots as ls
import numpy as np
import pytest
import shots
from line_stage import film, handle_of, pictures  # noqa: F401 - fixtures


def own(handle, name, kind, domain, values):
    """Gives a drawing an attribute."""
    attribute = handle.attributes.new(name, kind, domain)
    attribute.data.foreach_set("vector" if kind == "FLOAT_VECTOR" else "value", np.asarray(values).ravel())


def read(addon, handle, name):
    """Type, domain and values of an attribute."""
    gp, found = addon("blender.grease_pencil"), handle.attributes[name]
    return found.data_type, found.domain, gp.get(handle, name, len(found.data))


def keys(addon, ob):
    """The drawings of the two keys, of two parts of four points each, with own attributes."""
    drawings = addon("blender.grease_pencil").drawings(shots.layer_of(ob))
    for frame, low in ((1, 0.0), (9, 1.0)):
        handle = drawings[frame][0]
        own(handle, "weight", "FLOAT", "POINT", np.full(8, low, np.float32))
        own(handle, "flag", "BOOLEAN", "POINT", [True, False, False, False] * 2)
        own(handle, "group", "INT", "CURVE", [3, 5] if frame == 1 else [4, 6])
        own(handle, "way", "FLOAT_VECTOR", "CURVE", np.array([[low, 0, 1]] * 2, np.float32))
    own(drawings[9][0], "late", "INT8", "CURVE", [7, 7])
    return drawings


def test_tracked_and_snapped_contours_have_the_attributes_of_the_keys(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    gp = addon("blender.grease_pencil")
    keys(addon, ob)
    bpy.ops.rototoon.track()
    bpy.ops.rototoon.snap()
    for layer in ("Contours", "Snapped"):
        handle = gp.drawings(ob.data.layers[layer])[5][0]
        kind, domain, weight = read(addon, handle, "weight")
        assert (kind, domain) == ("FLOAT", "POINT") and weight == pytest.approx(0.5), layer
        kind, domain, flag = read(addon, handle, "flag")
        starts = gp.offsets(handle)
        assert (kind, domain) == ("BOOLEAN", "POINT") and [flag[a] for a in starts[:-1]] == [True, True] and not flag.all(), layer
        assert [read(addon, handle, "group")[k] for k in (0, 1)] == ["INT", "CURVE"]
        assert sorted(read(addon, handle, "group")[2]) == [3, 5], "those of the key before"
        assert read(addon, handle, "way")[2] == pytest.approx(np.array([[0.5, 0, 1]] * 2)), layer
        assert read(addon, handle, "late")[2].tolist() == [0, 0], "the key before has none"
    assert read(addon, gp.drawings(shots.layer_of(ob))[5][0], "flag")[2].tolist() == [True, False, False, False] * 2
    assert addon("scripting").take_reports()[-1].warnings == ()


def test_tracking_again_follows_the_keys_and_writes_nothing_else(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    gp = addon("blender.grease_pencil")
    drawings = keys(addon, ob)
    bpy.ops.rototoon.track()
    before = read(addon, gp.drawings(shots.layer_of(ob))[5][0], "weight")[2]
    bpy.ops.rototoon.track()
    assert np.array_equal(read(addon, gp.drawings(shots.layer_of(ob))[5][0], "weight")[2], before)
    assert read(addon, drawings[1][0], "group")[2].tolist() == [3, 5], "keys are left as they are"
    gp.put(gp.drawings(shots.layer_of(ob))[1][0], "weight", np.full(8, 0.5, np.float32))
    bpy.ops.rototoon.track()
    assert read(addon, gp.drawings(shots.layer_of(ob))[5][0], "weight")[2] == pytest.approx(0.75)


def test_an_attribute_of_the_same_name_and_another_type_stays(addon, fake, tmp_path):
    ob = shots.two_keys(addon, tmp_path)
    gp = addon("blender.grease_pencil")
    bpy.ops.rototoon.track()
    own(gp.drawings(shots.layer_of(ob))[5][0], "weight", "INT", "CURVE", [8, 9])
    keys(addon, ob)
    bpy.ops.rototoon.track()
    kind, domain, values = read(addon, gp.drawings(shots.layer_of(ob))[5][0], "weight")
    assert (kind, domain, values.tolist()) == ("INT", "CURVE", [8, 9])
    assert read(addon, gp.drawings(shots.layer_of(ob))[4][0], "weight")[2] == pytest.approx(0.375)


def test_carried_strokes_have_the_attributes_of_the_drawings_around_them(addon, film):
    gp = addon("blender.grease_pencil")
    for frame, low in ((1, 0.0), (6, 10.0)):
        ls.put(addon, film, "Ink", frame, [(ls.lines(frame - 1)[4][0], False)])
        handle = handle_of(addon, film, "Ink", frame)
        count = int(gp.offsets(handle)[-1])
        own(handle, "weight", "FLOAT", "POINT", np.linspace(low, low + 1, count, dtype=np.float32))
        own(handle, "half", "INT", "POINT", np.arange(count) * 2 // count)
        own(handle, "share", "FLOAT", "CURVE", np.array([low], np.float32))
        own(handle, "group", "INT", "CURVE", [frame])
    before = {frame: addon("blender.strokes").read(handle_of(addon, film, "Ink", frame)).point["weight"] for frame in (1, 6)}
    bpy.ops.rototoon.carry_strokes()
    handle = handle_of(addon, film, "Ink", 3)
    kind, domain, weight = read(addon, handle, "weight")
    assert (kind, domain) == ("FLOAT", "POINT") and weight[0] == pytest.approx(4, abs=1e-4) and weight[-1] == pytest.approx(5, abs=1e-4)
    assert (np.diff(weight) > 0).all()
    half = read(addon, handle, "half")[2]
    assert half[0] == 0 and half[-1] == 1 and set(np.diff(half)) == {0, 1}
    assert read(addon, handle, "share")[2] == pytest.approx([4]) and read(addon, handle, "group")[2].tolist() == [1]
    for frame, values in before.items():
        assert np.array_equal(addon("blender.strokes").read(handle_of(addon, film, "Ink", frame)).point["weight"], values)
    layer = addon("lines.drawings").read(film, ["Ink"])[0]
    assert sorted(layer.made) == [2, 3, 4, 5], "they count as they were generated"
    gp.put(handle, "group", np.array([2], np.int32))
    bpy.ops.rototoon.carry_strokes()
    assert read(addon, handle_of(addon, film, "Ink", 3), "group")[2].tolist() == [2], "what the artist changed is the artist's"

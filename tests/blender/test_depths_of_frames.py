"""Parts that cross: the depths that a document gives single frames are the order of the strokes there."""

import json

import bpy
import numpy as np
import pytest
import shots

FRAMES = range(5)
DEPTHS = {"2": 9.0, "3": 9.0, "4": 9.0}
"""The part that is behind is in front from the third picture on."""


def square(x):
    return [[x, 20.0], [x + 30, 20.0], [x + 30, 50.0], [x, 50.0]]


def part(name, depth, keys, **more):
    tracks = {str(frame): square(20.0 + 4 * frame) for frame in FRAMES}
    entry = {"name": name, "closed": True, "depth": depth, "keys": {str(frame): tracks[str(frame)] for frame in keys}, "tracks": tracks}
    return {**entry, "confidence": {frame: [1.0] * 4 for frame in tracks}, **more}


@pytest.fixture
def crossing(addon, fake, tmp_path):
    """The object of a document with a far part that comes in front on the third picture."""

    def make(keys=(0, 4), **more):
        shots.draw_sequence(tmp_path / "frames", first=0)
        shot = {"pattern": "frames/shot_%03d.png", "first": 0, "last": 4, "fps": 25, "width": 160, "height": 90}
        parts = [part("far", 1.0, keys, depths=DEPTHS, **more), part("near", 5.0, keys, **more)]
        (tmp_path / "in.json").write_text(json.dumps({"rototoon": 1, "footage": shot, "parts": parts}))
        assert bpy.ops.rototoon.import_document(filepath=str(tmp_path / "in.json"), keep_numbers=True) == {"FINISHED"}
        return bpy.context.object

    return make


def order(addon, ob, frame, layer=None):
    """The parts on a frame from back to front."""
    gp = addon("blender.grease_pencil")
    handle = gp.drawings(layer or shots.layer_of(ob))[frame][0]
    names = {item.number: item.name for item in ob.rototoon.parts}
    return [names[number] for number in gp.value(handle, gp.PART, len(gp.offsets(handle)) - 1).tolist()]


def swapped(addon, ob, frames=FRAMES, layer=None):
    return [order(addon, ob, frame, layer) for frame in frames] == [["far", "near"] if frame < 2 else ["near", "far"] for frame in frames]


def test_strokes_of_a_document_are_in_the_order_of_their_frame(addon, crossing):
    assert swapped(addon, crossing())


def test_one_key_and_its_track_too(addon, crossing):
    assert swapped(addon, crossing(keys=(3,)))


def test_the_order_stays_when_the_parts_are_tracked_again(addon, crossing):
    ob = crossing()
    assert bpy.ops.rototoon.track() == {"FINISHED"}
    assert swapped(addon, ob)


def test_snapped_lines_have_the_order_of_their_frame(addon, crossing):
    paths = {str(frame): [np.linspace(a, b, 5).tolist() for a, b in zip(box, box[1:] + box[:1])] for frame in FRAMES for box in [square(20.0 + 4 * frame)]}
    ob = crossing(curves=paths)
    assert swapped(addon, ob, layer=ob.data.layers[ob.rototoon.snapped_layer])


def test_a_depth_on_no_frame_is_no_depth(addon, crossing):
    ob = crossing()
    for item in ob.rototoon.parts:
        item.extra = json.dumps({"depths": {"x": 3, "2": "near", "3": 9.0}}) if item.name == "far" else ""
    assert bpy.ops.rototoon.track() == {"FINISHED"}
    assert [order(addon, ob, frame) for frame in (1, 2)] == [["far", "near"]] * 2
    assert order(addon, ob, 3) == ["near", "far"]

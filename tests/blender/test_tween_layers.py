"""In-betweens of layers that groups, parents or animation carry; strokes that leave the picture; a spacing curve."""

import json
import math

import bpy
import layouts
import numpy as np
import pytest
from test_strokes import add, drawing_object
from test_tween import drawn_again, figure, frames, keyed, limb, mark, points

pytestmark = pytest.mark.usefixtures("library")


def turned(shape, centre, angle):
    c, s = math.cos(angle), math.sin(angle)
    return (np.asarray(shape) - centre) @ np.array([[c, s], [-s, c]]) + centre


def away(found, wanted):
    """Largest distance of two sets of strokes."""
    return max(np.abs(a - b).max() for a, b in zip(found, wanted, strict=True))


SHOULDER = np.array([4.0, 3.0])
ARM = [limb(5, 2.2, -0.4, 20, 1.5), limb(5.5, 3.4, -1.2, 26, 2.0)]
HAND = [limb(8, 1, 0.3, 18, 1.0)]
WRIST = np.array([7.5, 1.2])
BODY = [limb(2, -1, 1.5, 30, 4.0), limb(1, 0, 1.0, 24, 2.0)]


def puppet(shift, arm, hand):
    """Body, arm and hand: the body shifts, the arm turns about the shoulder, the hand about the wrist."""
    swing = lambda shape, more=0.0: turned(turned(shape, WRIST, more), SHOULDER, arm) + [shift, 0]  # noqa: E731
    body = [stroke + [shift, 0] for stroke in BODY]
    return body, [swing(s) for s in ARM], [swing(s, hand) for s in HAND]


def grouped(addon, poses):
    """The puppet on keys; layers in groups that lie in each other."""
    ob = drawing_object(addon, ("Body", "Arm", "Arm Colour", "Hand"))
    layers = ob.data.layers
    outer = ob.data.layer_groups.new("Puppet")
    arm = ob.data.layer_groups.new("Whole Arm", parent_group=outer)
    hand = ob.data.layer_groups.new("Whole Hand", parent_group=arm)
    for layer, group in (("Body", outer), ("Arm", arm), ("Arm Colour", arm), ("Hand", hand)):
        layers.move_to_layer_group(layers[layer], group)
    for frame, pose in poses.items():
        body, upper, lower = puppet(*pose)
        for layer, strokes in (("Body", body), ("Arm", upper), ("Arm Colour", upper[:1]), ("Hand", lower)):
            add(addon, ob, layer, frame, strokes)
    bpy.context.scene.frame_set(min(poses))
    return ob


def test_layer_groups_are_pegs(addon):
    ob = grouped(addon, {1: (0, 0, 0), 11: (3.0, 1.8, -1.0)})
    assert bpy.ops.rototoon.in_between(pegs="GROUPS", spacing="LINEAR") == {"FINISHED"}
    for frame in (3, 6, 10):
        share = (frame - 1) / 10
        body, arm, hand = puppet(3.0 * share, 1.8 * share, -share)
        for layer, wanted in (("Body", body), ("Arm", arm), ("Arm Colour", arm[:1]), ("Hand", hand)):
            assert away(points(addon, ob, frame, layer), wanted) < 0.02, (layer, frame)


def test_pegs_of_layers_follow_the_spacing(addon):
    ob = grouped(addon, {1: (0, 0, 0), 11: (3.0, 1.8, 0)})
    chart = "curve", "0 0, 0.5 0.2, 1 1"
    assert bpy.ops.rototoon.in_between(pegs="LAYERS", spacing="CURVE", **{chart[0]: chart[1]}) == {"FINISHED"}
    body, arm, _ = puppet(3.0 * 0.2, 1.8 * 0.2, 0)
    assert away(points(addon, ob, 6, "Body"), body) < 0.02
    assert away(points(addon, ob, 6, "Arm"), arm) < 0.05
    assert bpy.ops.rototoon.in_between(pegs="LAYERS", spacing="EASE_IN") == {"FINISHED"}
    assert away(points(addon, ob, 6, "Body"), puppet(3.0 * 0.25, 0, 0)[0]) < 0.02


def test_pegs_of_layers_run_smoothly_through_keys(addon):
    ob = grouped(addon, {1: (0, 0, 0), 11: (2.0, 0.8, 0), 21: (4.0, 1.6, 0)})
    assert bpy.ops.rototoon.in_between(pegs="GROUPS", frames="ALL") == {"FINISHED"}
    at = np.array([points(addon, ob, frame, "Body")[0][0, 0] for frame in range(1, 22)])
    steps = np.diff(at)
    assert (steps > 0).all() and steps[9] == pytest.approx(steps[10], rel=0.05), "one velocity through the key"
    assert steps[0] < 0.5 * steps[9] and steps[-1] < 0.5 * steps[9], "out of rest and into it"
    mark(addon, ob, "Hand")
    assert bpy.ops.rototoon.update_in_betweens() == {"FINISHED"}
    assert drawn_again(addon, ob, "Hand") == [], "nothing had changed"
    kept = json.loads(ob.data["rototoon_tween"])["Body"]["spans"]["1"]["choices"]
    assert kept["pegs"] == "GROUPS"


def test_layers_of_one_parent_are_drawn_together(addon):
    ob = keyed(addon, layers=("Lines", "Colour"))
    tween = addon("rototoon.tween")
    called, real = [], tween.draw_in_betweens
    empty = bpy.data.objects.new("Hand", None)
    bpy.context.scene.collection.objects.link(empty)
    for layer in ob.data.layers:
        layer.parent = empty
    bpy.context.view_layer.update()
    try:
        tween.draw_in_betweens = lambda *a, **k: called.append(1) or real(*a, **k)
        bpy.ops.rototoon.in_between(spacing="LINEAR", arcs=0.0)
        assert len(called) == 1
        assert away(points(addon, ob, 5, "Lines"), points(addon, ob, 5, "Colour")) < 1e-3
        ob.data.layers["Colour"].keyframe_insert("translation", frame=1)
        bpy.ops.rototoon.clear_in_betweens()
        called.clear()
        bpy.ops.rototoon.in_between(spacing="LINEAR", arcs=0.0)
        assert len(called) == 2, "a layer that is animated itself is carried on its own"
    finally:
        tween.draw_in_betweens = real


def test_strokes_leave_what_the_camera_shows(addon):
    ob = drawing_object(addon)
    add(addon, ob, "Lines", 1, [*figure(), limb(1, 1.5, 0.0, 20, 1.0)])
    add(addon, ob, "Lines", 11, figure(0.5))
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.scene.camera = camera
    camera.data.type, camera.data.ortho_scale = "ORTHO", 12.0
    scene = bpy.context.scene
    scene.render.resolution_x = scene.render.resolution_y = 200
    camera.location, camera.rotation_euler = (0, -10, 0), (math.pi / 2, 0, 0)
    bpy.context.view_layer.update()
    assert bpy.ops.rototoon.in_between(leaving="LEAVE", spacing="LINEAR") == {"FINISHED"}
    lone = [points(addon, ob, frame)[3] for frame in range(2, 11)]
    out = [float(np.abs(stroke).max()) for stroke in lone]
    assert out == sorted(out) and out[0] < 6 < out[-1], out
    size = lambda s: np.linalg.norm(np.diff(s, axis=0), axis=1).sum()  # noqa: E731
    assert size(lone[-1]) == pytest.approx(size(lone[0]), rel=0.02), "it moves out, it does not shrink"
    scene.camera = None
    mark(addon, ob)
    bpy.ops.rototoon.update_in_betweens()
    assert drawn_again(addon, ob) == list(range(2, 11)), "without a camera the picture lies about the drawing"


def test_a_spacing_curve(addon):
    ob = keyed(addon)
    layouts.draw(bpy.types.ROTOTOON_PT_tween)
    assert bpy.ops.rototoon.in_between(spacing="CURVE", arcs=0.0) == {"FINISHED"}
    assert ("curve", "mapping") in layouts.draw(bpy.types.ROTOTOON_PT_tween)
    spacing_curve = addon("tween.spacing_curve")
    mapping = spacing_curve.node().mapping
    curve = mapping.curves[0]
    while len(curve.points) > 2:
        curve.points.remove(curve.points[1])
    curve.points[0].location, curve.points[1].location = (0, 0), (1, 1)
    curve.points.new(0.5, 0.9)
    mapping.update()
    at = lambda: [points(addon, ob, frame)[0][:, 0].mean() for frame in (1, 5, 9)]  # noqa: E731
    bpy.ops.rototoon.update_in_betweens()
    first, middle, last = at()
    assert middle == pytest.approx((first + last) / 2, abs=0.05), "a span keeps the curve that it was made with"
    bpy.ops.rototoon.in_between(spacing="CURVE", arcs=0.0)
    first, middle, last = at()
    assert middle == pytest.approx(first + 0.9 * (last - first), abs=0.03)
    bpy.ops.rototoon.in_between(spacing="CURVE", arcs=0.0, curve="0 0, 0.5 0.1, 1 1")
    assert at()[1] == pytest.approx(first + 0.1 * (last - first), abs=0.03)
    for text, said in (("0 0, 1", "expected a time and a share"), ("2 0", "from 0 to 1"), ("0.5 0, 0.2 1", "times that rise")):
        with pytest.raises(RuntimeError, match=said):
            bpy.ops.rototoon.in_between(spacing="CURVE", curve=text)
    assert set(frames(addon, ob)) == set(range(1, 10))


def test_an_arm_on_its_own_layer_turns_about_its_shoulder_without_arcs(addon):
    arm = [np.stack([np.linspace(4.0, 9.0, 20), np.full(20, 3.0 + side)], 1) for side in (-0.3, 0.3)]
    ob = drawing_object(addon, ("Body", "Arm"))
    for frame, angle in ((1, -0.4), (9, 1.6)):
        add(addon, ob, "Body", frame, BODY)
        add(addon, ob, "Arm", frame, [turned(stroke, SHOULDER, angle) for stroke in arm])
    bpy.context.scene.frame_set(1)
    for arcs in (0.0, 0.5, 1.0):
        assert bpy.ops.rototoon.in_between(pegs="LAYERS", spacing="LINEAR", arcs=arcs) == {"FINISHED"}
        for frame in (3, 5, 7):
            wanted = [turned(stroke, SHOULDER, -0.4 + (frame - 1) / 4) for stroke in arm]
            assert away(points(addon, ob, frame, "Arm"), wanted) < 0.02, (arcs, frame)

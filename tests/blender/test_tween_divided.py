"""The spacing of a span that a breakdown divides: its in-betweens keep their share of the way."""

import json

import bpy
import numpy as np
import pytest
from test_strokes import add, content, drawing_object
from test_tween import frames, keyed, move, points, wave_at

pytestmark = pytest.mark.usefixtures("library")
CHART = "3, 10, 22, 40, 60, 80, 94"
SPACINGS = {
    "CHART": {"chart": CHART},
    "CURVE": {"curve": "0.2 0.7, 0.6 0.3"},
    "BOUNCE": {"bounces": 2},
    **{name: {} for name in ("EASE_IN", "EASE_OUT", "EASE_IN_OUT", "COSINE", "LINEAR")},
}


def drawn(addon, spacing, keys=(1, 9), **more):
    """Two waves; one moves, the other stays, so that it can be corrected without a change of the way."""
    ob = drawing_object(addon)
    for frame, x in zip(keys, (0.0, 8.0)):
        add(addon, ob, "Lines", frame, [wave_at(x), wave_at(0) + [0, 6]])
    bpy.context.scene.frame_set(keys[0])
    bpy.ops.rototoon.in_between(spacing=spacing, **more)
    return ob


def ways(addon, ob, on):
    return [float(points(addon, ob, frame)[0][:, 0].mean()) for frame in on]


def correct(addon, ob, frame):
    move(addon, ob, frame, index=slice(20, 40), by=0.05)


@pytest.mark.parametrize("spacing", SPACINGS)
@pytest.mark.parametrize("frame", (2, 5, 8))
def test_in_betweens_beside_a_breakdown_keep_their_share_of_the_way(addon, spacing, frame):
    ob = drawn(addon, spacing, **SPACINGS[spacing])
    before = ways(addon, ob, range(1, 10))
    correct(addon, ob, frame)
    bpy.ops.rototoon.update_in_betweens()
    assert frames(addon, ob)[frame] == "BREAKDOWN"
    assert ways(addon, ob, range(1, 10)) == pytest.approx(before, abs=8e-3)


def test_breakdowns_divide_again_and_in_any_order(addon):
    ob = drawn(addon, "CHART", chart=CHART)
    before = ways(addon, ob, range(1, 10))
    for some in ((7,), (3, 5), (8,)):
        for frame in some:
            correct(addon, ob, frame)
        bpy.ops.rototoon.update_in_betweens()
    assert ways(addon, ob, range(1, 10)) == pytest.approx(before, abs=8e-3)


def test_a_breakdown_that_stands_elsewhere_shares_its_way_with_the_others(addon):
    ob = drawn(addon, "CHART", chart=CHART)
    move(addon, ob, 5, index=slice(None), by=1.6)
    bpy.ops.rototoon.update_in_betweens()
    shares = np.array([0, 3, 10, 22, 40, 60, 80, 94, 100]) / 100
    found = np.array(ways(addon, ob, range(1, 10)))
    middle = found[4] - found[0]
    assert found[:5] - found[0] == pytest.approx(middle * shares[:5] / 0.4, abs=8e-3)
    assert found[4:] - found[4] == pytest.approx((8 - middle) * (shares[4:] - 0.4) / 0.6, abs=8e-3)


def test_a_breakdown_that_goes_gives_the_whole_spacing_back(addon):
    ob = drawn(addon, "CHART", chart=CHART)
    before = ways(addon, ob, range(1, 10))
    for frame in (3, 5):
        correct(addon, ob, frame)
    bpy.ops.rototoon.update_in_betweens()
    for frame in (5, 3):
        ob.data.layers["Lines"].frames.remove(frame)
        bpy.ops.rototoon.update_in_betweens()
    assert ways(addon, ob, range(1, 10)) == pytest.approx(before, abs=1e-4)
    (span,) = json.loads(ob.data["rototoon_tween"])["Lines"]["spans"].values()
    assert span["choices"]["chart"] == CHART and span["choices"]["part"] == [0, 1]


def test_a_chart_on_twos_that_does_not_come_out_even(addon):
    ob = drawn(addon, "CHART", keys=(1, 8), chart="50, 60, 90", step=2)
    before = ways(addon, ob, (1, 3, 5, 7, 8))
    correct(addon, ob, 3)
    bpy.ops.rototoon.update_in_betweens()
    assert sorted(frames(addon, ob)) == [1, 3, 5, 7, 8], "frame 2 has no place of its own on twos"
    assert ways(addon, ob, (1, 3, 5, 7, 8)) == pytest.approx(before, abs=8e-3)


def test_half_a_chart_spreads_when_its_key_moves(addon):
    ob = drawn(addon, "CHART", chart=CHART)
    correct(addon, ob, 5)
    bpy.ops.rototoon.update_in_betweens()
    ob.data.layers["Lines"].frames.move(9, 13)
    bpy.ops.rototoon.update_in_betweens()
    found = ways(addon, ob, (5, 7, 9, 11, 13))
    assert found == pytest.approx([0.5 + 8 * share for share in (0.4, 0.6, 0.8, 0.94, 1.0)], abs=8e-3)


def test_in_between_with_the_same_settings_divides_too_and_with_others_does_not(addon):
    ob = drawn(addon, "CHART", chart=CHART)
    before = ways(addon, ob, range(1, 10))
    correct(addon, ob, 5)
    bpy.ops.rototoon.in_between(spacing="CHART", chart=CHART)
    assert ways(addon, ob, range(1, 10)) == pytest.approx(before, abs=8e-3)
    bpy.ops.rototoon.in_between(spacing="EASE_IN")
    assert ways(addon, ob, (1, 3, 5)) == pytest.approx([0.5, 0.5 + 0.25 * 3.2, 0.5 + 3.2], abs=8e-3)


def test_a_part_that_stands_still_is_even(addon):
    ob = drawn(addon, "CHART", chart="0 0 0 0 50 60 70")
    move(addon, ob, 5, index=slice(None), by=0.4)
    bpy.ops.rototoon.update_in_betweens()
    assert ways(addon, ob, range(1, 6)) == pytest.approx([0.5, 0.6, 0.7, 0.8, 0.9], abs=8e-3)
    assert np.isfinite(content(addon, ob, "Lines", 7).point["position"]).all()


def test_smooth_movements_go_through_a_breakdown_as_through_any_key(addon):
    ob = keyed(addon)
    bpy.ops.rototoon.in_between(spacing="SMOOTH")
    move(addon, ob, 5, index=slice(None), by=0.01)
    bpy.ops.rototoon.update_in_betweens()
    found = {frame: content(addon, ob, "Lines", frame).point["position"] for frame in range(1, 10)}
    bpy.ops.rototoon.clear_in_betweens()
    bpy.ops.rototoon.in_between(spacing="SMOOTH", frames="ALL")
    assert all(np.array_equal(content(addon, ob, "Lines", frame).point["position"], each) for frame, each in found.items())

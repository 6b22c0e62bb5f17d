"""The functions for scripts do what Trace Drawing and Carry Strokes do: the same layers, choices and messages."""

import bpy
import line_shots as ls
import pytest
from line_stage import film, pictures, traced  # noqa: F401 - fixtures
from line_stage import kinds


def counts(addon, ob, layer):
    gp = addon("blender.grease_pencil")
    return {frame: len(gp.offsets(handle)) - 1 for frame, (handle, _) in gp.drawings(ob.data.layers[layer]).items()}


def red(addon, ob, frame=1):
    ls.put(addon, ob, "Red", frame, [(ls.lines(0)[0][0] + 2.0, True)])


def options(addon, monkeypatch):
    """The options with which sessions trace."""
    given, tracing = [], addon("lines.tracing")
    worker = tracing.worker
    monkeypatch.setattr(tracing, "worker", lambda plan, options, *more: given.append((plan.hold, options)) or worker(plan, options, *more))
    return given


def test_the_same_run_as_that_of_the_operator(addon, traced, monkeypatch):
    given = options(addon, monkeypatch)
    settings = traced.rototoon
    settings.line_style, settings.line_sensitivity, settings.line_leave_out = "CLEAN", 1.5, True
    addon("blender.preferences").preferences().threads = 1
    red(addon, traced)
    traced.data.layers.active = traced.data.layers["Red"]
    for call in (
        lambda: bpy.ops.rototoon.carry_strokes(layers="ACTIVE"),
        lambda: addon("scripting").carry_strokes(traced, ["Red"]),
        lambda: bpy.ops.rototoon.carry_strokes(layers="ACTIVE", style="ROUGH", sensitivity=2.0, hold=False),
        lambda: addon("scripting").carry_strokes(traced, ["Red"], style="rough", sensitivity=2.0, hold=False),
    ):
        call()
    assert given[0] == given[1] and given[2] == given[3] and given[0] != given[2]
    assert given[1][1].threads == 1 and len(given[1][1].leave_out) == 1


def test_new_lines_are_on_the_layer_of_trace_drawing_if_it_is_among_the_layers(addon, traced):
    red(addon, traced)
    addon("scripting").carry_strokes(traced, ["Lines", "Red", "Red"])
    assert counts(addon, traced, "Red") == dict.fromkeys(range(1, 7), 1)
    assert counts(addon, traced, "Lines") == dict.fromkeys(range(1, 7), 6)


def test_layers_that_the_operator_leaves_alone_are_refused(addon, traced):
    scripting, settings = addon("scripting"), traced.rototoon
    red(addon, traced)
    settings.snapped_layer = "Red"
    with pytest.raises(RuntimeError, match='"Red" has snapped or hidden lines, or paint'):
        scripting.carry_strokes(traced, ["Red"])
    settings.snapped_layer = "Snapped"
    scripting.fill_region(traced, 1, ls.lines(0)[0][0].mean(0).tolist(), (1.0, 0.5, 0.2))
    with pytest.raises(RuntimeError, match=f'"{settings.fills_layer}" has snapped or hidden lines, or paint'):
        scripting.carry_strokes(traced, [settings.fills_layer])
    traced.data.layers["Red"].hide = True
    with pytest.raises(RuntimeError, match='the layer "Red" is hidden'):
        scripting.carry_strokes(traced, ["Red"])
    with pytest.raises(RuntimeError, match="layers: found none"):
        scripting.carry_strokes(traced, [])
    for value in (0.0, -1.0, 11.0):
        with pytest.raises(RuntimeError, match="sensitivity: found"):
            scripting.trace_drawing(traced, sensitivity=value)
    assert kinds(addon, traced, "Red") == {1: "KEYFRAME"}


def test_what_the_operator_warns_of_is_with_the_result(addon, film):
    addon("common.reports").take()
    bpy.ops.rototoon.trace_drawing(sensitivity=0.1)
    (report,) = addon("common.reports").take()
    found = addon("scripting").trace_drawing(film, sensitivity=0.1)
    assert "no line or hardly any was found" in report.text and found.warnings == report.warnings

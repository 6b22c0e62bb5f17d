"""Undo steps share the drawings that an edit does not touch: reading them must not make Blender copy them."""

import os
from pathlib import Path

import bpy
import live_stage
import numpy as np
import pytest
import shots

FRAMES, PARTS, POINTS, STEPS = 40, 10, 500, 5


def memory() -> float:
    """Memory of this process in MB."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6


def test_undo_steps_hold_only_what_an_edit_changed(addon, fake, tmp_path):
    addon("capture.sessions").matcher = lambda request: {
        "matches": [{"reference": i, "drawn": i, "points": r["points"]} for i, r in enumerate(request["drawn"])]
    }
    bpy.ops.rototoon.setup(filepath=str(shots.draw_sequence(tmp_path, count=FRAMES)))
    ob, live = bpy.context.object, addon("capture.live")
    bpy.context.view_layer.update()
    turn = np.linspace(0, 2 * np.pi, POINTS, endpoint=False)
    circle = 4 * np.stack([np.cos(turn), np.sin(turn)], 1)
    for frame in (1, FRAMES):
        shots.draw(addon, ob, frame, [circle + (10 + 5 * i, 40 + 0.1 * frame) for i in range(PARTS)])
    bpy.ops.rototoon.track()
    ob.rototoon.live = True

    def step(number):
        shots.move(addon, ob, 20, 3, (1.0 + number, 0.0), which=[1])
        ob.data.update_tag()
        bpy.context.view_layer.update()
        bpy.ops.ed.undo_push(message="move")
        # With pauses: a step that asks all the time would keep the thread from its work.
        live_stage.work_off(live)

    try:
        step(0)
        step(1)
        before = memory()
        for number in range(STEPS):
            step(2 + number)
        grown = memory() - before
    finally:
        live.reset()
    # All that is read of the drawings: position, tracked place, control number, pin.
    read = FRAMES * PARTS * POINTS * 29 / 1e6
    assert grown < STEPS * read / 3, f"{grown:.0f} MB in {STEPS} steps; the drawings that are read have {read:.0f} MB"

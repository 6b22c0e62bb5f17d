"""What the tests of the live mode share: its step in the place of the timer, and a scene that is tracked live."""

import math
import threading
import time

import bpy
import shots


def settle(live):
    """Has everything done that is due, as the timer would; the number of steps."""
    bpy.context.view_layer.update()
    return work_off(live)


def work_off(live):
    """As `settle`, but Blender reports no changes before."""
    for count in range(50000):
        if live.step(math.inf) is None:
            return count
        time.sleep(0.001)
    raise AssertionError("live never ends")


def switched_on(addon, live, folder):
    """Square and diamond keyed on frames 1, 5 and 9, tracked live."""
    ob = shots.two_keys(addon, folder)
    bpy.ops.rototoon.track()
    bpy.context.scene.frame_set(5)
    bpy.ops.rototoon.new_key()
    ob.rototoon.live = True
    settle(live)
    return ob


def session(addon, ob):
    return addon("capture.sessions").known(ob).session


def drawings(ob):
    """All strokes by frame of the contours layer."""
    return {frame: values for (layer, frame), values in shots.snapshot(ob)[0].items() if layer == "Contours"}


def hold(addon, monkeypatch):
    """Makes tracking wait for the returned event."""
    go, jobs = threading.Event(), addon("common.jobs")
    work = jobs.Worker._work
    monkeypatch.setattr(jobs.Worker, "_work", lambda self: (go.wait(10), work(self)))
    return go

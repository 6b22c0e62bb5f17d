"""Paint Bucket and Fill Drawings by mouse and keys in a window, on the small line film with the real library. A part of `press.py`."""

from __future__ import annotations

import types
from collections.abc import Callable
from pathlib import Path

import bpy
import line_shots as ls
import numpy as np
import press_scenes
import tab
import window
from bpy_extras.view3d_utils import location_3d_to_region_2d
from window import in_view, main_window, view

SKIN, EYE = (0.93, 0.76, 0.62), (0.2, 0.4, 0.9)
X = 140.0
"""Of the body's middle on the first picture, before it is scaled."""
BODY, LEFT, RIGHT = (np.array(place) * ls.SCALE for place in ((X, 160.0), (X - 16, 105.0), (X + 16, 105.0)))
"""Pixels in the body and in the eyes on the first picture."""
LINE = ls.lines(0)[0][0][80]
NEAR = 2e-3


class Stage:
    """The film, what the status line says, and what is found."""

    def __init__(self, addon, note: Callable[[str, str, str], None]):
        self.addon, self.note = addon, note
        self.status: list[str] = []
        kind = bpy.types.WorkSpace
        self._real = kind.status_text_set
        kind.status_text_set = lambda space, text: (self.status.append(text or ""), self._real(space, text))[1]

    def close(self) -> None:
        """Takes back what was changed in Blender."""
        bpy.types.WorkSpace.status_text_set = self._real

    @property
    def ob(self):
        """The drawing. Undo makes another object of it."""
        return bpy.context.view_layer.objects.active

    def colours(self) -> list:
        """The colours of body and eyes on the first frame, `None` where nothing is painted."""
        bucket = self.addon("paint.bucket")
        return [bucket.colour_at(self.ob, 1, place) for place in (BODY, LEFT, RIGHT)]

    def check(self, step: str, colours: list, status: str, running: bool) -> None:
        """Notes a step, with a fault where something else than this is painted, said or at work."""
        found, said, runs = self.colours(), self.status[-1] if self.status else "", at_work()
        wrong = [f"painted {found}, expected {colours}"] if not alike(found, colours) else []
        wrong += [f"status {said!r}, expected one with {status!r}"] if status not in said or (not status and said) else []
        wrong += [f"at work: {runs}, expected {running}"] if runs != running else []
        reports = "; ".join(report.text for report in self.addon("common.reports").take())
        self.note(step, "; ".join(filter(None, (said, reports))), "; ".join(wrong))

    def reported(self, step: str, text: str) -> None:
        """Notes a step, with a fault where the last report has not this text."""
        reports = [report.text for report in self.addon("common.reports").take()]
        self.note(step, "; ".join(reports), "" if reports and text in reports[-1] else f"reported {reports}, expected {text!r}")

    def clicked(self, place, **keys):
        """Clicks at a pixel of the footage."""
        yield from window.clicked(*on_screen(self.addon, self.ob, place), **keys)
        yield 0.5


def alike(found: list, wanted: list) -> bool:
    """Whether colours are equal."""
    return all((a is None) == (b is None) and (a is None or np.allclose(a, b, atol=NEAR)) for a, b in zip(found, wanted))


def at_work() -> bool:
    """Whether a modal operator of the extension is at work."""
    return any("ROTOTOON" in op.bl_idname for op in main_window().modal_operators)


def on_screen(addon, ob, place) -> np.ndarray:
    """The place in the window of a pixel of the footage."""
    layer = ob.data.layers[0]
    mapping = addon("blender.placement").Mapper(ob, [1], {}, [layer.name]).at(0, 1)
    world = addon("blender.camera").layer_to_world(ob, layer)
    point = world[:3, :3] @ mapping.to_layer(np.array([place]))[0] + world[:3, 3]
    _, region, _ = view()
    return np.array(location_3d_to_region_2d(region, view()[0].spaces.active.region_3d, point)) + (region.x, region.y)


def painted(addon, folder: Path, note: Callable[[str, str, str], None]):
    """Paints by mouse, undoes and leaves, then fills all drawings. Calls `note` with each step, what was said, and the fault."""
    press_scenes.film(addon, folder)
    stage = Stage(addon, note)
    try:
        yield from tab.shown()
        with in_view():
            bpy.ops.view3d.view_center_camera()
        yield 1.0
        yield from by_bucket(stage)
        yield from filled(stage)
        yield from stopped(stage)
    finally:
        stage.close()
        press_scenes.stand_in_again(addon)


def begun(operator: str) -> None:
    """Starts an operator as its button does."""
    with in_view():
        getattr(bpy.ops.rototoon, operator)("INVOKE_DEFAULT")


def by_bucket(stage: Stage):
    """Clicks, colours taken, clicks taken back, and both ways out."""
    bpy.ops.ed.undo_push(message="the film")
    begun("paint_bucket")
    yield 0.5
    stage.check("begun", [None] * 3, "0 regions filled.   Click into a region", True)
    stage.ob.rototoon.fill_colour = SKIN
    yield from stage.clicked(BODY)
    stage.check("a click", [SKIN, None, None], "1 region filled", True)
    yield from stage.clicked(LINE)
    stage.check("a click on a line", [SKIN, None, None], "There is a line here", True)
    stage.ob.rototoon.fill_colour = EYE
    yield from stage.clicked(LEFT)
    stage.check("another click", [SKIN, EYE, None], "2 regions filled", True)
    yield from stage.clicked(BODY, ctrl=True)
    stage.check("Ctrl-click takes a colour", [SKIN, EYE, None], "2 regions filled", True)
    yield from stage.clicked(RIGHT)
    stage.check("a click with it", [SKIN, EYE, SKIN], "3 regions filled", True)
    yield from typed_with_ctrl("Z")
    stage.check("Ctrl Z", [SKIN, EYE, None], "2 regions filled", True)
    yield from window.typed("ESC")
    yield 0.5
    stage.check("Esc", [SKIN, EYE, None], "", False)
    yield from typed_with_ctrl("Z")
    stage.check("Ctrl Z after it", [None] * 3, "", False)
    yield from typed_with_ctrl("Z", shift=True)
    stage.check("redone", [SKIN, EYE, None], "", False)
    begun("paint_bucket")
    yield 0.5
    yield from window.typed("ESC")
    yield 0.5
    stage.check("Esc without a click", [SKIN, EYE, None], "", False)
    yield from beside(stage)


def beside(stage: Stage):
    """Blender's own Undo takes no more than the clicks, and ends the work. Ctrl Z takes back a click over the sidebar, too."""
    begun("paint_bucket")
    yield 0.5
    stage.ob.rototoon.fill_colour = EYE
    yield from stage.clicked(RIGHT)
    stage.check("a third click", [SKIN, EYE, EYE], "1 region filled", True)
    yield from window.moved(*over_sidebar())
    yield 0.5
    with in_view():
        bpy.ops.ed.undo()
    yield from window.moved(*press_scenes.aside())
    yield 0.5
    stage.check("Blender's Undo", [SKIN, EYE, None], "", False)
    with in_view():
        bpy.ops.ed.redo()
    yield 0.5
    stage.check("Blender's Redo", [SKIN, EYE, EYE], "", False)
    with in_view():
        bpy.ops.ed.undo()
    begun("paint_bucket")
    yield 0.5
    stage.ob.rototoon.fill_colour = EYE
    yield from stage.clicked(RIGHT)
    yield from typed_with_ctrl("Z", at=over_sidebar())
    stage.check("Ctrl Z over the sidebar", [SKIN, EYE, None], "0 regions filled", True)
    yield from window.typed("ESC")
    yield 0.5
    stage.check("Esc there", [SKIN, EYE, None], "", False)


def over_sidebar() -> tuple[int, int]:
    """A place in the sidebar, below its panels."""
    region = view()[2]
    return region.x + region.width // 2, region.y + 20


def typed_with_ctrl(name: str, at: tuple[int, int] | None = None, **keys):
    """Presses a key with Ctrl, over the view or at a place."""
    x, y = at or press_scenes.aside()
    yield from window.moved(x, y)
    for value in ("PRESS", "RELEASE"):
        main_window().event_simulate(type=name, value=value, x=x, y=y, ctrl=True, **keys)
        yield window.PAUSE
    yield 0.5


def filled(stage: Stage):
    """Fill Drawings paints all frames, while the window goes on."""
    begun("fill_drawings")
    while at_work():
        yield 0.1
    stage.reported("Fill Drawings", "regions on 6 frames")
    yield from typed_with_ctrl("Z")
    stage.check("Ctrl Z after Fill Drawings", [SKIN, EYE, None], "", False)
    kept = [frame.frame_number for frame in stage.ob.data.layers["Paint"].frames]
    stage.note("its frames", str(kept), "" if kept == [1] else f"frames {kept} are painted, expected 1")


def stopped(stage: Stage):
    """While Fill Drawings works, the view can be zoomed; Esc ends it."""
    stage.addon("paint.filling").make = lambda *_: types.SimpleNamespace(fill=_endless, close=lambda: None)
    begun("fill_drawings")
    yield 0.5
    before = view()[0].spaces.active.region_3d.view_camera_zoom
    x, y = press_scenes.aside()
    yield from window.moved(x, y)
    main_window().event_simulate(type="WHEELUPMOUSE", value="PRESS", x=x, y=y)
    yield 0.5
    zoomed = view()[0].spaces.active.region_3d.view_camera_zoom != before
    stage.note("the wheel meanwhile", f"zoomed: {zoomed}", "" if zoomed else "the view was not zoomed")
    stage.check("Fill Drawings at work", [SKIN, EYE, None], "Fill Drawings: paint  50%", True)
    yield from window.typed("ESC")
    yield 0.5
    stage.reported("Esc", "Fill Drawings: stopped, nothing was changed")
    stage.check("after Esc", [SKIN, EYE, None], "", False)


def _endless(_frames, _sensitivity, _pictures, progress, **_options) -> None:
    """Work that goes on until it is stopped."""
    import time

    while progress(0.5, "paint"):
        time.sleep(0.02)

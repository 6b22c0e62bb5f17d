"""Paint Bucket: fills the regions of the picture in which the artist clicks."""

import bpy
import numpy as np
from bpy_extras import view3d_utils
from rototoon import RototoonError

from ...blender import windows
from ...blender.errors import Problem
from ...common import jobs
from ...common.operators import NAVIGATION, Reporting
from ...common.undone import Undone
from ...common.wording import counted
from ...lines.operators.tracing_base import OnFootage
from ...tween.operators.pairs_base import view_at
from .. import bucket

HELP = "Click into a region to fill it, Ctrl-click to take a colour, Ctrl Z to undo, Esc to leave"


class ROTOTOON_OT_paint_bucket(Reporting, OnFootage, bpy.types.Operator):
    bl_idname = "rototoon.paint_bucket"
    bl_label = "Paint Bucket"
    bl_description = (
        "Click into regions of the picture on the current frame to fill them with the colour of the panel, or to say that they have no paint. "
        "Ctrl-click a filled region to take its colour. Fill Drawings carries the colours to the other frames"
    )
    # Without REGISTER: repeating the operator with other settings would undo the artist's clicks.
    bl_options = {"UNDO"}

    place: bpy.props.FloatVectorProperty(
        name="Place", description="Pixel of the footage to fill, for scripts; negative for none", size=2, default=(-1.0, -1.0)
    )

    def execute(self, context):
        """Called by Blender."""
        jobs.clear_the_way()
        return self.attempt(lambda: self._once(context))

    def _once(self, context):
        if min(self.place) < 0:
            raise Problem("place: found none, expected a pixel of the footage")
        self.warn(self._fill(context, tuple(self.place)))
        return self.done("1 region stays without paint" if context.object.rototoon.fill_nothing else "1 region filled")

    def _fill(self, context, place: tuple[float, float]) -> str:
        """Fills a region, and returns what should be known of it at once."""
        ob = context.object
        colour = None if ob.rototoon.fill_nothing else tuple(ob.rototoon.fill_colour)
        done = bucket.paint(ob, context.scene.frame_current, place, colour, ob.rototoon.line_sensitivity)
        self._stack = [*self._stack, done]
        return done.told

    _stack: list[bucket.Before] = []
    _pushed: list[bucket.Before] = []
    """The clicks that Blender's undo knows."""
    _undone = None

    def invoke(self, context, _event):
        """Called by Blender: takes clicks until the artist leaves."""
        if bpy.app.background or context.window is None:
            return self.execute(context)
        jobs.clear_the_way()
        self._stack, self._pushed, self._undone = [], [], Undone()
        context.window.cursor_modal_set("PAINT_BRUSH")
        context.window_manager.modal_handler_add(self)
        self._tell(context)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        """Called by Blender."""
        if self._undone.happened:
            self._close(context)
            self.report({"WARNING"}, f"{self.bl_label} ends, since something was undone")
            return {"CANCELLED"}
        if event.type in {"ESC", "RIGHTMOUSE", "RET", "NUMPAD_ENTER"} and event.value == "PRESS":
            self._close(context)
            told = self.done(f"{counted(len(self._stack), 'region')} filled")
            # Without a click that Blender does not know of there is nothing to undo.
            return told if self._unknown() else {"CANCELLED"}
        if event.type == "Z" and event.ctrl and not event.shift:
            if event.value == "PRESS":
                self._try(context, lambda: self._take_back(context))
            return {"RUNNING_MODAL"}
        view = view_at(context, event)
        if view is None:
            # The colour in the panel may be changed meanwhile. Blender's Undo is in reach, too, and must not take more than the clicks.
            self._push()
            return {"PASS_THROUGH"}
        if event.type == "LEFTMOUSE":
            if event.value == "PRESS":
                self._try(context, lambda: self._clicked(context, event, *view))
            return {"RUNNING_MODAL"}
        return {"PASS_THROUGH"} if event.type in NAVIGATION or event.type in FRAMES else {"RUNNING_MODAL"}

    def _try(self, context, do) -> None:
        """Does something and tells how many regions are filled now, or why it could not be done."""
        try:
            # Another object may be active by now.
            why = self.lacking(context.object, self.changes)
            if why:
                raise Problem(why)
            self._tell(context, do() or "")
        except (Problem, RototoonError) as problem:
            context.workspace.status_text_set(f"{problem}.   {HELP}")

    def _unknown(self) -> bool:
        """Whether there are clicks, or clicks taken back, that Blender's undo does not know."""
        return len(self._stack) != len(self._pushed) or any(a is not b for a, b in zip(self._stack, self._pushed))

    def _push(self) -> None:
        """Makes an undo step of the clicks."""
        if self._unknown():
            bpy.ops.ed.undo_push(message=self.bl_label)
            self._pushed = self._stack

    def _take_back(self, context) -> None:
        if self._stack:
            bucket.take_back(context.object, self._stack[-1])
            self._stack = self._stack[:-1]

    def _clicked(self, context, event, region, view) -> str:
        ob, frame = context.object, context.scene.frame_current
        at = event.mouse_x - region.x, event.mouse_y - region.y
        start = np.array(view3d_utils.region_2d_to_origin_3d(region, view, at))
        way = np.array(view3d_utils.region_2d_to_vector_3d(region, view, at))
        place = bucket.pixel_of(ob, frame, start, way)
        if event.ctrl:
            found = bucket.taken_at(ob, frame, place)
            if found is not None:
                taken, ob.rototoon.fill_name = found
                ob.rototoon.fill_nothing = not taken
                ob.rototoon.fill_colour = taken or ob.rototoon.fill_colour
            return ""
        return self._fill(context, place)

    def _tell(self, context, told: str = "") -> None:
        told = f" {told[0].upper()}{told[1:]}." if told else ""
        context.workspace.status_text_set(f"{counted(len(self._stack), 'region')} filled.{told}   {HELP}")
        windows.redraw_views()

    def cancel(self, context):
        """Called by Blender when it loads a file or quits meanwhile."""
        self._close(context)

    def _close(self, context) -> None:
        if self._undone is not None:
            self._undone.stop()
            self._undone = None
        if context.window is not None:
            context.window.cursor_modal_restore()
        if context.workspace is not None:
            context.workspace.status_text_set(None)


FRAMES = {"LEFT_ARROW", "RIGHT_ARROW", "UP_ARROW", "DOWN_ARROW"}
"""Keys that go to other frames, which are painted too."""

CLASSES = (ROTOTOON_OT_paint_bucket,)

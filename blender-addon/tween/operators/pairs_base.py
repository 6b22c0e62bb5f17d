"""Base of the operators that show which strokes of two drawings are the same, and let the artist change it by clicks."""

import bpy
import numpy as np

from ...blender import windows
from ...common import jobs
from ...common.operators import NAVIGATION, OnDrawing, Reporting
from ...common.undone import Undone
from ...common.wording import joined
from .. import pair_overlay, pairing

HELP = "Click two strokes to pair them, Alt-click one to free it, Ctrl Z to undo, Esc to leave"


class Pairing(OnDrawing, Reporting):
    """Shows pairs of strokes in the 3D view. Without a window it matches, and stores the result."""

    help = HELP

    def make_pairing(self, context) -> pairing.Pairing:
        """The pairing to show. Raises a `Problem` if there is none."""
        raise NotImplementedError

    _overlay = None
    _undone = None
    _timer = None
    _work = None
    _again = False

    def execute(self, context):
        """Called by Blender: matches, and stores the numbers."""
        jobs.clear_the_way()
        return self.attempt(lambda: self._match_and_store(context))

    def _match_and_store(self, context):
        self._pairing = self.make_pairing(context)
        self._pairing.take(self._pairing.match())
        self._pairing.store()
        self.warn(self._pairing.doubts())
        return self.done(self._pairing.summary())

    def invoke(self, context, _event):
        """Called by Blender: shows the pairs and lets them be changed."""
        if bpy.app.background or context.window is None:
            return self.execute(context)
        jobs.clear_the_way()
        return self.attempt(lambda: self._show(context))

    def _show(self, context):
        self._pairing = self.make_pairing(context)
        self._overlay = pair_overlay.PairOverlay(self._pairing)
        self._start()
        self._undone = Undone()
        self._timer = context.window_manager.event_timer_add(0.05, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        """Called by Blender."""
        if self._undone.happened:
            self._close(context)
            self.report({"WARNING"}, f"{self.bl_label} ends, since something was undone")
            return {"CANCELLED"}
        if event.type == "TIMER":
            return self._tick(context)
        if event.type in {"ESC", "RIGHTMOUSE", "RET", "NUMPAD_ENTER"} and event.value == "PRESS":
            return self._leave(context)
        if event.type == "LEFTMOUSE":
            view = view_at(context, event)
            # Buttons and menus get no clicks: they could change the drawings.
            if view is not None and event.value == "PRESS":
                self._clicked(context, event, *view)
            return {"RUNNING_MODAL"}
        if event.type == "Z" and event.ctrl and event.value == "PRESS":
            if self._pairing.undo():
                self._start()
            return {"RUNNING_MODAL"}
        return {"PASS_THROUGH"} if event.type in NAVIGATION else {"RUNNING_MODAL"}

    def _clicked(self, context, event, region, view) -> None:
        place = event.mouse_x - region.x, event.mouse_y - region.y
        matrix = np.array(view.perspective_matrix)
        item = self._pairing.pick(place, matrix, (region.width, region.height))
        changed = self._pairing.free(item) if event.alt else self._pairing.click(item)
        if changed:
            self._start()
        self._overlay.refresh()

    def _start(self) -> None:
        """Matches again. A running match is cancelled first."""
        if self._work is not None:
            self._work.cancel()
            self._again = True
            return
        self._work = jobs.Worker(lambda progress: self._pairing.match(progress))
        self._work.start()

    def _tick(self, context):
        if self._work is None:
            doubtful = sum(row.doubtful for row in self._pairing.pairs)
            said = joined(self._pairing.summary(), f"{doubtful} doubtful (?)" if doubtful else "")
            context.workspace.status_text_set(f"{self._pairing.keys()}: {said}.   {self.help}")
            return {"RUNNING_MODAL"}
        if not self._work.advance():
            context.workspace.status_text_set(f"Matching {self._work.fraction:4.0%}   {self.help}")
            return {"RUNNING_MODAL"}
        work, self._work = self._work, None
        if self._again:
            self._again = False
            self._start()
        elif work.error is not None:
            self.report({"ERROR"}, str(work.error))
            return self._leave(context)
        else:
            self._pairing.take(work.result)
            self._overlay.refresh()
        return {"RUNNING_MODAL"}

    def _leave(self, context):
        found = bool(self._pairing.pairs)
        self._close(context)
        if not found:
            return {"CANCELLED"}
        self._pairing.store()
        self.warn(self._pairing.doubts())
        return self.done(self._pairing.summary())

    def cancel(self, context):
        """Called by Blender when it loads a file or quits meanwhile."""
        self._close(context)

    def _close(self, context) -> None:
        if self._work is not None:
            self._work.cancel()
            self._work.join()
            if self._work.result is not None and not self._again and not self._undone.happened:
                self._pairing.take(self._work.result)
            self._work = None
        if self._undone is not None:
            self._undone.stop()
        if self._timer is not None:
            context.window_manager.event_timer_remove(self._timer)
            self._timer = None
        if self._overlay is not None:
            self._overlay.close()
            self._overlay = None
            windows.redraw_views()
        if context.workspace is not None:
            context.workspace.status_text_set(None)


def view_at(context, event):
    """The region and view of the 3D view under the mouse, if it is over one."""
    for area in context.window.screen.areas:
        if area.type != "VIEW_3D":
            continue
        inside = [r for r in area.regions if _holds(r, event)]
        if inside and all(region.type == "WINDOW" for region in inside):
            return inside[0], area.spaces.active.region_3d
    return None


def _holds(region, event) -> bool:
    across = region.x <= event.mouse_x < region.x + region.width
    return across and region.y <= event.mouse_y < region.y + region.height


"""What operators share: reasons, reports, and long work."""

from __future__ import annotations

import bpy

from ..blender import grease_pencil as gp
from ..blender.errors import Problem
from ..rototoon import Cancelled, RototoonError
from . import jobs

NAVIGATION = {
    "MIDDLEMOUSE",
    "WHEELUPMOUSE",
    "WHEELDOWNMOUSE",
    "WHEELINMOUSE",
    "WHEELOUTMOUSE",
    "TRACKPADPAN",
    "TRACKPADZOOM",
    "MOUSEROTATE",
    "NDOF_MOTION",
    "MOUSEMOVE",
    "INBETWEEN_MOUSEMOVE",
    "WINDOW_DEACTIVATE",
}
"""Events that go on to the window while work runs: looking around changes nothing."""


class OnDrawing:
    """Needs an active Grease Pencil object that can be changed."""

    @classmethod
    def poll(cls, context) -> bool:
        """Called by Blender."""
        if not gp.is_drawing(context.object):
            cls.poll_message_set("Make a Grease Pencil object active first, or use Set Up")
            return False
        if context.object.library is not None or context.object.data.library is not None:
            cls.poll_message_set("The Grease Pencil object is linked from another file and cannot be changed")
            return False
        return True


class OnContours(OnDrawing):
    """Needs an active Grease Pencil object with footage and contours."""

    @classmethod
    def poll(cls, context) -> bool:
        """Called by Blender."""
        if not super().poll(context):
            return False
        settings = context.object.rototoon
        if not settings.pattern:
            cls.poll_message_set("Choose the footage first, in the panel Footage")
            return False
        if not any(gp.frame_numbers(layer) for layer in gp.layers(context.object, settings.contours_layer)):
            cls.poll_message_set(f'Draw contours on the layer "{settings.contours_layer}" first')
            return False
        return True


class OnArmature:
    """Needs an active armature of this file."""

    @classmethod
    def poll(cls, context) -> bool:
        """Called by Blender."""
        ob = context.object
        if ob is None or ob.type != "ARMATURE":
            cls.poll_message_set("Make an armature active first")
            return False
        if ob.library is not None or context.mode == "EDIT_ARMATURE":
            cls.poll_message_set("The armature is linked from another file, or in Edit Mode")
            return False
        return True


class InObjectMode:
    """Needs Object Mode, as it makes objects."""

    @classmethod
    def poll(cls, context) -> bool:
        """Called by Blender."""
        if context.mode != "OBJECT":
            cls.poll_message_set("Go to Object Mode first")
            return False
        return True


class Guarded:
    """An operator whose `run(context)` returns a message (or `None`), and may raise a `Problem`."""

    def execute(self, context):
        """Called by Blender."""
        try:
            message = self.run(context)
        except (Problem, RototoonError) as problem:
            self.report({"ERROR"}, str(problem))
            return {"CANCELLED"}
        if message:
            self.report({"INFO"}, message)
        return {"FINISHED"}


class Long:
    """An operator with long work: `begin(context)` makes a `Worker` or `Stepper`, `finish(context, work)` writes.

    Until `finish` nothing is changed, so that Esc leaves all as it was.
    """

    _work = None
    _timer = None
    _picked = False
    """Whether a file browser was opened: its end calls `execute`, and the window is there to follow the work."""

    def execute(self, context):
        """Called by Blender: waits for the work."""
        if self._picked:
            self._picked = False
            return self._follow(context)
        jobs.clear_the_way()
        try:
            self._work = self.begin(context)
            self._work.start()
            self._wait(context)
        except (Problem, RototoonError) as problem:
            self.report({"ERROR"}, str(problem))
            return {"CANCELLED"}
        return self._end(context)

    def invoke(self, context, _event):
        """Called by Blender: follows the work with a timer."""
        if bpy.app.background or context.window is None:
            return self.execute(context)
        return self._follow(context)

    def _follow(self, context):
        # It may be at work in the session that is wanted here.
        jobs.clear_the_way()
        try:
            self._work = self.begin(context)
        except (Problem, RototoonError) as problem:
            self.report({"ERROR"}, str(problem))
            return {"CANCELLED"}
        self._work.start()
        self._timer = context.window_manager.event_timer_add(0.05, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        """Called by Blender."""
        if event.type == "ESC" and event.value == "PRESS":
            self._work.cancel()
        if event.type != "TIMER":
            return {"PASS_THROUGH"} if event.type in NAVIGATION else {"RUNNING_MODAL"}
        if not self._work.advance():
            share = f"{self._work.fraction:4.0%}"
            context.workspace.status_text_set(f"{self.bl_label}: {self._work.step}  {share}   (Esc: stop)")
            return {"RUNNING_MODAL"}
        self._close(context)
        return self._end(context)

    def cancel(self, context):
        """Called by Blender when a file is loaded or the program ends meanwhile."""
        self._work.cancel()
        self._work.join()
        self._close(context)

    def _wait(self, context) -> None:
        manager = context.window_manager
        manager.progress_begin(0, 100)
        try:
            while not self._work.advance():
                self._work.wait()
                manager.progress_update(int(100 * self._work.fraction))
        except KeyboardInterrupt:
            self._work.cancel()
            self._work.join()
        finally:
            manager.progress_end()

    def _close(self, context) -> None:
        if self._timer is not None:
            context.window_manager.event_timer_remove(self._timer)
            self._timer = None
        if context.workspace is not None:
            context.workspace.status_text_set(None)

    def _end(self, context):
        error = self._work.error
        if self._work.cancelled or isinstance(error, Cancelled):
            self.report({"WARNING"}, f"{self.bl_label}: stopped, nothing was changed")
            return {"CANCELLED"}
        try:
            if error is not None:
                raise error
            message = self.finish(context, self._work)
        except (Problem, RototoonError) as problem:
            self.report({"ERROR"}, str(problem))
            return {"CANCELLED"}
        if message:
            self.report({"INFO"}, message)
        return {"FINISHED"}

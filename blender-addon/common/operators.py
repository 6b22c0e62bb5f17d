"""Base classes of operators: when they are available, how they report, and long work."""

from __future__ import annotations

from collections.abc import Callable

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
"""Events that the window still gets while work runs: navigation changes nothing."""


class OnDrawing:
    """An operator that needs an active Grease Pencil object of this file."""

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
    """An operator that needs an active Grease Pencil object with footage and contours."""

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
    """An operator that needs an active armature of this file."""

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
    """An operator that needs Object Mode, since it makes objects."""

    @classmethod
    def poll(cls, context) -> bool:
        """Called by Blender."""
        if context.mode != "OBJECT":
            cls.poll_message_set("Go to Object Mode first")
            return False
        return True


class Reporting:
    """An operator that reports what it did, or why it could not."""

    def attempt(self, do: Callable[[], set[str]]) -> set[str]:
        """Calls `do` and returns its result. A `Problem` or `RototoonError` becomes an error report."""
        try:
            return do()
        except (Problem, RototoonError) as problem:
            self.report({"ERROR"}, str(problem))
            return {"CANCELLED"}

    def done(self, message: str | None) -> set[str]:
        """Reports the message, if there is one."""
        if message:
            self.report({"INFO"}, message)
        return {"FINISHED"}


class Guarded(Reporting):
    """An operator whose `run(context)` returns a message or `None`, and may raise a `Problem`."""

    def execute(self, context):
        """Called by Blender."""
        return self.attempt(lambda: self.done(self.run(context)))


class Long(Reporting):
    """An operator with long work: `begin(context)` makes a `Worker` or `Stepper`, `finish(context, work)` writes.

    Nothing changes before `finish`, so Esc leaves everything as it was.
    """

    _work = None
    _timer = None
    _picked = False
    """Whether a file browser was opened. Its end calls `execute`, and there is a window in which to follow the work."""

    def execute(self, context):
        """Called by Blender: waits for the work."""
        if self._picked:
            self._picked = False
            return self._follow(context)
        jobs.clear_the_way()
        return self.attempt(lambda: self._work_and_wait(context))

    def invoke(self, context, _event):
        """Called by Blender: follows the work with a timer."""
        if bpy.app.background or context.window is None:
            return self.execute(context)
        return self._follow(context)

    def _work_and_wait(self, context):
        self._work = self.begin(context)
        self._work.start()
        self._wait(context)
        return self._end(context)

    def _follow(self, context):
        # Work in the background may use the session that this operator needs.
        jobs.clear_the_way()
        return self.attempt(lambda: self._work_and_follow(context))

    def _work_and_follow(self, context):
        self._work = self.begin(context)
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
        return self.attempt(lambda: self._end(context))

    def cancel(self, context):
        """Called by Blender when it loads a file or quits during the work."""
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
        if error is not None:
            raise error
        return self.done(self.finish(context, self._work))

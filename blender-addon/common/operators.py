"""Base classes of operators: when they are available, how they report, and long work."""

from __future__ import annotations

import time
from collections.abc import Callable, Generator
from types import GeneratorType

import bpy
from rototoon import Cancelled, RototoonError

from ..blender import grease_pencil as gp
from ..blender import guard
from ..blender.errors import Problem
from . import jobs, reports
from .undone import Undone

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
WAITING = "editing and playback wait"
ESC = f"Esc: stop, {WAITING}"
SLICE = 0.05
"""Seconds of writing between two redraws of the window."""


class OnDrawing:
    """An operator that needs an active Grease Pencil object that it may change."""

    changes = guard.DRAWINGS
    """What it changes: see `guard`."""

    @classmethod
    def poll(cls, context) -> bool:
        """Called by Blender."""
        why = cls.lacking(context.object, cls.changes)
        if why:
            cls.poll_message_set(why)
        return not why

    @classmethod
    def lacking(cls, ob, changes: str) -> str:
        """What is missing for work on an object that `changes` something of it; empty if nothing is."""
        if not gp.is_drawing(ob):
            return "Make a Grease Pencil object active first, or use Set Up Footage"
        return guard.refusal(ob, changes)


class OnContours(OnDrawing):
    """An operator that needs an active Grease Pencil object with footage and contours."""

    @classmethod
    def lacking(cls, ob, changes: str) -> str:
        """As `OnDrawing.lacking`."""
        why = super().lacking(ob, changes)
        if why:
            return why
        settings = ob.rototoon
        if not settings.pattern:
            return "Choose the footage first, in the panel Footage"
        if not any(gp.has_strokes(layer) for layer in gp.layers(ob, settings.contours_layer)):
            return f'Draw contours on the layer "{settings.contours_layer}" first'
        return ""


class OnShapes(OnDrawing):
    """An operator that needs an active Grease Pencil object with footage, and contours, traced lines or paint."""

    @classmethod
    def lacking(cls, ob, changes: str) -> str:
        """As `OnDrawing.lacking`."""
        why = OnContours.lacking(ob, changes)
        if not why or super().lacking(ob, changes) or not ob.rototoon.pattern:
            return why
        settings = ob.rototoon
        others = [gp.find_layer(ob, name) for name in (settings.lines_layer, settings.fills_layer)]
        if any(layer is not None and gp.has_strokes(layer) for layer in others):
            return ""
        return (
            f'Found no contours on the layer "{settings.contours_layer}", no lines on "{settings.lines_layer}" and no paint on '
            f'"{settings.fills_layer}": draw there, or choose the layer of your lines in the panel Lines'
        )


class OnArmature:
    """An operator that needs an active armature that it may change."""

    changes = guard.ANIMATION
    """What it changes: see `guard`."""

    @classmethod
    def poll(cls, context) -> bool:
        """Called by Blender."""
        ob = context.object
        if ob is None or ob.type != "ARMATURE":
            cls.poll_message_set("Make an armature active first")
            return False
        why = guard.refusal(ob, cls.changes)
        if context.mode == "EDIT_ARMATURE":
            why = "The armature is in Edit Mode: leave it first"
        if why:
            cls.poll_message_set(why)
            return False
        return True


class Stopped(Exception):
    """The artist has stopped the work."""


class Reporting:
    """An operator that reports what it did, or why it could not."""

    _warnings: tuple[str, ...] = ()

    def warn(self, text: str) -> None:
        """Adds a text that needs attention to the report at the end, which becomes a warning. An empty text adds nothing."""
        if text:
            self._warnings += (text,)

    def ready(self, context) -> None:
        """Raises a `Problem` if drawings cannot be written, for a reason that takes too long to look for whenever a button is drawn."""
        if isinstance(self, OnDrawing) and self.changes == guard.DRAWINGS:
            guard.need(context.object)

    def attempt(self, do: Callable[[], set[str]]) -> set[str]:
        """Calls `do` and returns its result. A `Problem` or `RototoonError` becomes an error report."""
        try:
            return do()
        except Stopped as stopped:
            self._say("WARNING", str(stopped))
            return {"CANCELLED"}
        except (Problem, RototoonError) as problem:
            self._say("ERROR", str(problem))
            return {"CANCELLED"}
        except ReferenceError:
            # Blender's words for data that was removed are not for artists.
            self._say("ERROR", "What this works on was deleted meanwhile")
            return {"CANCELLED"}

    def done(self, message: str | None) -> set[str]:
        """Reports the message and the warnings, if there are any."""
        text = "; ".join(filter(None, (message, *self._warnings)))
        if text:
            self._say("WARNING" if self._warnings else "INFO", text)
        return {"FINISHED"}

    def _say(self, kind: str, text: str) -> None:
        # Blender writes ROTOTOON_OT_track where the class says rototoon.track.
        name = self.bl_idname.rpartition("_OT_")[2].rpartition(".")[2]
        reports.note(reports.Report(name, kind, text, self._warnings))
        self.report({kind}, text)


class Guarded(Reporting):
    """An operator whose `run(context)` returns a message or `None`, and may raise a `Problem`."""

    def execute(self, context):
        """Called by Blender."""
        return self.attempt(lambda: self._run(context))

    def _run(self, context) -> set[str]:
        self.ready(context)
        return self.done(self.run(context))


class Long(Reporting):
    """An operator with long work: `begin(context)` makes a `Worker` or `Stepper`, `finish(context, work)` writes.

    Nothing changes before `finish`, so Esc leaves everything as it was. `finish` returns a message, or is a generator of finished shares
    that returns the message. In a window a generator writes in slices, between which the window is redrawn. Writing is not
    interrupted: it is short, and half a result is worth nothing. Undo in another window ends the work, since it knows Blender's data.
    """

    _work = None
    _timer = None
    _undone: Undone | None = None
    _writing: Generator[float, None, str | None] | None = None
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
        self.ready(context)
        self._work = self.begin(context)
        self._work.start()
        self._wait(context)
        return self._end(context)

    def _follow(self, context):
        # Work in the background may use the session that this operator needs.
        jobs.clear_the_way()
        return self.attempt(lambda: self._work_and_follow(context))

    def _work_and_follow(self, context):
        self.ready(context)
        self._work = self.begin(context)
        self._work.start()
        self._undone = Undone(self._drop)
        self._timer = context.window_manager.event_timer_add(0.05, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        """Called by Blender."""
        try:
            return self._on(context, event)
        except BaseException:
            # Nothing of the work may go on after an error that nobody foresaw.
            self._close(context)
            raise

    def _on(self, context, event):
        if self._undone.happened:
            self._close(context)
            self._say("WARNING", f"{self.bl_label}: stopped, since something was undone meanwhile")
            return {"CANCELLED"}
        if self._writing is None and event.type == "ESC" and event.value == "PRESS":
            self._work.cancel()
        if event.type != "TIMER":
            return {"PASS_THROUGH"} if event.type in NAVIGATION else {"RUNNING_MODAL"}
        if self._writing is None and not self._work.advance():
            self._show(context, self._work.step, self._work.fraction, ESC)
            return {"RUNNING_MODAL"}
        done = self.attempt(lambda: self._go_on(context))
        if done != {"RUNNING_MODAL"}:
            self._close(context)
        return done

    def _show(self, context, step: str, share: float, hint: str) -> None:
        text = ": ".join(filter(None, (self.bl_label, step)))
        context.workspace.status_text_set(f"{text}  {share:.0%}     {hint}")

    def _go_on(self, context) -> set[str]:
        """Begins to write, or writes for a slice of time."""
        if self._writing is None:
            self._refuse_unfinished()
            found = self.finish(context, self._work)
            if not isinstance(found, GeneratorType):
                return self.done(found)
            self._writing = found
        until, share = time.perf_counter() + SLICE, 0.0
        while time.perf_counter() < until:
            try:
                share = next(self._writing)
            except StopIteration as end:
                return self.done(end.value)
        self._show(context, "writing the strokes", share, WAITING)
        return {"RUNNING_MODAL"}

    def cancel(self, context):
        """Called by Blender when it loads a file or quits during the work, and when a dialog or a file browser is closed before it."""
        if self._work is None:
            return
        self._drop()
        self._close(context)

    def _drop(self) -> None:
        """Ends the work, also half way through the writing."""
        self._work.cancel()
        self._work.join()
        if self._writing is not None:
            self._writing.close()

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
        if self._undone is not None:
            self._undone.stop()
            self._undone = None
        if self._timer is not None:
            context.window_manager.event_timer_remove(self._timer)
            self._timer = None
        if context.workspace is not None:
            context.workspace.status_text_set(None)

    def _end(self, context):
        self._refuse_unfinished()
        found = self.finish(context, self._work)
        return self.done(jobs.drained(found) if isinstance(found, GeneratorType) else found)

    def _refuse_unfinished(self) -> None:
        """Raises what ended the work early."""
        error = self._work.error
        if self._work.cancelled or isinstance(error, Cancelled):
            raise Stopped(f"{self.bl_label}: stopped, nothing was changed")
        if error is not None:
            raise error

"""Live: while an object's toggle is on, each edit of its keys, pins and centres is tracked by itself.

Blender's handlers only note that an object may have changed (`changed`, `undone`, the callbacks of properties). A timer calls
`step`; it exists only while an object is due. When the artist has not changed anything for `DELAY` seconds, `step` reads the object
and compares its document with the one that was tracked last. If they differ, a run begins in a thread. The session knows all
spans that the edit did not touch, and does not solve them again. A new edit cancels the run. The timer writes the result in the
main thread, and only into drawings that it changes.

**Slices.** Reading and writing a large drawing take seconds. They are generators, of which each call of `step` runs `SLICE` seconds.
In between the artist may edit: then the rest is dropped, and the object is read again when the edit is finished. Undo drops the rest
before it happens, since the generators know Blender's data. A result of which only a part was written is written again.

**Undo.** A result belongs to the edit that caused it. It gets no undo step of its own: one undo takes back the edit and its
result, and redo still works. So a step of Blender may contain an edit without its result. After undo and redo, the object is
read and tracked again (the session knows most spans), and missing results are written. Writing adds no undo step, so this ends.

**Pauses.** Live waits during rendering and playback, while another scene is shown, and while a tool of Blender or of this add-on runs
(a drag, a brush stroke), since these use the strokes. Blender runs no timers in background; scripts call `step`.

After a file is opened, nothing is tracked before the first edit. The content of the file counts as tracked.
"""

from __future__ import annotations

import contextlib
import enum
import time
import traceback
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import bpy
from bpy.app.handlers import persistent
from rototoon import Cancelled, RototoonError

from ..blender import grease_pencil as gp
from ..blender import guard, windows
from ..blender.errors import Changed, Problem
from ..blender.preferences import EXTENSION
from ..common import jobs
from . import document, sessions, tracking

DELAY = 0.2
"""Seconds without a change after which an edit counts as finished. Two events of one gesture are closer than this."""
POLL = 0.05
"""Seconds between two calls of `step` during a run. Nobody notices a wait of this length."""
BLOCKED = 0.2
"""Seconds between two calls of `step` during a pause."""
SLICE = 0.05
"""Seconds of reading or writing in one call of `step`."""
SOON = 0.01
"""Seconds until the next slice. Blender handles events and draws before it."""


class Why(enum.IntEnum):
    """Why an object is due. Of several reasons the greatest counts."""

    CHANGED = 0
    """Track if the document differs from what was tracked last."""
    OPENED = 1
    """Count the document as tracked."""
    AGAIN = 2
    """Track and write even if the document has not changed: the strokes may have lost their result."""


@dataclass
class _Due:
    since: float
    why: Why


_due: dict[int, _Due] = {}
@dataclass
class _Slices:
    """Reading or writing that goes on in the next step."""

    uid: int
    steps: Iterator[float]
    why: Why | None
    """Why the object becomes due if the rest is dropped; `None` if it is due in any case."""
    wrote: bool = False
    """Whether it has begun to write."""


_run: tracking.Run | None = None
_slices: _Slices | None = None
_known: dict[int, tuple] = {}
"""By object: the `_state` that was found when the file was opened, or that cannot be tracked."""
_messages: dict[int, str] = {}
_quiet = False
"""Whether the changes that Blender reports are the add-on's own."""


# -- noting -------------------------------------------------------------------------------------------------------


def note(ob: bpy.types.Object, why: Why = Why.CHANGED) -> None:
    """Notes that an object may have changed."""
    if _quiet:
        return
    if _slices is not None and _slices.uid == ob.session_uid:
        drop_slices()
    before = _due.get(ob.session_uid)
    _due[ob.session_uid] = _Due(time.monotonic(), why if before is None else max(why, before.why))
    _wake()


def _wake() -> None:
    if not bpy.app.background and not bpy.app.timers.is_registered(_tick):
        bpy.app.timers.register(_tick, first_interval=DELAY)


@contextlib.contextmanager
def _quietly() -> Iterator[None]:
    """Changes that Blender reports meanwhile do not count as edits."""
    global _quiet
    _quiet = True
    try:
        yield
    finally:
        _quiet = False


def _is_live(ob: bpy.types.Object) -> bool:
    return gp.is_drawing(ob) and ob.rototoon.live and not guard.refusal(ob)


@persistent
def changed(_scene=None, depsgraph=None) -> None:
    """Called after each update of the scene. Notes live objects whose strokes or transforms changed."""
    if _quiet or depsgraph is None:
        return
    for update in depsgraph.updates:
        # Blender lists the object too if only its strokes changed.
        if isinstance(update.id, bpy.types.Object) and _is_live(update.id.original):
            note(update.id.original)


@persistent
def undoing(*_args) -> None:
    """Called before undo and redo."""
    drop_slices()


def drop_slices() -> None:
    """Drops the rest of what is read or written. The object stays due."""
    global _slices
    if _slices is None:
        return
    slices, _slices = _slices, None
    slices.steps.close()
    if slices.why is not None:
        before = _due.get(slices.uid)
        _due[slices.uid] = _Due(time.monotonic(), slices.why if before is None else max(slices.why, before.why))
        _wake()


@persistent
def undone(*_args) -> None:
    """Called after undo and redo."""
    _note_all(Why.AGAIN)


@persistent
def opened(*_args) -> None:
    """Called after a file was opened."""
    _note_all(Why.OPENED)


@persistent
def closing(*_args) -> None:
    """Called before another file is opened."""
    reset()


def _note_all(why: Why) -> None:
    for ob in bpy.data.objects:
        if _is_live(ob):
            note(ob, why)


def setting_changed(owner, _context) -> None:
    """Callback of the properties that affect tracking."""
    if _is_live(owner.id_data):
        note(owner.id_data)


def toggled(settings, _context) -> None:
    """Callback of the toggle."""
    ob = settings.id_data
    _known.pop(ob.session_uid, None)
    _messages.pop(ob.session_uid, None)
    if settings.live:
        note(ob)
        return
    if ob.session_uid in {work.uid for work in (_run, _slices) if work is not None}:
        interrupt()
    _due.pop(ob.session_uid, None)


# -- working ------------------------------------------------------------------------------------------------------


def step(now: float | None = None) -> float | None:
    """Does the work that is due at `now` (seconds of `time.monotonic`), for about `SLICE` seconds. Returns the seconds until the next
    call, or `None` if all is done."""
    if _run is None and _slices is None and not _due:
        return None
    if held_off():
        return BLOCKED
    if _slices is not None and _object(_slices.uid) is None:
        drop_slices()
    now = time.monotonic() if now is None else now
    until = time.perf_counter() + SLICE
    if _slices is not None or _run is not None:
        _work(_run.uid if _slices is None else _slices.uid, lambda: _attending(now), None, until)
    if _slices is None and _run is None:
        _begin_next(now, until)
    windows.redraw_views()
    if _slices is not None:
        return SOON
    if _run is None and all(_object(uid) is None for uid in _due):
        return BLOCKED if _due else None
    return POLL


def _work(uid: int, begin: Callable[[], Iterator[float]], why: Why | None, until: float) -> None:
    """Goes on with the slices, or begins those of an object, until the clock says `until`."""
    global _slices
    if _slices is None:
        _slices = _Slices(uid, begin(), why)
    slices = _slices
    if slices.wrote:
        # What others changed since the last slice must be reported before the next one, whose own report does not count.
        bpy.context.view_layer.update()
    with _quietly():
        while _slices is slices:
            try:
                next(slices.steps)
            except StopIteration:
                _slices = None
            except BaseException:
                _slices = None
                raise
            if time.perf_counter() > until:
                break
        if slices.wrote:
            # Blender reports changes at its next update. It must come now, while changes do not count as edits.
            bpy.context.view_layer.update()


def status(ob: bpy.types.Object) -> tuple[str, str]:
    """A line of text for the panel, and its icon."""
    message = guard.refusal(ob) or _messages.get(ob.session_uid)
    if message:
        return message, "ERROR"
    if _slices is not None and _slices.uid == ob.session_uid and _slices.wrote:
        return "Writing the strokes", "TIME"
    if _run is not None and _run.uid == ob.session_uid:
        return f"Tracking {_run.worker.fraction:.0%}", "TIME"
    left = guard.left_out(tracking.contour_layers(ob), hidden=True)
    return "Follows your edits" + (left and f"; {left}"), "CHECKMARK"


def give_way() -> None:
    """Ends the run at once, since an operator needs the session. The object stays due."""
    drop_slices()
    if _run is not None:
        _due[_run.uid] = _Due(time.monotonic(), Why.AGAIN)
        interrupt()
        _wake()


def interrupt() -> None:
    """Ends the run at once, without a result."""
    global _run
    drop_slices()
    if _run is not None:
        _run.worker.cancel()
        _run.worker.join()
        _run = None


def reset() -> None:
    """Forgets everything and stops the timer."""
    interrupt()
    for memory in (_due, _known, _messages):
        memory.clear()
    if bpy.app.timers.is_registered(_tick):
        bpy.app.timers.unregister(_tick)


def _tick() -> float | None:
    try:
        return step()
    except Exception:  # noqa: BLE001 - a fault must not take the timer away for good: the next edit starts anew
        traceback.print_exc()
        reset()
        return None


def held_off() -> bool:
    """Whether something runs that uses the strokes."""
    if bpy.app.is_job_running("RENDER"):
        return True
    for window in bpy.context.window_manager.windows:
        if window.screen is not None and window.screen.is_animation_playing:
            return True
        if any(_minds(operator.bl_idname) for operator in window.modal_operators):
            return True
    return False


def _minds(name: str) -> bool:
    """Whether a modal operator belongs to Blender or to this add-on. Operators of other add-ons may run for hours."""
    python = bpy.types.Operator.bl_rna_get_subclass_py(name)
    return python is None or python.__module__.startswith(EXTENSION)


def _object(uid: int) -> bpy.types.Object | None:
    """The live object of the scene with this `session_uid`. It is looked up each time, since undo replaces objects."""
    return next((ob for ob in bpy.context.scene.objects if ob.session_uid == uid and _is_live(ob)), None)


def _is_elsewhere(uid: int) -> bool:
    """Whether the object is live in other scenes than the one that is shown. It stays due until one of them is."""
    return any(ob.session_uid == uid and bool(ob.users_scene) and _is_live(ob) for ob in bpy.data.objects)


def _settled(uid: int, now: float) -> bool:
    return uid in _due and now - _due[uid].since >= DELAY


def _attending(now: float) -> Iterator[float]:
    """Cancels the run if the object has changed, and writes the result if the run has ended."""
    global _run
    run, ob = _run, _object(_run.uid)
    if ob is None:
        run.worker.cancel()
    elif not run.worker.cancelled and _settled(run.uid, now):
        reading = yield from _reading(ob)
        if reading is not None and _state(ob, reading) == (run.inputs, run.preset, run.closed):
            # The edit was undone and redone. The run writes its result as planned.
            _due.pop(run.uid, None)
        else:
            run.worker.cancel()
    if not run.worker.advance():
        return
    _run = None
    if ob is None and _is_elsewhere(run.uid):
        _due_again(run.uid, Why.AGAIN)
    elif ob is None:
        _forget(run.uid)
    elif not run.worker.cancelled:
        yield from _ending(ob, run)


def _ending(ob: bpy.types.Object, run: tracking.Run) -> Iterator[float]:
    """Writes a result, or notes what went wrong."""
    error = run.worker.error
    if isinstance(error, Cancelled):
        return
    slices = _slices
    slices.why, slices.wrote = Why.AGAIN, True
    try:
        if error is not None:
            raise error
        if (yield from tracking.finishing(ob, run)) is None:
            _due_again(run.uid, Why.CHANGED)
        else:
            _known.pop(run.uid, None)
            _messages.pop(run.uid, None)
            if run.doubts:
                _messages[run.uid] = run.doubts[0]
    except Changed:
        _due_again(run.uid, Why.AGAIN)
    except (Problem, RototoonError) as problem:
        _known[run.uid] = (run.inputs, run.preset, run.closed)
        _messages[run.uid] = _line(problem)


def _due_again(uid: int, why: Why) -> None:
    """Notes an object that changed while it was read or written."""
    _due[uid] = _Due(time.monotonic(), max(why, _due[uid].why) if uid in _due else why)


def _begin_next(now: float, until: float) -> None:
    """Begins a run for the first due object that needs one."""
    for uid in [uid for uid in _due if _settled(uid, now)]:
        ob = _object(uid)
        if ob is None and _is_elsewhere(uid):
            continue
        why = _due.pop(uid).why
        if ob is None:
            _forget(uid)
            continue
        _work(uid, lambda ob=ob, why=why: _beginning(ob, why), why, until)
        if _run is not None or _slices is not None:
            return


def _beginning(ob: bpy.types.Object, why: Why) -> Iterator[float]:
    """Begins a run if the object needs one."""
    global _run
    reading = yield from _reading(ob)
    if reading is None:
        return
    uid, now = ob.session_uid, _state(ob, reading)
    if why == Why.OPENED or not tracking.can_track(reading, ob.rototoon.preset):
        _known[uid] = now
        _messages.pop(uid, None)
        return
    if why != Why.AGAIN and now == _tracked(ob):
        _messages.pop(uid, None)
        return
    if why != Why.AGAIN and now == _known.get(uid):
        return
    try:
        run = tracking.begin(ob, reading, ob.rototoon.preset)
    except (Problem, RototoonError) as error:
        _known[uid] = now
        _messages[uid] = _line(error)
        return
    run.worker.start()
    _run = run


def _tracked(ob: bpy.types.Object) -> tuple | None:
    entry = sessions.known(ob)
    return None if entry is None else (entry.inputs, entry.preset, entry.closed)


def _state(ob: bpy.types.Object, reading: document.Reading) -> tuple:
    """What a result depends on: document, method, and the layers that are locked."""
    return reading.document, ob.rototoon.preset, reading.found.closed_names


def _reading(ob: bpy.types.Object) -> Iterator[float]:
    """Reads the object. If it cannot be read: `None`, and a message for the panel."""
    try:
        return (yield from document.reading(ob))
    except Changed:
        _due_again(ob.session_uid, Why.CHANGED)
    except (Problem, RototoonError) as problem:
        _messages[ob.session_uid] = _line(problem)
    return None


def _forget(uid: int) -> None:
    """Forgets an object that is gone or no longer live."""
    for memory in (_due, _known, _messages):
        memory.pop(uid, None)
    if not any(ob.session_uid == uid for ob in bpy.data.objects):
        sessions.forget(uid)


def _line(problem: Exception) -> str:
    return (str(problem).splitlines() or [type(problem).__name__])[0]


jobs.in_background(give_way)

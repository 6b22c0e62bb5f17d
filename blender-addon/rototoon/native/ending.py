"""The end of Python while other threads run calls with a callback.

Up to Python 3.13, a thread that asks for the lock of a Python that has ended is ended there: its stack is unwound by force. A callback asks for the lock with
frames of the library below it, which no exception may cross, so the process would abort. Daemon threads live as long as this. So at the end such
calls are cancelled, Python waits for them, and no new one begins. Those of the main thread go on: functions that it calls at its exit may work.
"""

from __future__ import annotations

import atexit
import contextlib
import os
import threading
import time
from collections.abc import Callable, Iterator

from .errors import Cancelled

MOST_WAIT = 10.0
"""Seconds that the end waits at most. A Python callback that itself waits for the main thread never comes back."""

_ending = threading.Event()
_running: set[object] = set()
"""The running calls of other threads. Sets change in one step."""


@contextlib.contextmanager
def call() -> Iterator[Callable[[], bool]]:
    """A call with a callback, of this thread. Gives a function that says whether the callback must cancel it. Raises `Cancelled` if it must not begin."""
    if threading.get_ident() == threading.main_thread().ident:
        yield lambda: False
        return
    own = object()
    # Before the look at `_ending`, as the end looks at `_running` after it has set that: so one of the two sees the other.
    _running.add(own)
    try:
        if _ending.is_set():
            raise Cancelled("Python ends")
        yield _ending.is_set
    finally:
        _running.discard(own)


def _end() -> None:
    _ending.set()
    last = time.monotonic() + MOST_WAIT
    while _running and time.monotonic() < last:
        time.sleep(0.005)


atexit.register(_end)
if hasattr(os, "register_at_fork"):
    # A child has none of the parent's other threads.
    os.register_at_fork(after_in_child=_running.clear)

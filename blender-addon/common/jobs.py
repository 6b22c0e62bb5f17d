"""Long work that does not block the window.

`Worker` runs a function in a thread; the native library releases Python's lock. `Stepper` runs a generator on the main thread,
one step at a time, for work that only Blender can do. `Chain` runs two workers. When an operator is executed (in background, in scripts, in the redo
panel), it waits for the end of the work. When it is invoked in a window, it follows the work with a timer.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator

_in_background: list[Callable[[], None]] = []


def in_background(give_way: Callable[[], None]) -> None:
    """Registers work that runs without an operator. `give_way` ends it when an operator needs the session."""
    _in_background.append(give_way)


def clear_the_way() -> None:
    """Ends all work that runs without an operator."""
    for give_way in _in_background:
        give_way()


def drained(steps: Iterator[float]) -> object:
    """Runs a generator to its end and returns its result."""
    while True:
        try:
            next(steps)
        except StopIteration as end:
            return end.value


class Worker:
    """Runs a function in a thread. The function gets a progress callback."""

    def __init__(self, run: Callable[[Callable[[float, str], bool]], object]):
        self.fraction, self.step = 0.0, ""
        self.result: object = None
        self.error: BaseException | None = None
        self.cancelled = False
        self._run = run
        self._thread = threading.Thread(target=self._work, name="rototoon", daemon=True)

    def start(self) -> None:
        """Starts the thread."""
        self._thread.start()

    def run_here(self, progress: Callable[[float, str], bool | None] | None = None) -> None:
        """Does the work on this thread instead, and raises its error. `progress` returns `False` to cancel."""
        self.result = self._run(progress or self._progress)

    def cancel(self) -> None:
        """Asks the work to stop. It stops at its next progress report."""
        self.cancelled = True

    def advance(self) -> bool:
        """Whether the work has ended."""
        return not self._thread.is_alive()

    def wait(self) -> None:
        """Waits up to 0.05 s for the thread."""
        self._thread.join(0.05)

    def join(self) -> None:
        """Waits for the end of the work."""
        self._thread.join()

    def _progress(self, fraction: float, step: str) -> bool:
        self.fraction, self.step = fraction, step
        return not self.cancelled

    def _work(self) -> None:
        try:
            self.result = self._run(self._progress)
        except BaseException as error:  # noqa: BLE001 - the main thread reports it
            self.error = error


class Chain:
    """Two workers, one after the other. `then` makes the second on the main thread, when the first has ended."""

    def __init__(self, first: Worker, then: Callable[[], Worker]):
        self._now, self._then = first, then
        self._error: BaseException | None = None
        self._last = False

    @property
    def fraction(self) -> float:
        """The finished share of the second; the first has none."""
        return self._now.fraction if self._last else 0.0

    @property
    def step(self) -> str:
        """What the worker at work does."""
        return self._now.step

    @property
    def result(self) -> object:
        """The second's result."""
        return self._now.result if self._last else None

    @property
    def error(self) -> BaseException | None:
        """What ended the work."""
        return self._error or self._now.error

    @property
    def cancelled(self) -> bool:
        """Whether the work was asked to stop."""
        return self._now.cancelled

    def start(self) -> None:
        """Starts the first."""
        self._now.start()

    def cancel(self) -> None:
        """Asks the worker at work to stop."""
        self._now.cancel()

    def advance(self) -> bool:
        """Whether the work has ended. Starts the second when the first has."""
        if not self._now.advance():
            return False
        if self._last or self.error is not None or self.cancelled:
            return True
        try:
            self._now, self._last = self._then(), True
            self._now.start()
        except Exception as error:  # noqa: BLE001 - the operator reports it
            self._error = error
            return True
        return False

    def wait(self) -> None:
        """Waits up to 0.05 s."""
        self._now.wait()

    def join(self) -> None:
        """Waits for the worker at work."""
        self._now.join()


class Stepper:
    """Runs a generator of finished shares, one step at each `advance`."""

    def __init__(self, steps: Iterator[float], step: str):
        self.fraction, self.step = 0.0, step
        self.error: BaseException | None = None
        self.cancelled = False
        self._steps = steps

    def start(self) -> None:
        """Does nothing: the first `advance` does the first step."""

    def cancel(self) -> None:
        """Stops now. The generator removes what it has half made."""
        self.cancelled = True
        self._steps.close()

    def advance(self) -> bool:
        """Does one step. Returns whether the work has ended."""
        if self.cancelled:
            return True
        try:
            self.fraction = next(self._steps)
            return False
        except StopIteration:
            return True
        except Exception as error:  # noqa: BLE001 - the operator reports it
            self.error = error
            return True

    def wait(self) -> None:
        """Does nothing: all work happens in `advance`."""

    def join(self) -> None:
        """Does nothing: no work runs between two steps."""

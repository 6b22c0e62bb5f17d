"""Long work that does not block the window.

`Worker` runs a function in a thread; the native library releases Python's lock. `Stepper` runs a generator on the main thread,
one step at a time, for work that only Blender can do. When an operator is executed (in background, in scripts, in the redo
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

"""Long work that leaves the window alive.

`Worker` runs a function in a thread: the native library releases Python's lock. `Stepper` runs a generator a step at a
time on the main thread, for work that only Blender can do. Operators run either to its end when they are executed
(background, scripts, the redo panel), and follow it with a timer when they are invoked in a window.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator

_in_background: list[Callable[[], None]] = []


def in_background(give_way: Callable[[], None]) -> None:
    """Notes work that runs by itself; `give_way` ends it when an operator needs the session."""
    _in_background.append(give_way)


def clear_the_way() -> None:
    """Ends all work that runs by itself."""
    for give_way in _in_background:
        give_way()


class Worker:
    """A function of a progress callback, in a thread of its own."""

    def __init__(self, run: Callable[[Callable[[float, str], bool]], object]):
        self.fraction, self.step = 0.0, ""
        self.result: object = None
        self.error: BaseException | None = None
        self.cancelled = False
        self._run = run
        self._thread = threading.Thread(target=self._work, name="rototoon", daemon=True)

    def start(self) -> None:
        """Begins."""
        self._thread.start()

    def cancel(self) -> None:
        """Asks to stop; the work stops at its next report."""
        self.cancelled = True

    def advance(self) -> bool:
        """Whether the work has ended."""
        return not self._thread.is_alive()

    def wait(self) -> None:
        """Gives the thread a moment."""
        self._thread.join(0.05)

    def join(self) -> None:
        """Waits for the end."""
        self._thread.join()

    def _progress(self, fraction: float, step: str) -> bool:
        self.fraction, self.step = fraction, step
        return not self.cancelled

    def _work(self) -> None:
        try:
            self.result = self._run(self._progress)
        except BaseException as error:  # noqa: BLE001 - handed to the main thread
            self.error = error


class Stepper:
    """A generator of shares done, a step at each `advance`."""

    def __init__(self, steps: Iterator[float], step: str):
        self.fraction, self.step = 0.0, step
        self.error: BaseException | None = None
        self.cancelled = False
        self._steps = steps

    def start(self) -> None:
        """Nothing to do before the first step."""

    def cancel(self) -> None:
        """Stops now; what was half made goes."""
        self.cancelled = True
        self._steps.close()

    def advance(self) -> bool:
        """Does a step; whether the work has ended."""
        if self.cancelled:
            return True
        try:
            self.fraction = next(self._steps)
            return False
        except StopIteration:
            return True
        except Exception as error:  # noqa: BLE001 - reported by the operator
            self.error = error
            return True

    def wait(self) -> None:
        """Nothing to wait for."""

    def join(self) -> None:
        """Nothing runs between steps."""

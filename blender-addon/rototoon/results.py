"""Results that `Session` returns."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Job:
    """Tracking of one part between two neighbouring keys."""

    part: str
    first: int
    """Frame of the earlier key."""
    last: int
    """Frame of the later key."""
    solved: bool
    """Whether this run solved it. Otherwise the result is from an earlier run, since nothing that affects it had changed."""
    termination: str
    """Why the solver stopped: ``nothing_to_solve``, ``cost_converged``, ``step_converged``, ``no_descent``,
    ``iteration_limit`` or ``path_chosen``."""
    iterations: int
    initial_cost: float
    final_cost: float


@dataclass(frozen=True)
class End:
    """Where the track of a part with one key ends before the footage does."""

    part: str
    frame: int
    """The first frame beyond the track."""
    reason: str
    """``lost``: the part needs a key on that frame. ``cut``: another shot begins there. ``left``: the part left the picture."""


@dataclass(frozen=True)
class Exchange:
    """Two parts that look alike and may have changed places."""

    parts: tuple[str, str]
    frames: list[int]
    """Frames on which nothing says which is which, rising. A key or a pin there does."""


@dataclass(frozen=True)
class Unseen:
    """A part that can probably not be seen on some frames: nearer parts or the edge of the picture hide it."""

    part: str
    frames: list[int]
    """They rise."""


@dataclass(frozen=True)
class Summary:
    """Result of `Session.track`."""

    jobs: list[Job]
    """One for each part and span: parts in the document's order, spans in time order."""
    ends: list[End]
    """Ends of parts with one key: parts in the document's order, the end before the key first."""
    exchanges: list[Exchange]
    """Parts that may have changed places, in the document's order."""
    unseen: list[Unseen]
    """Parts that can probably not be seen somewhere, in the document's order."""
    footage_changed: bool
    """Whether files of the footage have changed since the session read them. Then it has solved all spans anew that they concern."""

    @property
    def solved(self) -> int:
        """Number of jobs that this run solved."""
        return sum(job.solved for job in self.jobs)

    @property
    def reused(self) -> int:
        """Number of jobs whose result is from an earlier run."""
        return len(self.jobs) - self.solved


@dataclass(frozen=True)
class Track:
    """The control points of a part on every frame from its first to its last key; with one key, on the frames around it that
    can be trusted.

    Both arrays are read-only and stay valid after the session is closed. ``numpy.asarray`` takes them without a copy. Both are
    empty and one-dimensional where the part has not been tracked.
    """

    frames: memoryview
    """Frame numbers, int32, shape (F,), rising."""
    points: memoryview
    """Points, float64, shape (F, N, 2)."""


@dataclass(frozen=True)
class WeakestFrame:
    """The frame where the next key helps most."""

    frame: int
    score: float
    """Doubt on that frame: the sum over parts of what the mean confidence lacks to that of a sure contour, as a share of it, smoothed over time."""


@dataclass(frozen=True)
class Outcome:
    """What became of a part: frames by how sure its contour is there. Keys are in none of them."""

    sure: list[int]
    """It needs no look."""
    doubtful: list[int]
    """A look at it is worth while."""
    lost: list[int]
    """It is probably wrong, or the part was lost and has no contour there."""


@dataclass(frozen=True)
class Outcomes:
    """What became of several parts."""

    parts: list[Outcome]
    """In the order of the request."""
    weakest: WeakestFrame | None
    """`None` if nothing was tracked."""
    exchanges: list[str]
    """What the command line says of parts that may have changed places, in the order of the request."""


@dataclass(frozen=True)
class Conformed:
    """Result of `Session.conform`: where frames and places of the old footage are in the new one."""

    scale: float
    """Pixels of the new picture for each pixel of the old one."""
    shift: tuple[float, float]
    """The place of the old picture's corner, in pixels of the new one."""
    same: dict[int, int]
    """By new frame the old frame whose drawing it shows."""
    redrawn: dict[int, int]
    """By new frame the old frame whose drawing was drawn again."""
    new: list[int]
    """New frames with a drawing that the old footage does not have, rising."""
    gone: list[int]
    """Old frames whose drawing is gone, rising."""
    went: dict[int, int]
    """By old frame the new one to which the artist's work on it goes."""
    warnings: list[str]
    """What did not simply go with its drawing, such as a key on a drawing that was drawn again."""

    @classmethod
    def of(cls, report: Mapping[str, Any]) -> Conformed:
        """The result from the library's report."""
        frames = {int(frame): shows for frame, shows in sorted(report["frames"].items(), key=lambda item: int(item[0]))}
        same, redrawn = ({on: shows[kind] for on, shows in frames.items() if kind in shows} for kind in ("same", "redrawn"))
        new = [on for on, shows in frames.items() if "new" in shows]
        went = {int(old): on for old, on in sorted(report["went"].items(), key=lambda item: int(item[0]))}
        x, y = report["shift"]
        return cls(report["scale"], (x, y), same, redrawn, new, report["gone"], went, report["warnings"])

"""What `Session` returns."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Job:
    """How the tracking of one part between two neighbouring keys fared."""

    part: str
    first: int
    """Frame of the earlier key."""
    last: int
    """Frame of the later key."""
    solved: bool
    """Solved in this run; otherwise known from a run before, as nothing that bears on it had changed."""
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
    """``lost``: a key is wanted on that frame; ``cut``: another shot begins there; ``left``: the part left the picture."""


@dataclass(frozen=True)
class Summary:
    """What `Session.track` did: one job for each part and span, parts in the document's order, then by time."""

    jobs: list[Job]
    ends: list[End]
    """Of parts with one key, in the document's order, the end before the key first."""

    @property
    def solved(self) -> int:
        """How many jobs were solved in this run."""
        return sum(job.solved for job in self.jobs)

    @property
    def reused(self) -> int:
        """How many jobs were known from a run before."""
        return len(self.jobs) - self.solved


@dataclass(frozen=True)
class Track:
    """The control points of a part on every frame from its first to its last key; around a single key, where trusted.

    Both are read-only and stay valid whatever happens to the session; ``numpy.asarray`` takes them without copying.
    Both are empty and one-dimensional where the part has not been tracked.
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
    """Doubt on that frame: the sum over parts of the mean of ``1 - confidence``, smoothed over time."""

"""Types that several modules share."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any, TypeAlias

Document: TypeAlias = dict[str, Any]
"""A project document as ``json.load`` gives it."""

Progress: TypeAlias = Callable[[float, str], bool | None]
"""``progress(fraction, step)``: told the finished share (0 to 1, never falling) and what is being done.

Returning ``False`` cancels; ``True`` or ``None`` goes on. Called on the thread that made the long call, about twenty
times a second at most, at least once before the work begins. An exception cancels the work and is raised from the call.
"""

Points: TypeAlias = Iterable[Sequence[float]]
"""Points as pairs, or any buffer of float64 of shape (N, 2) such as a NumPy array."""

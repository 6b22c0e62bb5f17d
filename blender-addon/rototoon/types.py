"""Types that several modules use."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any, TypeAlias

Document: TypeAlias = dict[str, Any]
"""A project document as ``json.load`` gives it."""

Progress: TypeAlias = Callable[[float, str], bool | None]
"""``progress(fraction, step)`` gets the finished share (0 to 1, never falling) and the name of the current step.

Return ``False`` to cancel, ``True`` or ``None`` to go on. The call comes on the thread that made the long call, at most about
twenty times a second, and at least once before the work begins. An exception cancels the work, and the long call raises it.
"""

Points: TypeAlias = Iterable[Sequence[float]]
"""Points as pairs, or any buffer of float64 of shape (N, 2) such as a NumPy array."""

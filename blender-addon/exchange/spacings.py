"""A drawing's `spacing` as the choices of In-between, and back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from ..blender.errors import Problem
from ..tween import charts
from ..tween.charts import WHOLE, Choices

_NAMED = {"smooth", "linear", "ease_in", "ease_out", "ease_in_out", "cosine", "bounce"}


def choices(spacing: Any, first: int, last: int, frames: Sequence[int]) -> Choices:
    """The choices from which the in-betweens on `frames`, rising, were drawn between two keys. What is no spacing counts as smooth."""
    steps = [step for step in range(1, last - first) if list(range(first + step, last, step)) == list(frames)]
    return replace(_spaced(spacing, len(frames)), step=steps[0] if steps else 1)


def _spaced(spacing: Any, count: int) -> Choices:
    if spacing == "constant":
        spacing = [0.0] * count
    if isinstance(spacing, str) and spacing in _NAMED:
        return Choices(spacing.upper())
    if isinstance(spacing, list) and spacing and all(isinstance(share, (int, float)) for share in spacing):
        return Choices("CHART", ", ".join(f"{100 * share:.10g}" for share in spacing))
    if isinstance(spacing, dict) and isinstance(spacing.get("bounce"), int):
        return Choices("BOUNCE", bounces=spacing["bounce"])
    if isinstance(spacing, dict) and isinstance(spacing.get("curve"), list):
        try:
            return Choices("CURVE", curve=charts.places(", ".join(f"{time!r} {share!r}" for time, share in spacing["curve"])))
        except (Problem, TypeError, ValueError):
            pass
    return Choices()


def written(chosen: Choices, first: int, last: int, before: Any) -> Any:
    """The spacing of choices in a document; `before` if it is the same. `None` for smooth."""
    if replace(choices(before, first, last, chosen.frames(first, last)), step=chosen.step) == replace(Choices(), **_only_spacing(chosen)):
        return before
    if chosen.part != WHOLE:
        # What a breakdown has left of a spacing is a list, which anybody can read and change.
        return chosen.part_shares(first, last) or None
    return None if chosen.spacing == "SMOOTH" else chosen.written(first, last)


def _only_spacing(chosen: Choices) -> dict[str, Any]:
    return {name: getattr(chosen, name) for name in ("spacing", "chart", "bounces", "curve", "step", "part")}

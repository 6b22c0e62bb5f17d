"""Where tracked contours are sure, doubtful or lost, and the frame where the next key helps most.

The formula is the core's. The command line and the reports use the same one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from rototoon import Outcome, outcomes

from ..blender import grease_pencil as gp
from ..blender.errors import Problem
from . import contours, ends


@dataclass
class Judged:
    """What became of an object's parts, in scene frames."""

    parts: dict[int, Outcome]
    """By the number of the part."""
    weakest: int | None
    """The frame where the next key helps most. `None` if nothing was tracked."""
    doubt: float
    """The sum of the doubts about the parts there."""

    def of(self, number: int) -> Outcome:
        """What became of a part."""
        return self.parts.get(number, Outcome([], [], []))


def judged(ob, found: contours.Contours) -> Judged:
    """What became of the parts of an object. `found` must have been read with `gp.CONFIDENCE`."""
    offset, items = ob.rototoon.frame_offset, {item.number: item for item in ob.rototoon.parts}
    asked = []
    for part in found.parts:
        means = {frame: mean(found.drawings[stroke.layer, frame], stroke.span) for frame, stroke in part.made.items()}
        wanted = [picture + offset for picture in ends.wanted(items[part.number])] if part.number in items else []
        asked.append({"keys": list(part.keys), "confidence": means, "wants_key": wanted})
    answer = outcomes(asked)
    parts = {part.number: outcome for part, outcome in zip(found.parts, answer.parts, strict=True)}
    if answer.weakest is None:
        return Judged(parts, None, 0.0)
    return Judged(parts, answer.weakest.frame, answer.weakest.score)


def lost(means: Sequence[float]) -> list[bool]:
    """Of contours with these mean confidences: which are lost."""
    if not means:
        return []
    answer = outcomes([{"keys": [], "confidence": dict(enumerate(means))}]).parts[0]
    return [index in set(answer.lost) for index in range(len(means))]


def mean(drawing: contours.Drawing, span: slice) -> float:
    """The mean confidence of a stroke's points. What is no number counts as lost."""
    values = drawing.value(gp.CONFIDENCE)[span]
    return float(np.nan_to_num(np.clip(values, 0, 1), nan=0.0).mean()) if len(values) else 0.0


def means(handle) -> np.ndarray:
    """The mean confidence of each generated stroke of a drawing. What is no number counts as lost."""
    starts = gp.offsets(handle)
    sizes = np.diff(starts)
    values = np.nan_to_num(np.clip(gp.value(handle, gp.CONFIDENCE, int(starts[-1])), 0, 1), nan=0.0)
    before = np.concatenate([[0.0], np.cumsum(values, dtype=np.float64)])
    made = gp.value(handle, gp.MADE, len(sizes)) & (sizes > 0)
    return (before[starts[1:]] - before[starts[:-1]])[made] / sizes[made]


def weakest(ob, found: contours.Contours) -> tuple[int, float]:
    """The scene frame where the next key helps most, and its doubt as a share of the parts there, 0 to 1.

    The command line has the sum over the parts. Here it is divided by their number: a share can be read without knowing how many there are.
    """
    answer = judged(ob, found)
    if answer.weakest is None:
        raise Problem("Nothing is tracked yet: press Track first")
    frame = answer.weakest
    there = sum(frame in part.made or frame in answer.of(part.number).lost for part in found.parts)
    return frame, min(answer.doubt / max(there, 1), 1.0)

"""Where tracked contours are doubtful: the frame where the next key helps most."""

from __future__ import annotations

import numpy as np

from ..blender import grease_pencil as gp
from ..blender.errors import Problem
from . import contours


def weakest(found: contours.Contours) -> tuple[int, float]:
    """The scene frame with the most doubt, and its doubt.

    The doubt of a frame is the mean of 1 - confidence over a part's points, summed over parts. It is smoothed over three frames
    for the choice. Frames beside a key are chosen only if there are no others. The returned doubt is the mean over parts.
    """
    doubts: dict[int, float] = {}
    for part in found.parts:
        for frame, stroke in part.made.items():
            sure = found.drawings[stroke.layer, frame].value(gp.CONFIDENCE)[stroke.span]
            doubts[frame] = doubts.get(frame, 0.0) + float(np.mean(1 - sure))
    if not doubts:
        raise Problem("No generated frame: press Track first")
    smooth = {
        frame: (doubts.get(frame - 1, 0.0) + 2 * doubt + doubts.get(frame + 1, 0.0)) / 4
        for frame, doubt in doubts.items()
    }
    keys = {frame for part in found.parts for frame in part.keys}
    beside = {frame + step for frame in keys for step in (-1, 0, 1)}
    smooth = {frame: doubt for frame, doubt in smooth.items() if frame not in beside} or smooth
    frame = max(sorted(smooth), key=lambda number: smooth[number])
    return frame, doubts[frame] / max(sum(frame in part.made for part in found.parts), 1)

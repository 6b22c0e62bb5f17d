"""Which pairs In-between would not carry out.

What: In-between trusts a pair by more than its confidence: by the pairs around it, and by whether the whole movement can be believed. Strokes of pairs
that it does not trust give way to each other half way, or the earlier drawing is held. Match Strokes is where the artist mends that,
so it must name the same strokes.

How: the library draws two frames of the span, one on each side of the middle. A stroke that shows fully on the one and not at all on the other gives
way. The pairs that it found meanwhile are those of Match Strokes.

Why so: a bound on the confidence here would be a second opinion, which differs from what is drawn.

Limits: the span is judged by itself, a layer at a time, with the usual settings. Pegs from layers and keys beside the span do not count.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from rototoon import tween

_FRAMES = np.array([0, 4], np.int32)
_AROUND_THE_MIDDLE = [1, 3]


@dataclass
class Found:
    """The matches of two drawings, and what In-between makes of them."""

    matches: tween.Matches
    held: bool
    """Whether it holds the earlier drawing."""
    strokes: set[int]
    """Strokes that give way to others half way, by their index among those of both drawings."""


def match(drawings: tween.Drawings, progress: tween.Progress | None = None) -> Found:
    """Matches two drawings. It does not use Blender, so it may run in a thread."""
    apart = replace(drawings, frames=_FRAMES)
    drawn, matches = tween.draw_in_betweens(apart, [(0, _AROUND_THE_MIDDLE)], progress, spacing=["linear"])
    strokes = np.asarray(drawn.strokes).reshape(-1, 3)[:, :2]
    seen = np.asarray(drawn.opacities).reshape(len(_AROUND_THE_MIDDLE), len(strokes))
    gone = strokes[given_way(seen)]
    return Found(matches, bool(drawn.held[0]), set(gone[gone >= 0].tolist()))


def given_way(opacities: np.ndarray) -> np.ndarray:
    """Which strokes show on a part of the frames only (F, S). What vanishes or appears shrinks, leaves the picture or fades, and is never gone from
    one frame to the next."""
    return np.isin(opacities, (0.0, 1.0)).all(0) & (opacities == 0).any(0)

"""Ends of tracks that go outward from a part's only key, where they end before the footage does. The parts keep them."""

from __future__ import annotations

import json

from ..common import kept

LOST, CUT, LEFT = "lost", "cut", "left"
"""Why a track ends: the part was lost and needs a key; another shot begins; the part left the picture."""


def put(part, ends: list[tuple[int, str]]) -> None:
    """Stores the first picture beyond either end of a part's track, and the reason."""
    text = json.dumps(ends) if ends else ""
    if part.ends != text:
        part.ends = text


def of(part) -> list[tuple[int, str]]:
    """The pictures and reasons that `put` stored."""
    return kept.pairs(part.ends, str)


def wanted(part) -> list[int]:
    """Picture numbers on which a part was lost."""
    return [frame for frame, reason in of(part) if reason == LOST]

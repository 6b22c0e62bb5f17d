"""Where tracks that go outward from a single key end before the footage does, kept with the parts."""

from __future__ import annotations

import json

LOST, CUT, LEFT = "lost", "cut", "left"
"""Why a track ends: the part was lost and wants a key, another shot begins, the part left the picture."""


def put(part, ends: list[tuple[int, str]]) -> None:
    """Notes the first picture beyond a part's track, and why it is beyond, at either end."""
    text = json.dumps(ends) if ends else ""
    if part.ends != text:
        part.ends = text


def of(part) -> list[tuple[int, str]]:
    """What `put` noted."""
    return [(int(frame), reason) for frame, reason in json.loads(part.ends)] if part.ends else []


def wanted(part) -> list[int]:
    """Pictures on which a part was lost."""
    return [frame for frame, reason in of(part) if reason == LOST]

"""Numbers in messages."""

from __future__ import annotations

from collections.abc import Iterable, Sized


def counted(number: int, noun: str) -> str:
    """A number with its noun: 1 frame, 2 frames."""
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def listed(frames: list[int]) -> str:
    """Frame numbers as a text; neighbours become spans: 3 to 5, 9 and 12."""
    spans: list[list[int]] = []
    for frame in sorted(frames):
        if spans and frame == spans[-1][1] + 1:
            spans[-1][1] = frame
        else:
            spans.append([frame, frame])
    texts = [str(a) if a == b else f"{a} {'and' if b == a + 1 else 'to'} {b}" for a, b in spans]
    return texts[0] if len(texts) == 1 else ", ".join(texts[:-1]) + f" and {texts[-1]}"


def are(things: Sized) -> str:
    """The verb for one thing, or for several."""
    return "is" if len(things) == 1 else "are"


def stayed(noun: str, frames: Iterable[int]) -> str:
    """That drawings stay because the artist had changed them; empty without any."""
    frames = sorted(set(frames))
    if not frames:
        return ""
    if len(frames) == 1:
        return f"the {noun} that you had changed on frame {frames[0]} stays, as a key"
    return f"the {noun}s that you had changed on frames {listed(frames)} stay, as keys"


def joined(*texts: str) -> str:
    """Texts with commas between; empty ones are left out."""
    return ", ".join(filter(None, texts))

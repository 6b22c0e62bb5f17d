"""The artist's choices for in-betweens, and the options of the library that follow from them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields, replace
from itertools import pairwise
from typing import Any

from ..blender.errors import Problem
from ..common.wording import counted
from . import spacing_parts

SPACINGS = (
    (
        "SMOOTH",
        "Smooth",
        "One velocity through several keys, and at rest at the first key, the last key, and where the movement turns back",
    ),
    ("LINEAR", "Linear", "Constant speed"),
    ("EASE_IN", "Ease In", "Starts at rest and speeds up"),
    ("EASE_OUT", "Ease Out", "Slows down and ends at rest"),
    ("EASE_IN_OUT", "Ease In and Out", "Starts and ends at rest"),
    ("COSINE", "Cosine", "Starts and ends at rest, a little softer"),
    ("BOUNCE", "Bounce", "Falls like a ball, and bounces before it comes to rest"),
    ("CHART", "Chart", "Your list of percentages, one for each in-between"),
    ("CURVE", "Curve", "The curve that you draw in the panel Tween"),
)
LEAVING = (
    ("GROW", "Grow and Shrink", "They grow from their middle and shrink into it"),
    ("FADE", "Fade", "They fade in and out"),
    ("LEAVE", "Leave the Picture", "They come in from outside the picture and leave it, away from the picture's middle"),
)
PEGS = (
    ("FOUND", "Found", "Find the strokes that move as one, and their joints"),
    ("GROUPS", "Layer Groups", "The layers of a group move as one. A group inside another group hangs on that group"),
    ("LAYERS", "Layers", "Each layer moves as one, and hangs on its group"),
)

WHOLE = (0.0, 1.0)


@dataclass(frozen=True)
class Choices:
    """The choices for a span."""

    spacing: str = "SMOOTH"
    chart: str = ""
    """Percentages of the spacing CHART."""
    bounces: int = 3
    arcs: float = 0.5
    rigid: bool = True
    contacts: bool = True
    leaving: str = "GROW"
    rest: bool = True
    step: int = 1
    curve: tuple[tuple[float, float], ...] = ()
    """Times and shares of the spacing CURVE."""
    pegs: str = "FOUND"
    follow: bool = False
    """Whether strokes follow the captured contours on which they lie. It is false in older files, which do not have this
    choice."""
    part: tuple[float, float] = WHOLE
    """From when to when of the spacing a span has, if a breakdown divided its span: see `spacing_parts`."""

    def kept(self) -> dict[str, Any]:
        """The form in the file."""
        return asdict(self)

    @classmethod
    def of(cls, kept: dict[str, Any]) -> Choices:
        """The choices from a file. Unknown fields are left out."""
        names = {field.name for field in fields(cls)}
        known = {name: value for name, value in kept.items() if name in names}
        if "curve" in known:
            known["curve"] = tuple((float(time), float(share)) for time, share in known["curve"])
        if "part" in known:
            start, end = known["part"]
            known["part"] = (float(start), float(end))
        return cls(**known)

    def frames(self, first: int, last: int) -> list[int]:
        """The frames between two keys that get a drawing."""
        return list(range(first + self.step, last, self.step))

    def written(self, first: int, last: int) -> Any:
        """The spacing from one key to the next, as the library takes it."""
        whole = self._whole(first, last)
        return whole if self.part == WHOLE else spacing_parts.part(whole, *self.part, last - first)

    def part_shares(self, first: int, last: int) -> list[float]:
        """The shares of a part of a spacing on the drawings between two keys."""
        written, length = self.written(first, last), last - first
        places = [[0.0, 0.0], *written["curve"]] if isinstance(written, dict) else [[step / length, step / length] for step in range(length)]
        return [round(places[(frame - first) * (len(places) // length)][1], 6) for frame in self.frames(first, last)]

    def divided(self, first: int, last: int, span: tuple[int, int]) -> Choices:
        """The choices for a span inside the one from `first` to `last`, which has these. Movements that know all keys, and even ones, need no part."""
        if span == (first, last) or self.spacing in ("SMOOTH", "LINEAR"):
            return self
        start, end = ((frame - first) / (last - first) for frame in span)
        whole = self._timed(first, last) if self.part == WHOLE else self
        begin, length = self.part[0], self.part[1] - self.part[0]
        return replace(whole, part=(begin + length * start, begin + length * end))

    def _timed(self, first: int, last: int) -> Choices:
        """The same, where the times of a chart do not depend on the frames of the span."""
        frames = self.frames(first, last)
        if self.spacing != "CHART" or not frames or frames[-1] + self.step == last:
            return self
        return replace(self, spacing="CURVE", chart="", curve=tuple(map(tuple, self._whole(first, last)["curve"])))

    def _whole(self, first: int, last: int) -> Any:
        if self.spacing == "BOUNCE":
            return {"bounce": self.bounces}
        if self.spacing == "CURVE":
            return {"curve": [list(place) for place in self.curve]}
        if self.spacing != "CHART":
            return self.spacing.lower()
        shares = percentages(self.chart)
        frames = self.frames(first, last)
        if len(shares) == len(frames) and self.part == WHOLE:
            times = [(frame - first) / (last - first) for frame in frames]
        else:
            times = [(k + 1) / (len(shares) + 1) for k in range(len(shares))]
        return {"curve": [[time, share] for time, share in zip(times, shares)]}

    def need_chart(self, first: int, last: int) -> None:
        """Raises a `Problem` if the chart has not one percentage for each drawing between two keys."""
        wanted = len(self.frames(first, last))
        if self.spacing != "CHART" or not wanted:
            return
        found = len(percentages(self.chart))
        if found != wanted:
            raise Problem(
                f"The chart has {counted(found, 'percentage')}, expected {wanted}, one for each drawing between the keys on {first} and {last}"
            )

    def shared(self) -> dict[str, Any]:
        """The options of the library that all spans of a call have in common. Leaving the picture also needs its size: see
        `Sheet.leaving`."""
        return {
            "arcs": self.arcs,
            "rigid": self.rigid,
            "contacts": self.contacts,
            "leaving": self.leaving.lower(),
            "rest": self.rest,
        }


def joined(parts: Sequence[Choices]) -> Choices:
    """The choices of neighbouring spans between which a breakdown was removed: the spacing that it had divided, otherwise that of the first one."""
    first, last = parts[0], parts[-1]
    meet = all(abs(one.part[1] - other.part[0]) < 1e-9 for one, other in pairwise(parts))
    if not meet or any(replace(each, part=WHOLE) != replace(first, part=WHOLE) for each in parts):
        return replace(first, part=WHOLE)
    start, end = first.part[0], last.part[1]
    return replace(first, part=WHOLE if start < 1e-9 and end > 1 - 1e-9 else (start, end))


def places(text: str) -> tuple[tuple[float, float], ...]:
    """Times and shares of a list such as "0 0, 0.3 0.8, 1 1"."""
    found = []
    for pair in (words.split() for words in text.split(",") if words.strip()):
        try:
            time, share = map(float, pair)
        except ValueError:
            said = " ".join(pair)
            raise Problem(f'The curve has "{said}", expected a time and a share such as 0.3 0.8') from None
        if not (0 <= time <= 1 and -10 <= share <= 10):
            raise Problem(f"The curve has {time:g} {share:g}, expected a time from 0 to 1 and a share from -10 to 10")
        if found and found[-1][0] >= time:
            raise Problem(f"The curve has {time:g} after {found[-1][0]:g}, expected times that rise")
        found.append((time, share))
    if len(found) == 1 and found[0][0] in (0, 1):
        # The two keys are the ends of every curve, so this one would be a straight line.
        time, share = found[0]
        raise Problem(f"The curve has only {time:g} {share:g}, expected a place between the keys or two places, such as 0 0, 0.3 0.8, 1 1")
    return tuple(found)


def even(count: int) -> str:
    """The chart of an even movement over so many in-betweens."""
    return ", ".join(f"{100 * (k + 1) / (count + 1):.4g}" for k in range(count))


def is_even(text: str) -> bool:
    """Whether a chart is an even one as it is written here."""
    return text == even(len(percentages(text)))


def percentages(text: str) -> list[float]:
    """Shares of a list such as "10, 25 50 90"."""
    words = text.replace(",", " ").replace("%", " ").replace(";", " ").split()
    if not words:
        raise Problem("The chart is empty: write one percentage for each in-between, such as 10, 30, 70, 90")
    shares = []
    for word in words:
        try:
            share = float(word) / 100
        except ValueError:
            raise Problem(f'The chart has "{word}", expected percentages such as 10, 30, 70, 90') from None
        if not -10 <= share <= 10:
            raise Problem(f"The chart has {word}, expected percentages from -1000 to 1000")
        shares.append(share)
    return shares

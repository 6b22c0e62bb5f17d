"""Which part a stroke can be that the artist drew on a tracked frame.

On a frame without tracked contours the artist draws the figure anew, and the matcher looks for a movement of the whole figure. On a
tracked frame most contours are where they belong. A new stroke there is a correction of a contour or a new part, and a movement of
the figure would explain any stroke as any part. So each stroke is judged alone, beside the contour that each part has there:

- A part whose contour is there and sure is only taken if the stroke has one of its layers and materials, about its size, and lies on
  it (`NEAR`). Farther away (`BESIDE`) the stroke must also have its shape, as an arm has that was turned about the shoulder.
- A part whose contour is there but probably wrong (`LOST`) is also found elsewhere, by shape and size.
- A part without a contour there is looked for everywhere: the artist deleted it to draw it anew, or tracking did not come so far. A
  stroke with another layer or material is only taken if size and shape agree well.

A distance counts in radii of the part, which is the root mean square distance of its outline from its middle. Sizes are compared by
radii, shapes after the best rotation, scale and shift (`unlike`).

Limits: a new part that looks like a known one and lies beside it is taken for it. So every judgement that has a likely rival, or
that another reading is close to, has a `doubt`, which the message of the operator names.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

NEAR = 0.75
"""Radii. A stroke whose middle is within this distance of a contour lies on it."""
BESIDE = 2.0
"""Radii. Two discs that touch are so far apart."""
SIZE = 1.8
"""Largest ratio of two sizes that may be the same part."""
ALIKE_SIZE = 1.4
"""Largest ratio of two sizes that agree."""
ALIKE = 0.2
"""Largest share of a shape that another one leaves unexplained, if they agree. An ellipse of 3 to 2 beside a disc has 0.2."""
SIMILAR = 0.35
"""The same for a part that is missing. An ellipse of 2 to 1 beside a disc has 0.32."""
LOST = 0.5
"""Mean confidence below which a tracked contour is probably wrong, as where lost contours are marked."""
RIVAL = 0.3
"""A part whose cost is greater by less than this could be meant as well."""
SAMPLES = 64
"""Points along an outline for its size and place."""


@dataclass(frozen=True)
class Known:
    """What is known of a part on the frame."""

    name: str
    closed: bool
    points: np.ndarray
    """Its contour in pixels (N, 2): on the frame, or on the nearest frame that has one."""
    labels: frozenset[tuple[str, ...]]
    """The layers and materials of its strokes."""
    there: bool
    """Whether it has a tracked contour on the frame."""
    lost: bool = False
    """Whether that contour is probably wrong."""


@dataclass(frozen=True)
class Drawn:
    """A stroke that the artist drew on the frame."""

    closed: bool
    points: np.ndarray
    labels: tuple[str, ...]


@dataclass(frozen=True)
class Judged:
    """A stroke that is taken for a part."""

    part: int
    stroke: int
    points: np.ndarray
    """The part's control points on the drawn line."""
    doubt: str
    """Why it could be another part or a new one; empty if that is unlikely."""


Match = Callable[[Known, Drawn], np.ndarray | None]
"""Gives a part's control points on a drawn line, or `None` if the shapes are too different."""


def judge(known: list[Known], drawn: list[Drawn], match: Match) -> tuple[list[Judged], dict[int, str]]:
    """Strokes that are taken for parts, and for other strokes, by number, the part that they also look like."""
    pairs: list[tuple[float, int, int, np.ndarray, str]] = []
    others: dict[int, list[_Pair]] = {}
    for i, part in enumerate(known):
        for j, stroke in enumerate(drawn):
            pair = _Pair(part, stroke, match)
            if pair.admitted():
                pairs.append((pair.cost(), i, j, pair.points, pair.doubt()))
            else:
                others.setdefault(j, []).append(pair)
    chosen = _choose(known, sorted(pairs, key=lambda pair: pair[:3]))
    taken = {each.stroke for each in chosen}
    # To compare shapes is dear, so only strokes that are left are compared with all parts.
    alike = {j: [pair for pair in own if pair.labelled and pair.alike()] for j, own in others.items() if j not in taken}
    like = {j: min(own, key=lambda pair: pair.unlike() + pair.growth).part.name for j, own in alike.items() if own}
    return chosen, like


def _choose(known: list[Known], pairs: list[tuple[float, int, int, np.ndarray, str]]) -> list[Judged]:
    """The pairs of least cost first. Each part and each stroke is taken once."""
    parts: set[int] = set()
    strokes: set[int] = set()
    chosen = []
    for cost, i, j, points, doubt in pairs:
        if i in parts or j in strokes:
            continue
        rivals = [known[p].name for c, p, s, *_ in pairs if s == j and p != i and p not in parts and c - cost < RIVAL]
        if rivals:
            doubt = " or ".join(f'it could be "{name}"' for name in rivals)
        parts.add(i)
        strokes.add(j)
        chosen.append(Judged(i, j, points, doubt))
    return chosen


class _Pair:
    """A part beside a stroke. What is dear is worked out when it is asked for."""

    def __init__(self, part: Known, stroke: Drawn, match: Match):
        self.part, self.stroke, self._match = part, stroke, match
        middle, radius = outline(part.points, part.closed)
        drawn, drawn_radius = outline(stroke.points, stroke.closed)
        self.away = float(np.linalg.norm(drawn - middle) / radius)
        self.growth = float(abs(np.log(drawn_radius / radius)))
        self.labelled = stroke.labels in part.labels
        self._points: np.ndarray | None = None
        self._unlike: float | None = None

    @property
    def points(self) -> np.ndarray | None:
        """The part's control points on the drawn line."""
        if self._unlike is None:
            self._points = self._match(self.part, self.stroke)
            self._unlike = np.inf if self._points is None else unlike(self.part.points, self._points)
        return self._points

    def unlike(self) -> float:
        """The share of the part's shape that the stroke does not have."""
        return self._unlike if self.points is not None else np.inf

    def alike(self) -> bool:
        """Whether size and shape agree."""
        return self.growth <= np.log(ALIKE_SIZE) and self.unlike() <= ALIKE

    def admitted(self) -> bool:
        """Whether the stroke can be the part."""
        part = self.part
        if self.growth > np.log(SIZE) or (part.there and not (self.labelled and (part.lost or self.away <= BESIDE))):
            return False
        if self.points is None:
            return False
        if not part.there:
            return self.alike() or (self.labelled and (self.away <= BESIDE or self.unlike() <= SIMILAR))
        return self.away <= NEAR or self.alike()

    def cost(self) -> float:
        """The better the stroke fits, the less. A part that has its contour is expected in its place."""
        return min(self.away, 10.0) * (0.3 if not self.part.there or self.part.lost else 1.0) + 2 * self.unlike() + self.growth

    def doubt(self) -> str:
        """Why the stroke could be a new part."""
        if not self.labelled:
            return f'"{self.part.name}" has another layer or material elsewhere'
        if self.part.there and not self.part.lost and self.away > NEAR:
            return "it lies beside the tracked contour"
        if not self.alike():
            return "it has another size or shape"
        return ""


def outline(points: np.ndarray, closed: bool) -> tuple[np.ndarray, float]:
    """The middle and the radius of an outline, by places that are evenly spaced along it."""
    ring = np.concatenate([points, points[:1]]) if closed else points
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(ring, axis=0), axis=1))])
    at = (np.arange(SAMPLES) + 0.5) * along[-1] / SAMPLES
    places = np.stack([np.interp(at, along, ring[:, k]) for k in (0, 1)], 1)
    middle = places.mean(0)
    return middle, max(float(np.sqrt(((places - middle) ** 2).sum(1).mean())), 0.5)


def unlike(first: np.ndarray, second: np.ndarray) -> float:
    """The share of a shape (N, 2) that another one with the same points does not explain, after the best shift, rotation and scale:
    0 for the same shape, 1 for one that has nothing of it."""
    a, b = ((p - p.mean(0)) @ np.array([1, 1j]) for p in (first, second))
    square = float((np.abs(a) ** 2).sum() * (np.abs(b) ** 2).sum())
    if square < 1e-12:
        return 0.0
    return float(np.sqrt(max(0.0, 1.0 - np.abs(np.vdot(a, b)) ** 2 / square)))

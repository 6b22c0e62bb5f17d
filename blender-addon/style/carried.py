"""Which parts a limb carries.

A line across a limb lies where two parts overlap, at a joint. It is near the contours of both, so which of them is nearest says little. What a
limb carries is seen between its two lines: the part that most of the way from the middle of the one to the middle of the other lies in.

A hand has no key point behind the wrist. So the last limb of an arm, a leg or a tail carries what hangs on its end, too: parts that begin at the line, go on beyond the limb's own part, are
no larger than it, and are no other limb's.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..common import polygons

WAY = 24
"""Number of places on the way between two lines."""
LEAST = 0.4
"""Least share of the way that lies in the part of a limb."""
ALIKE = 0.1
"""Of parts whose shares differ by less, the smallest counts: a hand lies on a coat."""


@dataclass(frozen=True)
class Way:
    """A limb between its two lines on one frame, in pixels."""

    frame: int
    start: np.ndarray
    end: np.ndarray
    """The middles of the lines."""
    width: float
    """Length of the line at its end."""
    is_last: bool
    """Whether it is the last limb of an arm, a leg or a tail."""


def of(ways: list[Way | None], parts: list[dict[str, Any]]) -> list[list[str]]:
    """For each limb the parts that it carries; none where that is not seen."""
    own = [way and _along(way, _contours(parts, way.frame)) for way in ways]
    taken = {name for name in own if name}
    carried = []
    for way, name in zip(ways, own):
        found = [name] if name else []
        if way and name and way.is_last:
            found += _hanging(way, name, taken, _contours(parts, way.frame))
        carried.append(found)
    return carried


def _contours(parts: list[dict[str, Any]], frame: int) -> dict[str, np.ndarray]:
    """The closed contours on a frame, by the name of the part."""
    found = {}
    for part in parts:
        points = part.get("keys", {}).get(str(frame)) or part.get("tracks", {}).get(str(frame))
        if part["closed"] and points and len(points) > 2:
            found[part["name"]] = np.asarray(points, float)
    return found


def _along(way: Way, contours: dict[str, np.ndarray]) -> str | None:
    """The part in which most of the way lies."""
    shares = (np.arange(WAY) + 0.5) / WAY
    places = way.start + shares[:, None] * (way.end - way.start)
    within = {name: float(polygons.inside([points], places).mean()) for name, points in contours.items()}
    most = max(within.values(), default=0.0)
    if most < LEAST:
        return None
    alike = [name for name, share in within.items() if share > most - ALIKE]
    return min(alike, key=lambda name: abs(polygons.area(contours[name])))


def _hanging(way: Way, own: str, taken: set[str], contours: dict[str, np.ndarray]) -> list[str]:
    """The parts that hang on the end of a limb."""
    most, end = abs(polygons.area(contours[own])), _reach(way, contours[own])
    found = []
    for name, points in contours.items():
        begins = polygons.inside([points], way.end[None])[0] or np.linalg.norm(points - way.end, axis=1).min() <= way.width / 2
        if name not in taken and begins and _reach(way, points) > end and abs(polygons.area(points)) <= most:
            found.append(name)
    return found


def _reach(way: Way, points: np.ndarray) -> float:
    """How far a contour goes along the limb and beyond, from its first line."""
    along = way.end - way.start
    return float(((points - way.start) @ along).max()) / max(float(np.linalg.norm(along)), 1e-9)

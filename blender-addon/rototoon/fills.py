"""Painted line drawings: the regions of every frame with their colours. `Session.fill` makes them from a painter's clicks.

::

    from rototoon import Session
    from rototoon.fills import Click

    paper, skin = (1, 1, 1), (0.96, 0.8, 0.69)
    with Session.open("shot_010/project.json") as session:
        filled = session.fill([Click(0, (5, 5), paper), Click(0, (310, 180), skin)])
        for region in filled.on(12):
            print(region.track, region.colour, len(region.outline), "points,", len(region.holes), "holes")

Coordinates are pixels, colours sRGB from 0 to 1. `Filled` has flat arrays for NumPy; `Filled.on` gives the regions of one frame.
"""

from __future__ import annotations

import array
import json
import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from .native.errors import RototoonError

DOUBT = 0.5
"""Confidence below which the library calls a region doubtful: its colour is probably wrong."""


class Click(NamedTuple):
    """A click with the paint bucket."""

    frame: int
    """The frame, as in the document."""
    at: tuple[float, float]
    """The place in the region, in pixels."""
    colour: tuple[float, float, float] | None
    """sRGB from 0 to 1. `None` says that the region stays without paint."""
    name: str | None = None
    """The name of the colour. Two names stay two colours, even if they look the same."""


class Hue(NamedTuple):
    """A colour of paint: by its name if it has one, otherwise by its look."""

    colour: tuple[float, float, float]
    """sRGB from 0 to 1."""
    name: str | None = None
    """Its name."""


class Recolour(NamedTuple):
    """A colour that becomes another one on some frames: a character gets wet, a lamp is switched on."""

    old: Hue
    """The colour before."""
    new: Hue
    """The colour that it becomes."""
    first: int | None = None
    """The first frame; `None` for all before `last`."""
    last: int | None = None
    """The last frame; `None` for all from `first` on."""


class Leak(NamedTuple):
    """A click from which a gap in a line leads to the edge of the picture."""

    frame: int
    """The frame, as in the document."""
    click: int
    """Index of the click among those of the frame."""
    parted: bool
    """Whether the gap was closed. Otherwise the region goes through it, and is in doubt."""
    gap: tuple[float, float]
    """The place of the gap, in pixels."""
    width: float
    """How wide the gap is, in pixels."""
    size: tuple[int, int]
    """Width and height in pixels of what the click paints."""


@dataclass(frozen=True)
class Region:
    """A painted region on one frame."""

    track: int
    """Its number, the same on all frames."""
    outline: memoryview
    """float64 (N, 2), pixels. The last point joins the first."""
    holes: list[memoryview]
    """The outlines of its holes, in the same form."""
    colour: tuple[float, float, float]
    """sRGB from 0 to 1."""
    confidence: float
    """The probability, 0 to 1, that the colour is right. It is 1 where a painter clicked."""
    doubtful: bool
    """Whether the colour is probably wrong."""
    name: str | None = None
    """The name of its colour."""


@dataclass(frozen=True)
class Doubt:
    """A region whose colour is in doubt somewhere."""

    track: int
    """Its number."""
    frames: list[int]
    """Frames on which its colour is probably wrong, rising. A click on the first one mends the others, too."""


@dataclass(frozen=True)
class Filled:
    """The regions of F frames: R regions with K outlines of P points. All arrays are read-only."""

    frames: memoryview
    """int32 (F,): frame numbers, rising."""
    region_offsets: memoryview
    """int32 (F + 1,): frame `f` has the regions `region_offsets[f]` to `region_offsets[f + 1]`. Later ones lie over earlier ones."""
    tracks: memoryview
    """int32 (R,): the number of each region, the same on all frames. On one frame each number occurs once."""
    colours: memoryview
    """float64 (R, 3): sRGB from 0 to 1."""
    confidence: memoryview
    """float64 (R,): for each region the probability that its colour is right; 1 where a painter clicked."""
    doubtful: memoryview
    """int32 (R,): not 0 if the colour is probably wrong."""
    outline_offsets: memoryview
    """int32 (R + 1,): region `i` has the outlines `outline_offsets[i]` to `outline_offsets[i + 1]`: its own, then those of its holes."""
    point_offsets: memoryview
    """int32 (K + 1,): outline `k` has the points `point_offsets[k]` to `point_offsets[k + 1]`."""
    points: memoryview
    """float64 (P, 2), pixels."""
    names: list[str | None] = field(default_factory=list)
    """The names of the regions' colours."""
    missed: list[tuple[int, int]] = field(default_factory=list)
    """Clicks that lie on a line or outside of the picture, and so paint nothing: frame, and index among the clicks of that frame. Only
    `Session.fill` fills it."""
    unrelated: list[int] = field(default_factory=list)
    """Frames that stay unpainted, since no painted drawing shows the same. Only `Session.fill` fills it."""
    overruled: list[tuple[int, int]] = field(default_factory=list)
    """Clicks that paint nothing because a later click has given their region another colour: frame, and index among the clicks of that
    frame. Only `Session.fill` fills it."""
    bare: list[int] = field(default_factory=list)
    """Frames with hardly any regions for what was clicked: their lines were probably not found. Only `Session.fill` fills it."""
    leaking: list[Leak] = field(default_factory=list)
    """Clicks from which a gap in a line leads to the edge of the picture. Only `Session.fill` fills it."""

    def on(self, frame: int) -> list[Region]:
        """The regions of a frame; later ones lie over earlier ones. There are none on a frame that was not painted."""
        numbers = self.frames.tolist()
        if frame not in numbers:
            return []
        place = numbers.index(frame)
        return [self._region(i) for i in range(self.region_offsets[place], self.region_offsets[place + 1])]

    def doubts(self) -> list[Doubt]:
        """The regions whose colour is probably wrong on some frame, by number."""
        bounds, found = self.region_offsets, {}
        for place, frame in enumerate(self.frames.tolist()):
            for i in range(bounds[place], bounds[place + 1]):
                if self.doubtful[i]:
                    found.setdefault(self.tracks[i], []).append(frame)
        return [Doubt(track, found[track]) for track in sorted(found)]

    def _region(self, i: int) -> Region:
        first, last = self.outline_offsets[i], self.outline_offsets[i + 1]
        outline, *holes = [self._outline(k) for k in range(first, last)]
        red, green, blue = (self.colours[i, channel] for channel in range(3))
        return Region(self.tracks[i], outline, holes, (red, green, blue), self.confidence[i], bool(self.doubtful[i]), self.names[i])

    def _outline(self, k: int) -> memoryview:
        first, last = self.point_offsets[k], self.point_offsets[k + 1]
        # A memoryview of two dimensions cannot be cut; its bytes can.
        flat = self.points.cast("B")[16 * first : 16 * last]
        return flat.cast("d", (last - first, 2)) if last > first else flat.cast("d")


def as_json(clicks: Iterable[Click]) -> str:
    """Clicks in the form of a document."""
    found: dict[int, list[dict[str, Any]]] = {}
    for click in clicks:
        own: dict[str, Any] = {"at": [float(value) for value in click.at]}
        own["colour"] = None if click.colour is None else [float(value) for value in click.colour]
        found.setdefault(int(click.frame), []).append(own | ({} if click.name is None else {"name": click.name}))
    return json.dumps([{"frame": frame, "regions": found[frame]} for frame in sorted(found)])


def read(clicks: Iterable[Click]) -> list[Click]:
    """The clicks, of which each may be a plain tuple."""
    found = []
    for k, click in enumerate(clicks):
        try:
            found.append(click if isinstance(click, Click) else Click(*click))
        except TypeError as error:
            raise _wrong(k, click) from error
    return found


def _wrong(k: int, click: object) -> RototoonError:
    expected = "a frame, a place (x, y) and a colour (r, g, b), or None for no paint"
    return RototoonError(f"clicks[{k}]: found {click!r}, expected {expected}")


def flat(clicks: Iterable[Click]) -> tuple[array.array[int], array.array[float], array.array[float]]:
    """The frames, places and colours of clicks, as flat arrays."""
    frames, places, colours = array.array("i"), array.array("d"), array.array("d")
    for k, click in enumerate(clicks):
        try:
            frame, (x, y), colour, *_ = click
            red, green, blue = (math.nan,) * 3 if colour is None else colour
            frames.append(frame)
            places.extend((x, y))
            colours.extend((red, green, blue))
        except (TypeError, ValueError, OverflowError) as error:
            raise _wrong(k, click) from error
    return frames, places, colours


def recolours_as_json(recolours: Iterable[Recolour]) -> str:
    """Colours that become others in the form of a document's `recolours`."""

    def hue(own: Hue) -> dict[str, Any]:
        return {"colour": list(own.colour)} | ({} if own.name is None else {"name": own.name})

    found = []
    for own in recolours:
        ends = {name: frame for name, frame in (("first", own.first), ("last", own.last)) if frame is not None}
        found.append({"from": hue(own.old), "to": hue(own.new), **ends})
    return json.dumps(found)


def recolours_of_json(text: str) -> list[Recolour]:
    """Colours that become others, as a session gives them."""

    def hue(own: dict[str, Any]) -> Hue:
        red, green, blue = own["colour"]
        return Hue((red, green, blue), own.get("name"))

    return [Recolour(hue(own["from"]), hue(own["to"]), own.get("first"), own.get("last")) for own in json.loads(text)]

"""The artist's shapes as clicks of a painter: where in the region, and in which colour."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..blender import colours, fill_materials
from ..blender import grease_pencil as gp
from ..common import polygons
from . import sheets, shapes

MOST = 3
"""Most clicks of one shape. A fill may cover several regions of the picture."""
LEAST = 0.004
"""Least distance of a further click from the edge of its shape, as a share of the picture's height."""


@dataclass(frozen=True)
class Click:
    """A click of the artist on a frame."""

    at: tuple[float, float]
    """Footage pixels."""
    colour: tuple[float, float, float] | None
    """sRGB from 0 to 1. `None` says that the region stays without paint."""
    stroke: int
    """The stroke that it stands for, as an index in its drawing."""
    name: str | None = None
    """The name of its colour: that of its material."""


def of(ob, sheet: sheets.Sheet, mapping, height: int) -> list[Click]:
    """The clicks of a drawing. `height` is that of the picture."""
    content = sheet.content
    own = sheets.shapes_of(ob, content, mapping, sheet.own)
    seen = colours.of_strokes(ob, content, colours.palette(ob)).clip(0, 1).round(6)
    names = fill_materials.names_of_strokes(ob, content)
    exact, bare = content.strokes(gp.CLICK), fill_materials.are_bare(ob, content)
    found = []
    for k, shape in enumerate(own):
        first = shape.strokes[0]
        places = _places(shape, own[k + 1 :], exact[first], height)
        colour, name = (None, None) if bare[first] else (tuple(seen[first].tolist()), names[first])
        found += [Click((float(x), float(y)), colour, first, name) for x, y in places]
    return found


def asked(own: Iterable[Click]) -> list[dict[str, Any]]:
    """Clicks in the form of a document."""
    found = []
    for click in own:
        found.append({"at": list(click.at), "colour": None if click.colour is None else list(click.colour)})
        if click.name is not None:
            found[-1]["name"] = click.name
    return found


def _places(shape: sheets.Shape, above: list[sheets.Shape], exact: np.ndarray, height: int) -> np.ndarray:
    """Where to click for a shape: where the artist clicked with the bucket, otherwise well inside and not below another shape."""
    place = np.asarray(exact[None, :2], np.float64)
    if exact[2] > 0 and polygons.inside(shape.loops, place)[0]:
        return place
    places = shapes.middles(shape.loops).round(4)
    open_ = np.ones(len(places), bool)
    for other in above:
        open_ &= ~polygons.inside(other.loops, places)
    # A shape that others cover completely still has its colour.
    places = places[open_] if open_.any() else places
    return _spread(places, shapes.clearance(shape.loops, places), LEAST * height) if len(places) else places


def _spread(places: np.ndarray, clear: np.ndarray, least: float) -> np.ndarray:
    """The place farthest from the edge, and others that are far from those before and not near the edge."""
    taken = [int(clear.argmax())]
    while len(taken) < MOST:
        away = np.linalg.norm(places[:, None] - places[taken], axis=2).min(1)
        worth = np.where((clear >= least) & (away > clear + clear[taken].max()), np.minimum(away, 4 * clear), 0.0)
        if not worth.max(initial=0.0):
            break
        taken.append(int(worth.argmax()))
    return places[taken]

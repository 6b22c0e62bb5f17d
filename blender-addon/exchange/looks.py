"""The looks of an object's contours: layer, plane, widths, colours, material, and attributes of the artist's own. A document has none of them, so
contours that come back from one get those that their part had."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field

import numpy as np

from ..blender import grease_pencil as gp
from ..blender import own_attributes
from ..blender.errors import Problem
from ..capture import contours, document, identity, writing


@dataclass
class Look:
    """The look of a part on its keys."""

    layer: str
    pictures: np.ndarray
    """The numbers of the pictures of its keys."""
    point: dict[str, np.ndarray]
    """By attribute (K, points[, k])."""
    curve: dict[str, np.ndarray]
    """By attribute (K[, k])."""

    def at(self, picture: int, count: int) -> dict[str, np.ndarray]:
        """The attributes on the key nearest to a picture, for a contour with `count` points."""
        key = int(np.abs(self.pictures - picture).argmin())
        found = {name: values[key][None] for name, values in self.curve.items()}
        for name, values in self.point.items():
            found[name] = values[key][np.rint(np.linspace(0, len(values[key]) - 1, count)).astype(int)]
        return found


@dataclass
class Looks:
    """The looks of an object's parts by name."""

    parts: dict[str, Look] = field(default_factory=dict)
    own: dict[str, own_attributes.Kind] = field(default_factory=dict)
    """The artist's own attributes among them."""
    planes: dict[str, np.ndarray] = field(default_factory=dict)
    """The artist's points by the layer of contours on which they are. Contours of a document come onto their plane."""

    def look_of(self, name: str) -> Look | None:
        """The look of a part of a document. Blender has names without the blanks at their ends."""
        return self.parts.get(name) or self.parts.get(name.strip())

    def layer_of(self, name: str, otherwise: str) -> str:
        """The layer of a part."""
        look = self.look_of(name)
        return otherwise if look is None else look.layer

    def rows(self, strokes: Iterable[tuple[str, int, int]], picture: int) -> Iterator[tuple[str, np.ndarray]]:
        """The attributes of strokes on a picture, with defaults where a part has none. A stroke is a part's name, its number and its number of points."""
        strokes = list(strokes)
        looks = [self.look_of(name) for name, *_ in strokes]
        found = [{} if look is None else look.at(picture, count) for look, (_, _, count) in zip(looks, strokes, strict=True)]
        for name in dict.fromkeys(name for each in found for name in each):
            kind, domain = self.own.get(name) or gp.TYPES[name]
            counts = [count if domain == "POINT" else 1 for _, _, count in strokes]
            values = [each[name] if name in each else gp.blank(name, count, kind) for each, count in zip(found, counts, strict=True)]
            if name == "fill_id":
                values = [np.where(each != 0, gp.FILL_BASE + number, 0) for each, (_, number, _) in zip(values, strokes, strict=True)]
            yield name, np.concatenate(values)


def of(ob) -> Looks:
    """The looks of an object's contours."""
    found, settings = contours.read(ob), ob.rototoon
    with suppress(Problem):
        # New strokes are parts of a document that was written meanwhile. Without footage there is none.
        identity.decide(found, document.mapper_of(ob, found), settings.next_number)
    points = document.drawn_points(found)
    looks = Looks(own=found.own(), planes={found.layer_names[index]: own for index, own in points.items()})
    for part in found.parts:
        if part.keys:
            point, curve, frames = writing.styles(part, found, looks.own)
            del curve["cyclic"]
            looks.parts[part.name] = Look(found.layer_names[part.layer], np.array(frames) - settings.frame_offset, point, curve)
    return looks

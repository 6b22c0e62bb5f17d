"""Captured contours that in-betweens follow: an object's tracked parts, on the sheets that are drawn.

The drawings on two keys do not show how far a movement has come between them, or whether it swings out and back. Tracked footage
does. A part counts for a span if it has a contour, drawn or generated, on every frame from one key to the other. The library
decides which contour a stroke follows: the one on which the stroke lies on both keys.

Contours are taken in the space of the object's layers, not in pixels of the footage. In-betweens need no footage, so the camera does
not matter. The points are rounded, so that a span's digest describes exactly the points from which it was drawn.

Limits: contours and strokes must have the same carrier (see `blender.hierarchy`), and strokes must be drawn on the plane of the
contours. Seen from aside, contours of another plane are elsewhere.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..blender import grease_pencil as gp
from ..blender import hierarchy
from ..capture import contours
from .sheets import Contour, Sheet

DECIMALS = 3
"""Decimals of pixels of the sheet. The sheet is about a thousand pixels large, so this is finer than the stored strokes."""
FARTHEST = 1e9
"""Largest distance from the origin that the library accepts, in pixels."""


@dataclass
class Part:
    """A tracked part."""

    closed: bool
    frames: dict[int, tuple[str, np.ndarray]] = field(default_factory=dict)
    """By scene frame the layer, and the control points (count, 3) in its space."""

    def knows(self, first: int, last: int) -> bool:
        """Whether it has a contour on every frame from `first` to `last`."""
        return all(frame in self.frames for frame in range(first, last + 1))


def read(ob) -> list[Part]:
    """The parts of an object that have a contour."""
    found = contours.read(ob)
    parts = []
    for part in found.parts:
        # The artist's key wins over a generated contour.
        strokes = part.made | part.keys
        frames = {frame: (found.layer_names[s.layer], s.control_points(part.closed)) for frame, s in strokes.items()}
        if frames and part.count:
            parts.append(Part(part.closed, frames))
    return parts


def put_on(ob, sheet: Sheet, parts: list[Part]) -> None:
    """Adds to a sheet the contours that each of its spans may follow."""
    spans = [span for span, choices in sheet.wanted.items() if choices.follow and _is_free(sheet, span)]
    if not parts or not spans:
        return
    to_sheet = _to_sheet(ob, sheet, {name for part in parts for name, _ in part.frames.values()})
    for span in spans:
        first, last = sheet.frames[span], sheet.frames[span + 1]
        known = (_contour(part, first, last, sheet, to_sheet) for part in parts if part.knows(first, last))
        sheet.captured[span] = [contour for contour in known if contour is not None]


def _is_free(sheet: Sheet, span: int) -> bool:
    """Whether any layer has no peg. Strokes on a peg follow the peg instead."""
    pegs = sheet.pegs_of(span)
    return not pegs or not all(pegs)


def _to_sheet(ob, sheet: Sheet, names: set[str]) -> dict[str, np.ndarray]:
    """By contour layer 4×4 to the space of a sheet. Layers with another carrier move against it, and are left out."""
    base = gp.find_layer(ob, sheet.layers[0])
    carrier = hierarchy.carrier(ob, base)
    inverse = np.linalg.inv(hierarchy.in_carrier(base))
    layers = [gp.find_layer(ob, name) for name in sorted(names)]
    return {
        layer.name: inverse @ hierarchy.in_carrier(layer)
        for layer in layers
        if hierarchy.carrier(ob, layer) == carrier
    }


def _contour(part: Part, first: int, last: int, sheet: Sheet, to_sheet: dict[str, np.ndarray]) -> Contour | None:
    """A part on the frames of a span. `None` if it is in another space, or has a point that is not finite."""
    places = [part.frames[frame] for frame in range(first, last + 1)]
    if not all(name in to_sheet for name, _ in places):
        return None
    flat = np.stack([sheet.plane.laid(points, to_sheet[name])[0] for name, points in places])
    if not (np.abs(flat) <= FARTHEST).all():
        return None
    # Adding 0 turns -0 into 0.
    return Contour(part.closed, first, np.round(flat, DECIMALS) + 0.0)

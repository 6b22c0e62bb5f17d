"""The captured contours that in-betweens follow: an object's tracked parts, laid on the sheets that are drawn.

How far something has come between two keys, and whether it swings out and back on its way, the drawings on the keys do not tell;
tracked footage between them does. A part counts for a span if it has a contour, a key or a generated one, on every frame from
the one key to the other. Which of them a stroke follows, the library decides: the one on which it lies on both keys.

Contours are taken where they lie among the object's layers, not in pixels of the footage: in-betweens are drawn without any
footage, and so nothing is asked of the camera. What is handed on is rounded, so that a span's digest tells just what it was
drawn from.

Limits: contours and strokes must be carried by the same thing, or both by nothing but the object, and strokes must be drawn on
the plane of the contours; seen from aside, those of another plane lie elsewhere.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..blender import grease_pencil as gp
from ..blender import hierarchy
from ..capture import contours
from .sheets import Contour, Sheet

DECIMALS = 3
"""Of pixels of the sheet, which is about a thousand large: finer than the strokes are stored."""
FARTHEST = 1e9
"""Pixels from the origin beyond which the library takes no point."""


@dataclass
class Part:
    """A tracked part."""

    closed: bool
    frames: dict[int, tuple[str, np.ndarray]] = field(default_factory=dict)
    """By scene frame the layer and the control points (count, 3) in its space."""

    def knows(self, first: int, last: int) -> bool:
        """Whether it has a contour on every frame from one to another."""
        return all(frame in self.frames for frame in range(first, last + 1))


def read(ob) -> list[Part]:
    """The parts of an object that have a contour; changes nothing."""
    found = contours.read(ob)
    parts = []
    for part in found.parts:
        # A key is what the artist drew, and comes before what is generated.
        strokes = part.made | part.keys
        frames = {frame: (found.layer_names[s.layer], s.control_points(part.closed)) for frame, s in strokes.items()}
        if frames and part.count:
            parts.append(Part(part.closed, frames))
    return parts


def put_on(ob, sheet: Sheet, parts: list[Part]) -> None:
    """Gives a sheet the contours that each of its spans may follow."""
    spans = [span for span, choices in sheet.wanted.items() if choices.follow and _is_free(sheet, span)]
    if not parts or not spans:
        return
    to_sheet = _to_sheet(ob, sheet, {name for part in parts for name, _ in part.frames.values()})
    for span in spans:
        first, last = sheet.frames[span], sheet.frames[span + 1]
        known = (_contour(part, first, last, sheet, to_sheet) for part in parts if part.knows(first, last))
        sheet.captured[span] = [contour for contour in known if contour is not None]


def _is_free(sheet: Sheet, span: int) -> bool:
    """Whether any layer has no peg of its own; what hangs on a peg goes with that."""
    pegs = sheet.pegs_of(span)
    return not pegs or not all(pegs)


def _to_sheet(ob, sheet: Sheet, names: set[str]) -> dict[str, np.ndarray]:
    """By contour layer 4×4 to the space of a sheet; those that something else carries move against it, and have none."""
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
    """A part on the frames of a span; `None` where it lies in another space, or where a point is no place."""
    places = [part.frames[frame] for frame in range(first, last + 1)]
    if not all(name in to_sheet for name, _ in places):
        return None
    flat = np.stack([sheet.plane.laid(points, to_sheet[name])[0] for name, points in places])
    if not (np.abs(flat) <= FARTHEST).all():
        return None
    # Adding 0 makes the two zeros one.
    return Contour(part.closed, first, np.round(flat, DECIMALS) + 0.0)

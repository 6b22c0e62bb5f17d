"""Which regions are in doubt, and where: generated strokes whose colour is probably wrong.

Points keep the confidence of their region as `rototoon_confidence`, all points of a stroke the same.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from rototoon.fills import DOUBT

from ..blender import grease_pencil as gp
from ..lines import doubts as lines_doubts
from . import sheets


@dataclass(frozen=True, order=True)
class Place:
    """A region that is in doubt on a frame."""

    frame: int
    """Scene frame."""
    number: int
    """The region's number on the layer."""
    index: int
    """The index of its stroke in the drawing."""


def is_doubtful(confidence: float) -> bool:
    """Whether a colour is probably wrong."""
    return confidence < DOUBT


def of_sheet(sheet: sheets.Sheet) -> np.ndarray:
    """The indices of a drawing's strokes that are in doubt."""
    content = sheet.content
    sure = lines_doubts.of_strokes(content.point.get(gp.CONFIDENCE), content.starts)
    return np.flatnonzero(sheet.made & (sure < DOUBT))


def places(ob) -> list[Place]:
    """All regions of an object that are in doubt, by frame and number."""
    found = []
    for frame, sheet in sheets.read(ob, ob.rototoon.fills_layer).items():
        numbers = sheet.content.strokes(gp.TRACK)
        found += [Place(frame, int(numbers[i]), int(i)) for i in of_sheet(sheet)]
    return sorted(found)


def after(found: list[Place], frame: int, number: int) -> Place | None:
    """The place behind a region on a frame, or the first one behind the last. `None` if there is none."""
    later = (place for place in found if (place.frame, place.number) > (frame, number))
    return next(later, found[0] if found else None)

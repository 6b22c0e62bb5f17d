"""Which strokes of a drawing of contours are generated, and which are the artist's though Rototoon once wrote them.

What: a stroke that tracking wrote has a mark (`MADE`). Copies that the artist makes have it too, and so do drawings of which the artist has
changed the keyframe type. These are keys. Strokes that were copied from another object belong to none of this one's parts.

How: on a frame of the artist a stroke is generated if it was written there, beside the artist's strokes. It has a second mark then (`BESIDE`),
which no copy from a generated frame has. So the strokes that are left are generated also where the artist's own ones were deleted.

Limits: files of older versions lack the second mark until the next Track. There the strokes of a mixed frame with a mark are generated, and
none if all have it.
"""

from __future__ import annotations

import numpy as np

from ..blender import grease_pencil as gp


def of(handle, kind: str) -> np.ndarray:
    """Which strokes of a drawing are generated. `kind` is the keyframe type of its frame."""
    strokes = len(gp.offsets(handle)) - 1
    return by_marks(gp.value(handle, gp.MADE, strokes), gp.get(handle, gp.BESIDE, strokes), kind)


def by_marks(made: np.ndarray, beside: np.ndarray | None, kind: str) -> np.ndarray:
    """As `of`, by the two marks of the strokes. `beside` is `None` if the drawing has no such mark."""
    if kind == gp.GENERATED:
        return made
    if beside is not None:
        return made & beside
    return np.zeros_like(made) if made.all() else made


def foreign(owners: np.ndarray, stamp: int) -> np.ndarray:
    """Which strokes belong to parts of another object, from which they were copied. `stamp` is that of this object."""
    return (owners != 0) & (owners != stamp) & (stamp != 0)


def settle(handle, kind: str) -> None:
    """Marks what is generated on a drawing to which the add-on adds strokes of the artist. `kind` is the keyframe type until then."""
    made = of(handle, kind)
    if len(made) and gp.has(handle, gp.MADE):
        gp.put(handle, gp.MADE, made)
        gp.put(handle, gp.BESIDE, made)


def give_back(layer) -> None:
    """Gives the frames of the artist on which nothing of the artist is left the type of generated ones again."""
    drawings = {frame: (handle, kind) for frame, (handle, kind) in gp.drawings(layer).items() if kind != gp.GENERATED}
    types = {}
    for frame, (handle, kind) in drawings.items():
        made = of(handle, kind) if gp.has(handle, gp.BESIDE) else np.zeros(0, bool)
        if len(made) and made.all():
            types[frame] = gp.GENERATED
    gp.set_keyframe_type(layer, types)

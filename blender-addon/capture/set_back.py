"""Looks of tracked contours that Track has set back.

The look of a part belongs to its keys: Track gives it to all tracked contours, blended in time. So a look that the artist gave to a tracked
contour does not last, and Track says on which frames. For that it notes with each contour how it looked when it was tracked (`rototoon_look`).
A look was set back if it was neither the noted one nor the present one. So neither another look of the keys nor another numbering of materials
counts, and neither do contours that Live, a script or an older version has tracked anew meanwhile.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..blender import grease_pencil as gp
from ..blender import guard, marks
from ..blender import strokes as st
from ..common.wording import listed
from . import tracking

Place = tuple[str, int, int]
"""Layer, frame and number of a part."""


def changed(ob) -> dict[Place, int]:
    """The looks of tracked contours that are not those that were noted."""
    found = {}
    for name, frame, content in _drawings(ob, noted=True):
        looks, known, parts = _looks(content), content.strokes(gp.LOOK), content.strokes(gp.PART)
        made = content.strokes(gp.MADE) & (known != 0) & (looks != known)
        found |= {(name, frame, int(parts[i])): int(looks[i]) for i in np.flatnonzero(made)}
    return found


def note(ob, before: dict[Place, int]) -> str:
    """Notes the looks of all tracked contours. Returns what the artist is told of looks that were changed `before` and are set back now."""
    frames, wanted = set(), {}
    for name, frame, content in _drawings(ob, noted=False):
        looks, parts, made = _looks(content), content.strokes(gp.PART), content.strokes(gp.MADE)
        now = {(name, frame, int(parts[i])): int(looks[i]) for i in np.flatnonzero(made)}
        if any(before[place] != now[place] for place in before.keys() & now.keys()):
            frames.add(frame)
        new = np.where(made, looks, content.strokes(gp.LOOK))
        if not np.array_equal(new, content.strokes(gp.LOOK)):
            wanted[name, frame] = new
    for layer in guard.open_layers(tracking.contour_layers(ob), hidden=True):
        for frame, (handle, _) in gp.drawings(layer).items():
            if (layer.name, frame) in wanted:
                gp.put(handle, gp.LOOK, wanted[layer.name, frame])
    if not frames:
        return ""
    return f"tracked contours look like the keys again on {listed(sorted(frames))}: to change a part's look, change it on its keys"


def _looks(content: st.Content) -> np.ndarray:
    """The looks without fills as attributes, so that they are the same in every Blender: contours are lines."""
    return marks.numbered_looks(content, by_id=False)


def _drawings(ob, noted: bool) -> Iterator[tuple[str, int, st.Content]]:
    """The drawings with tracked contours; with `noted`, only those whose looks are noted."""
    with gp.copied(ob.data) as data:
        for layer in tracking.contour_layers(ob):
            for frame, (handle, _) in gp.drawings(gp.find_layer_of(data, layer.name)).items():
                if gp.has(handle, gp.MADE) and (not noted or gp.has(handle, gp.LOOK)):
                    yield layer.name, frame, st.read(handle)

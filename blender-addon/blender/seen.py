"""Drawings as long work has read them.

Work that follows one window leaves the artist free in a second one. What is drawn there meanwhile must not be written over by a result
that does not know of it. So whoever works notes what it reads, and asks before it writes.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable

import numpy as np

from . import grease_pencil as gp
from . import strokes as st
from .errors import Problem


class Seen:
    """What was read of an object."""

    def __init__(self, ob):
        self._ob = ob
        self._digests: dict[tuple[str, int], bytes] = {}

    def note(self, layer: str, frame: int, content: st.Content) -> None:
        """Notes the drawing of a layer on a frame, as it is now. What was noted first counts."""
        if (layer, frame) not in self._digests:
            self._digests[layer, frame] = _digest(content)

    def need(self, drawings: Iterable[tuple[str, int]]) -> None:
        """Raises a `Problem` if one of the noted drawings, by layer and frame, is another one now."""
        with gp.copied(self._ob.data) as data:
            for name, frame in dict.fromkeys(drawings):
                layer = gp.find_layer_of(data, name)
                handle = gp.drawings(layer).get(frame) if layer is not None else None
                if handle is None or _digest(st.read(handle[0])) != self._digests[name, frame]:
                    raise changed(name, frame)


def changed(layer: str, frame: int | None = None) -> Problem:
    """The error for a layer that was changed during the work."""
    where = f'The layer "{layer}"' if frame is None else f'The drawing on frame {frame} of the layer "{layer}"'
    return Problem(f"{where} was changed during the work, so the result was dropped: try again")


def _digest(content: st.Content) -> bytes:
    summed = hashlib.blake2b(digest_size=16)
    summed.update(content.sizes.tobytes() + content.types.tobytes())
    for side in (content.point, content.curve):
        for name in sorted(side):
            summed.update(name.encode())
            summed.update(np.ascontiguousarray(side[name]))
    return summed.digest()

"""All layers of lines as the drawings of one document, the lowest layer first.

What: a document knows no layers. Each of its drawings has the strokes of all layers that are to be seen, from back to front, as Blender shows
them on that frame.

How: a frame on which one layer has a drawing of its own gets a whole drawing. A layer that has nothing there gives what it shows: the drawing that is
held, or its in-between. A frame with a drawing of the artist on some layer is one of `drawings`, any other one is in `in_betweens`. Numbers of
strokes are those of the layers, each layer's behind those of the layers below it.

Why so: no program may take a drawing of the artist for a generated one and replace it.

Limits: where layers have keys on other frames, an in-between of one layer becomes a part of a drawing. Spacings that differ from layer to layer are
left out; the in-betweens are there. Read again, all strokes come to one layer.
"""

from __future__ import annotations

import itertools
from typing import Any

from ..blender import grease_pencil as gp
from ..blender import guard
from ..lines import drawings as dr
from .drawn_out import OfLayer, Written


def of(ob, pegs: set[str], size: tuple[int, int] | None) -> Written:
    """The drawings of all layers of lines that are to be seen. The arguments are those of `drawn_out.of`."""
    names = [layer.name for layer in dr.layers(ob) if not guard.is_hidden(layer) and gp.has_strokes(layer)]
    return _Stack([OfLayer(ob, name, pegs, size) for name in names], ob.rototoon.frame_offset).written() if names else Written()


class _Stack:
    def __init__(self, layers: list[OfLayer], offset: int):
        self._layers, self._offset = layers, offset
        self._frames = sorted({frame for layer in layers for frame in layer.frames})
        self._keys = sorted({frame for layer in layers for frame in layer.keys})
        # Numbers of a layer come behind those of the layers below it.
        self._first = [0, *itertools.accumulate(layer.highest for layer in layers)]

    def written(self) -> Written:
        between = [frame for frame in self._frames if frame not in set(self._keys)]
        fields = {
            "drawings": [self._drawing(k) for k in range(len(self._keys))],
            "pairs": self._pairs(),
            "in_betweens": [{"frame": frame - self._offset, "strokes": self._strokes(frame)} for frame in between],
            "matches": self._matches(),
        }
        lost = set().union(*(layer.lost for layer in self._layers))
        return Written({name: value for name, value in fields.items() if value}, len(self._keys), 0, len(between), lost)

    def _strokes(self, frame: int) -> list[dict[str, Any]]:
        """What all layers show on a frame, as strokes of in-betweens."""
        shown = zip(self._layers, self._first)
        return [{**stroke, "track": stroke["track"] + first} for layer, first in shown for stroke in layer.shown(frame)]

    def _drawing(self, k: int) -> dict[str, Any]:
        frame = self._keys[k]
        strokes = [{name: value for name, value in stroke.items() if name != "track"} for stroke in self._strokes(frame)]
        for stroke in strokes:
            if stroke["opacity"] >= 1:
                del stroke["opacity"]
        after = self._keys[k + 1] if k + 1 < len(self._keys) else None
        own = [layer.fields_of(frame) if layer.after(frame) == after else None for layer in self._layers if frame in layer.keys]
        same = own[0] if own and own[0] is not None and all(each == own[0] for each in own) else {}
        return {"frame": frame - self._offset, **same, "strokes": strokes}

    def _pairs(self) -> list[dict[str, Any]]:
        found = []
        for frame, after in itertools.pairwise(self._keys):
            counts = [[len(layer.shown(each)) for layer in self._layers] for each in (frame, after)]
            before = [[0, *itertools.accumulate(each)] for each in counts]
            for k, layer in enumerate(self._layers):
                if frame in layer.keys and layer.after(frame) == after:
                    for pair in layer.pairs_of(frame):
                        to = None if pair["to"] is None else pair["to"] + before[1][k]
                        found.append({"frame": frame - self._offset, "from": pair["from"] + before[0][k], "to": to})
        return found

    def _matches(self) -> list[dict[str, Any]]:
        tracks = {frame: [stroke["track"] for stroke in self._strokes(frame)] for frame in self._keys}
        return [
            {"frame": frame - self._offset, "next": after - self._offset, "tracks": [tracks[frame], tracks[after]]}
            for frame, after in itertools.pairwise(self._keys)
        ]

"""All layers of lines as the drawings of one document, the lowest layer first.

What: a document knows no layers. Each of its drawings has the strokes of all layers that are to be seen, from back to front, as Blender shows
them on that frame.

How: a frame on which one layer has a drawing of its own gets a whole drawing. A layer that has nothing there gives what it shows: the drawing that is
held, or its in-between. A frame with a drawing of the artist on some layer is one of `drawings`. Any other one is in `traced` if a layer shows a traced
drawing there, else in `in_betweens`. Once there are traced frames, `traced` has those of `drawings` too, so a stroke has the same number on all of
them. Numbers of strokes are those of the layers, each layer's behind those of the layers below it. A single layer is written as it is by itself.

Why so: no program may take a drawing of the artist for a generated one and replace it. What reads a document again takes in-betweens only between two
drawings of the artist, and traced ones everywhere.

Limits: where layers have keys on other frames, an in-between of one layer becomes a part of a drawing. Spacings that differ from layer to layer are
left out; the in-betweens are there. A traced stroke cannot fade. So a frame with a traced drawing of one layer and an in-between of another one is in
`in_betweens`, if it lies between two drawings. Read again, all strokes come to one layer.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable
from typing import Any

from ..blender import grease_pencil as gp
from ..blender import guard
from ..lines import drawings as dr
from .drawn_out import OfLayer, Written

Shown = Callable[[OfLayer, int], list[dict[str, Any]]]
"""Gives the strokes that a layer shows on a frame."""


def of(ob, pegs: set[str], size: tuple[int, int] | None) -> Written:
    """The drawings of all layers of lines that are to be seen. The arguments are those of `drawn_out.of`."""
    names = [layer.name for layer in dr.layers(ob) if not guard.is_hidden(layer) and gp.has_strokes(layer)]
    if not names:
        return Written()
    layers = [OfLayer(ob, name, pegs, size) for name in names]
    return layers[0].written() if len(layers) == 1 else _Stack(layers, ob.rototoon.frame_offset).written()


class _Stack:
    def __init__(self, layers: list[OfLayer], offset: int):
        self._layers, self._offset = layers, offset
        self._keys = sorted({frame for layer in layers for frame in layer.keys})
        traced = {frame for layer in layers for frame in layer.traced}
        drawn = {frame for layer in layers for frame in layer.frames} - set(self._keys)
        inside = {frame for frame in drawn if self._keys and self._keys[0] < frame < self._keys[-1]}
        self._between = {frame for layer in layers for frame in layer.between if frame in inside} | (drawn - traced)
        self._traced = traced - self._between
        if self._traced:
            self._traced |= set(self._keys)
        # Numbers of a layer come behind those of the layers below it.
        self._first = [0, *itertools.accumulate(layer.highest for layer in layers)]

    def written(self) -> Written:
        fields = {
            "drawings": [self._drawing(k) for k in range(len(self._keys))],
            "pairs": self._pairs(),
            "traced": self._drawings(self._traced, OfLayer.shown_as_traced),
            "in_betweens": self._drawings(self._between, OfLayer.shown),
            "matches": self._matches(),
        }
        found = Written({name: value for name, value in fields.items() if value}, len(self._keys))
        found.traced, found.between = len(self._traced - set(self._keys)), len(self._between)
        for layer in self._layers:
            found.lost |= layer.lost
            for there, own, others in ((found.as_between, layer.traced, self._between), (found.as_traced, layer.between, self._traced - set(self._keys))):
                if own & others:
                    there[layer.name] = own & others
        return found

    def _drawings(self, frames: Iterable[int], shown: Shown) -> list[dict[str, Any]]:
        return [{"frame": frame - self._offset, "strokes": self._strokes(frame, shown)} for frame in sorted(frames)]

    def _strokes(self, frame: int, shown: Shown = OfLayer.shown) -> list[dict[str, Any]]:
        """What all layers show on a frame. `shown` gives one layer's strokes."""
        layers = zip(self._layers, self._first)
        return [{**stroke, "track": stroke["track"] + first} for layer, first in layers for stroke in shown(layer, frame)]

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
            if not {frame, after} <= self._traced
        ]

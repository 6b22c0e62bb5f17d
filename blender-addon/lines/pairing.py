"""The same strokes of two neighbouring drawings, and clicks that change which are the same.

Two strokes are the same if they have the same number. A click on two strokes makes them the same from the later drawing on: the two
numbers change places on that drawing and on all drawings after it. So nothing gets lost, and no number occurs twice on a drawing. The
later drawing is the artist's then, so that the decision holds when the lines are carried again.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from rototoon import tween

from ..blender import camera as cameras
from ..blender import grease_pencil as gp
from ..blender import guard, stroke_lines
from ..blender import strokes as st
from ..common.wording import counted
from ..tween import keys as ks
from ..tween import pairing
from . import moved, records


@dataclass
class _Layer:
    name: str
    frames: tuple[int, int]
    world: tuple[list[np.ndarray], list[np.ndarray]]
    """For both drawings the line of each stroke."""
    numbers: tuple[list[int], list[int]]
    """For both drawings the number of each stroke, as stored."""
    next_track: int
    swaps: list[tuple[int, int]] = field(default_factory=list)
    """Numbers that change places on the later drawing and after it, one pair after the other."""

    def later(self) -> list[int]:
        """The numbers of the later drawing's strokes after all swaps."""
        return [swapped(number, self.swaps) for number in self.numbers[1]]


def swapped(number: int, swaps: list[tuple[int, int]]) -> int:
    """A number after all swaps."""
    for one, other in swaps:
        number = other if number == one else one if number == other else number
    return number


class LinePairing(pairing.Pairing):
    """The drawings around a frame on some layers: the one at the frame, and the next one."""

    def __init__(self, ob, layers, frame: int):
        self._ob = ob
        self._layers: list[_Layer] = []
        for layer in layers:
            found = [n for n, (handle, _) in gp.drawings(layer).items() if len(gp.offsets(handle)) > 1]
            span = ks.around(found, frame)
            if span is not None:
                self._layers.append(self._read(layer, span))
        self.pairs: list[pairing.Pair] = []
        self.picked: pairing.Item | None = None
        self._order: list[int] = []

    def _read(self, layer, span: tuple[int, int]) -> _Layer:
        drawings, highest = gp.drawings(layer), 0
        for handle, _ in drawings.values():
            highest = max(highest, int(gp.value(handle, gp.TRACK, len(gp.offsets(handle)) - 1).max(initial=0)))
        contents = [st.read(drawings[frame][0]) for frame in span]
        matrix = cameras.layer_to_world(self._ob, layer)
        world = tuple([line @ matrix[:3, :3].T + matrix[:3, 3] for line in stroke_lines.lines(c)] for c in contents)
        return _Layer(layer.name, span, world, tuple(c.strokes(gp.TRACK).tolist() for c in contents), highest + 1)

    def match(self, progress=None) -> None:
        """Nothing has to be found: the numbers say it."""

    def take(self, found=None) -> None:
        """Reads the pairs from the numbers."""
        self.pairs = []
        for place, layer in enumerate(self._layers):
            earlier, later = layer.numbers[0], layer.later()
            fixed = {number for swap in layer.swaps for number in swap}
            where = {number: j for j, number in reversed(list(enumerate(later))) if number}
            left = set(range(len(later)))
            for i, number in enumerate(earlier):
                j = where.get(number, -1) if number else -1
                j = j if j in left else -1
                left.discard(j)
                kind = tween.PAIR if j >= 0 else tween.VANISHED
                self.pairs.append(pairing.Pair(place, kind, i, j, number in fixed, 1.0))
            self.pairs += [pairing.Pair(place, tween.APPEARED, -1, j, later[j] in fixed, 1.0) for j in sorted(left)]

    def pair(self, earlier: int, later: int) -> bool:
        """Makes two strokes the same by their numbers, on the first layer that has both. Returns whether there is one."""
        for place, layer in enumerate(self._layers):
            if earlier in layer.numbers[0] and later in layer.later():
                return self._swap(place, earlier, later)
        return False

    def _swap(self, place: int, one: int, other: int) -> bool:
        if one == other or not one or not other:
            return False
        self._layers[place].swaps.append((one, other))
        self._order.append(place)
        return True

    def click(self, item: pairing.Item | None) -> bool:
        """Picks a stroke, or makes it the same as the picked one. Returns whether the pairs have changed."""
        first, self.picked = self.picked, None
        if item is None or item == first:
            return False
        if first is None or first.side == item.side or first.layer != item.layer:
            self.picked = item
            return False
        earlier, later = sorted((first, item), key=lambda each: each.side)
        layer = self._layers[item.layer]
        return self._swap(item.layer, layer.numbers[0][earlier.index], layer.later()[later.index])

    def free(self, item: pairing.Item | None) -> bool:
        """Gives the stroke of the later drawing a number of its own, from there on. Returns whether the pairs have changed."""
        self.picked = None
        row = self.row_of(item) if item is not None else None
        if row is None or row.later < 0 or row.earlier < 0:
            return False
        layer = self._layers[row.layer]
        number, layer.next_track = layer.next_track, layer.next_track + 1
        return self._swap(row.layer, layer.later()[row.later], number)

    def undo(self) -> bool:
        """Takes back the last decision. Returns whether there was one."""
        if not self._order:
            return False
        self._layers[self._order.pop()].swaps.pop()
        return True

    @property
    def changed(self) -> bool:
        """Whether the artist has decided anything."""
        return bool(self._order)

    def store(self) -> None:
        """Writes the numbers of the later drawings and of all drawings after them."""
        guard.need_open(gp.find_layer(self._ob, layer.name) for layer in self._layers if layer.swaps)
        kept = moved.read(self._ob, [layer.name for layer in self._layers if layer.swaps])
        for layer in self._layers:
            if layer.swaps:
                self._store(layer, kept.get(layer.name, records.Layer()))
        records.write(self._ob.data, kept)
        self._ob.data.update_tag()

    def _store(self, layer: _Layer, record: records.Layer) -> None:
        target = gp.find_layer(self._ob, layer.name)
        # A drawing that several frames share would change with each of them, and before the later drawing too.
        gp.make_own(target, [frame for frame in gp.frame_numbers(target) if frame >= layer.frames[1]])
        for frame, (handle, _) in gp.drawings(target).items():
            starts = gp.offsets(handle)
            if frame < layer.frames[1] or len(starts) < 2:
                continue
            before = gp.value(handle, gp.TRACK, len(starts) - 1)
            points, sizes = gp.positions(handle, int(starts[-1])), np.diff(starts)
            was_traced = record.sums.get(frame) == records.checksum(points, before, sizes)
            after = np.array([swapped(number, layer.swaps) for number in before.tolist()], np.int32)
            gp.put(handle, gp.TRACK, after)
            if gp.has(handle, gp.LINE):
                of_points = gp.value(handle, gp.LINE, len(points))
                gp.put(handle, gp.LINE, np.array([swapped(number, layer.swaps) for number in of_points.tolist()], np.int32))
            if was_traced and frame != layer.frames[1]:
                record.sums[frame] = records.checksum(points, after, sizes)
            if frame in record.numbers:
                record.numbers[frame] = [swapped(number, layer.swaps) for number in record.numbers[frame]]

    def keys(self) -> str:
        """The two drawings in words."""
        spans = sorted({layer.frames for layer in self._layers})
        return "Frames " + ", ".join(f"{first} and {last}" for first, last in spans)

    def doubts(self) -> str:
        """Nothing: the numbers say which strokes are the same. See `doubts` for those that tracing doubts."""
        return ""

    def summary(self) -> str:
        """The pairs in words."""
        same = sum(row.kind == tween.PAIR for row in self.pairs)
        said = [f"{counted(same, 'stroke')} {'is' if same == 1 else 'are'} the same"]
        ended = sum(row.kind == tween.VANISHED for row in self.pairs)
        begun = sum(row.kind == tween.APPEARED for row in self.pairs)
        said += [f"{ended} end"] if ended else []
        said += [f"{begun} begin"] if begun else []
        return ", ".join(said)

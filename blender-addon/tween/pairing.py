"""Match Strokes without its overlay: the strokes of two keys on each layer, their pairs, clicks, and the marks to show.

The library finds the pairs. The artist's decisions are stored in the strokes at once (see `pairs`). `undo` takes back the last one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from rototoon import tween

from ..blender import camera as cameras
from ..blender import grease_pencil as gp
from ..blender import guard, stroke_lines
from ..blender import strokes as st
from ..blender.seen import Seen
from ..common.wording import counted, listed
from . import keys as ks
from . import breakdowns, doubted, pairs, records, sheets, tweening
from .charts import Choices

REACH = 14.0
"""Largest distance of a click from a stroke, in pixels of the screen."""
ALONE = (0.6, 0.6, 0.6)
PICKED = (1.0, 1.0, 1.0)
COLOURS = (
    (0.90, 0.90, 0.00),
    (0.72, 0.30, 1.00),
    (1.00, 0.25, 0.20),
    (0.00, 0.80, 1.00),
    (0.10, 0.95, 0.10),
    (1.00, 0.20, 0.85),
    (1.00, 0.60, 0.20),
    (0.38, 0.53, 1.00),
    (0.40, 1.00, 0.75),
    (0.85, 0.40, 0.60),
    (0.55, 0.75, 0.15),
    (0.85, 0.65, 1.00),
)
"""Colours of pairs. They differ as much as possible from each other, from white and from greys: the least distance in OKLab is as
large as possible. Each differs much from the four before it."""


@dataclass(frozen=True)
class Item:
    """A stroke of one of the two keys of a layer."""

    layer: int
    side: int
    """0 for the earlier key, 1 for the later one."""
    index: int


@dataclass
class Pair:
    """A row of the matches. Strokes are indices; -1 for none."""

    layer: int
    kind: int
    earlier: int
    later: int
    by_hand: bool
    confidence: float
    doubtful: bool = False
    """Whether In-between would not carry the pair out."""


@dataclass
class Mark:
    """A stroke to show."""

    points: np.ndarray
    """Points (N, 3) of its line in the world."""
    colour: tuple[float, float, float]
    side: int
    label: str
    by_hand: bool


@dataclass
class _Layer:
    name: str
    frames: tuple[int, int]
    handles: tuple
    call: tweening.Call
    world: tuple[list[np.ndarray], list[np.ndarray]]
    """For both keys the line of each stroke."""


class Pairing:
    """The keys around a frame on some layers."""

    def __init__(self, ob, layers, frame: int):
        self._ob = ob
        self._layers: list[_Layer] = []
        kept = records.read(ob.data)
        for layer in layers:
            record = kept.get(layer.name, records.Layer())
            found = ks.frames_of(layer, record)
            # In-betweens that the artist changed are keys here too.
            breakdowns.write(layer, breakdowns.passed_on(layer, found.keys, found.edited))
            span = ks.around([key for key in found.keys if key not in found.blank], frame)
            if span is not None:
                self._layers.append(self._laid(layer, span))
        self.pairs: list[Pair] = []
        self.picked: Item | None = None
        self._undo: list[tuple[int, tuple[np.ndarray, np.ndarray]]] = []

    def _laid(self, layer, span: tuple[int, int]) -> _Layer:
        drawings = gp.drawings(layer)
        contents = [st.read(drawings[frame][0]) for frame in span]
        matrix = cameras.layer_to_world(self._ob, layer)
        world = tuple([line @ matrix[:3, :3].T + matrix[:3, 3] for line in stroke_lines.lines(c)] for c in contents)
        plane = sheets.Plane.of((content.point["position"] for content in contents), [np.eye(4)])
        sheet = sheets.Sheet([layer.name], list(span), plane, {0: Choices("LINEAR")}, [Choices("LINEAR")])
        sheet.contents = {0: contents[:1], 1: contents[1:]}
        call = tweening.Call(sheet, sheets.lay_out(self._ob, sheet), [0])
        return _Layer(layer.name, span, tuple(drawings[frame][0] for frame in span), call, world)

    def __len__(self) -> int:
        return len(self._layers)

    @property
    def spans(self) -> list[tuple[str, int, int]]:
        """The matched keys of each layer: (layer, earlier frame, later frame)."""
        return [(layer.name, *layer.frames) for layer in self._layers]

    def match(self, progress: tween.Progress | None = None) -> list[doubted.Found]:
        """Matches the strokes. It does not use Blender, so it may run in a thread."""
        return [doubted.match(layer.call.laid.drawings, progress) for layer in self._layers]

    def take(self, found: list[doubted.Found]) -> None:
        """Takes over the result of `match`."""
        self.pairs = []
        for number, (layer, each) in enumerate(zip(self._layers, found)):
            matches = layer.call.matches = each.matches
            split = len(layer.world[0])
            marks = pairs.Hand(*layer.handles).decided()
            for (kind, earlier, later, _), (_, sure) in zip(matches.rows.tolist(), matches.values.tolist()):
                doubtful = each.held or earlier in each.strokes or later in each.strokes
                later = later - split if later >= 0 else -1
                by_hand = _is_by_hand(marks, earlier, later)
                self.pairs.append(Pair(number, kind, earlier, later, by_hand, sure, kind == tween.PAIR and doubtful and not by_hand))

    def store(self) -> None:
        """Stores the numbers of the strokes of all keys."""
        guard.need_open(gp.find_layer(self._ob, layer.name) for layer in self._layers)
        plan = tweening.Plan(Seen(self._ob), records=records.read(self._ob.data))
        for layer in self._layers:
            record = plan.records.setdefault(layer.name, records.Layer())
            plan.frames[layer.name] = ks.frames_of(gp.find_layer(self._ob, layer.name), record)
            found: dict = {}
            tweening.collect_pairs(layer.call, found)
            tweening.number_keys(self._ob, layer.name, plan, found[layer.name])
        records.write(self._ob.data, plan.records)
        self._ob.data.update_tag()

    # -- by hand -----------------------------------------------------------------------------------------------------

    def row_of(self, item: Item) -> Pair | None:
        """The row of a stroke; the first row of a stroke in pieces."""
        for row in self.pairs:
            if row.layer == item.layer and item.index == (row.later if item.side else row.earlier):
                return row
        return None

    def click(self, item: Item | None) -> bool:
        """Picks a stroke, or pairs it with the picked one. Returns whether the strokes must be matched again."""
        first, self.picked = self.picked, None
        if item is None or item == first:
            return False
        if first is None or first.side == item.side or first.layer != item.layer:
            self.picked = item
            return False
        earlier, later = sorted((first, item), key=lambda each: each.side)
        with self._change(item.layer) as hand:
            hand.pair(earlier.index, later.index, self._free_number(item.layer))
        return True

    def decide(self, earlier: int, later: int) -> bool:
        """Pairs two strokes by their numbers, on the first layer that has both; -1 says that the other one has no counterpart. Returns whether there
        is such a layer."""
        for number, layer in enumerate(self._layers):
            tracks = [gp.value(handle, gp.TRACK, len(gp.offsets(handle)) - 1).tolist() for handle in layer.handles]
            places = [-1 if wanted == pairs.NONE else own.index(wanted) if wanted in own else None for wanted, own in zip((earlier, later), tracks)]
            if None in places:
                continue
            with self._change(number) as hand:
                if pairs.NONE in places:
                    side = places.index(pairs.NONE)
                    hand.alone(1 - side, places[1 - side], self._free_number(number))
                else:
                    hand.pair(*places, self._free_number(number))
            return True
        return False

    def free(self, item: Item | None) -> bool:
        """Takes back the decision on a stroke. Without a decision, the stroke gets no counterpart. Returns as `click`."""
        self.picked = None
        if item is None:
            return False
        row = self.row_of(item)
        with self._change(item.layer) as hand:
            if row is not None and row.by_hand:
                hand.release(item.side, item.index)
            else:
                hand.alone(item.side, item.index, self._free_number(item.layer))
        return True

    def undo(self) -> bool:
        """Takes back the last decision. Returns whether there was one."""
        if not self._undo:
            return False
        number, values = self._undo.pop()
        pairs.Hand(*self._layers[number].handles).restore(values)
        self._reread(number)
        return True

    @property
    def changed(self) -> bool:
        """Whether the artist has decided anything."""
        return bool(self._undo)

    def _free_number(self, number: int) -> int:
        return pairs.free_number(gp.find_layer(self._ob, self._layers[number].name))

    def _change(self, number: int):
        return _Change(self, number)

    def _reread(self, number: int) -> None:
        """Reads the decisions again for the next `match`."""
        layer = self._layers[number]
        for contents, handle, name in zip(layer.call.sheet.contents.values(), layer.handles, (gp.NEXT, gp.BEFORE)):
            for each in (name, gp.KEY):
                contents[0].set_strokes(each, gp.value(handle, each, len(contents[0].sizes)))
        layer.call.laid = sheets.lay_out(self._ob, layer.call.sheet)

    # -- on the screen -----------------------------------------------------------------------------------------------

    def pick(self, place: tuple[float, float], matrix: np.ndarray, size: tuple[float, float]) -> Item | None:
        """The stroke at a place of a view, in pixels from its lower left corner. `matrix` (4×4) is the view's perspective matrix.

        When a stroke is picked, strokes of the other key are preferred.
        """
        best: dict[int, tuple[float, Item]] = {}
        for number, layer in enumerate(self._layers):
            for side in (0, 1):
                for index, points in enumerate(layer.world[side]):
                    away = _distance(np.asarray(place, float), on_screen(points, matrix, size))
                    if away <= REACH and (side not in best or away < best[side][0]):
                        best[side] = away, Item(number, side, index)
        if not best:
            return None
        wanted = 1 - self.picked.side if self.picked is not None else None
        if wanted in best:
            return best[wanted][1]
        return min(best.values(), key=lambda each: each[0])[1]

    def marks(self) -> list[Mark]:
        """The marks to show: every stroke once. The strokes of a pair have the same colour and number.

        The number is that of the earlier key's stroke, so decisions on other strokes do not change it.
        """
        marks: list[Mark] = []
        seen: set[Item] = set()
        whole: dict[Item, int] = {}
        before = np.cumsum([0] + [len(layer.world[0]) for layer in self._layers])
        for row in self.pairs:
            items = [Item(row.layer, side, i) for side, i in enumerate((row.earlier, row.later)) if i >= 0]
            if row.kind in (tween.VANISHED, tween.APPEARED):
                label, colour = "–", ALONE
            else:
                # All pieces of a stroke have the stroke's number.
                own = int(before[row.layer]) + row.earlier + 1
                doubt = "?" if row.doubtful else ""
                number = next((whole[each] for each in items if each in whole), own)
                whole.update(dict.fromkeys(items, number))
                label, colour = f"{number}{doubt}", colour_of(number)
            for item in items:
                if item in seen:
                    continue
                seen.add(item)
                points = self._layers[item.layer].world[item.side][item.index]
                shown = PICKED if item == self.picked else colour
                marks.append(Mark(points, shown, item.side, label, row.by_hand))
        return marks

    def keys(self) -> str:
        """The matched keys in words."""
        spans = sorted({layer.frames for layer in self._layers})
        return "Frames " + ", ".join(f"{first} to {last}" for first, last in spans)

    def summary(self) -> str:
        """The pairs in words."""
        paired = sum(row.kind == tween.PAIR for row in self.pairs)
        hand = sum(row.by_hand for row in self.pairs)
        pieces = sum(row.kind in (tween.SPLIT, tween.JOINED, tween.CHAINED) for row in self.pairs)
        alone = sum(row.kind in (tween.VANISHED, tween.APPEARED) for row in self.pairs)
        said = counted(paired, "pair")
        if hand:
            said += f", {hand} decided by hand"
        if pieces:
            said += f", {counted(pieces, 'piece')}"
        return said + (f", {alone} without counterpart" if alone else "")

    def doubts(self) -> str:
        """What In-between would not carry out, in words; empty if it is sure of all pairs. Strokes have the numbers that `marks` shows."""
        before = np.cumsum([0] + [len(layer.world[0]) for layer in self._layers])
        said = []
        for span in sorted({layer.frames for layer in self._layers}):
            rows = [row for row in self.pairs if row.kind == tween.PAIR and self._layers[row.layer].frames == span]
            numbers = [int(before[row.layer]) + row.earlier + 1 for row in rows if row.doubtful]
            if numbers:
                which = "number" if len(numbers) == 1 else "numbers"
                said.append(f"frames {span[0]} to {span[1]}: {len(numbers)} of {counted(len(rows), 'pair')}, {which} {listed(numbers)}")
        return f"doubtful, so that In-between does not carry them out: {'; '.join(said)}; pair them by hand, or draw a breakdown" if said else ""


def _is_by_hand(marks: tuple[np.ndarray, np.ndarray], earlier: int, later: int) -> bool:
    """Whether the artist made a pair, or freed a stroke. Pairs of carried strokes are given to the library, too, and are not the artist's."""
    to, of = marks
    if earlier >= 0 and later >= 0:
        return bool(to[earlier] > 0 and to[earlier] == of[later])
    return bool((earlier >= 0 and to[earlier] == pairs.NONE) or (later >= 0 and of[later] == pairs.NONE))


class _Change:
    """A decision. It remembers the state before, for `undo`."""

    def __init__(self, pairing: Pairing, number: int):
        self._pairing, self._number = pairing, number
        self._hand = pairs.Hand(*pairing._layers[number].handles)
        self._before = self._hand.values()

    def __enter__(self) -> pairs.Hand:
        return self._hand

    def __exit__(self, *_error) -> None:
        self._pairing._undo.append((self._number, self._before))
        self._pairing._reread(self._number)


def colour_of(number: int) -> tuple[float, float, float]:
    """The colour of a pair. Colours of neighbouring numbers differ much."""
    return COLOURS[(number - 1) % len(COLOURS)]


def on_screen(points: np.ndarray, matrix: np.ndarray, size: tuple[float, float]) -> np.ndarray:
    """Pixels (N, 2) of points in a view. Points behind the view get pixels far away."""
    clip = np.c_[points, np.ones(len(points))] @ np.asarray(matrix, float).T
    ahead = clip[:, 3] > 1e-9
    unit = clip[:, :2] / np.where(ahead, clip[:, 3], 1.0)[:, None]
    return np.where(ahead[:, None], (unit + 1) * 0.5 * np.asarray(size, float), 1e9)


def _distance(place: np.ndarray, line: np.ndarray) -> float:
    if not len(line):
        return np.inf
    a, b = line, np.vstack([line[1:], line[-1:]])
    way = b - a
    along = ((place - a) * way).sum(1) / np.maximum((way * way).sum(1), 1e-12)
    foot = a + np.clip(along, 0, 1)[:, None] * way
    found = np.linalg.norm(foot - place, axis=1)
    return float(np.nan_to_num(found, nan=np.inf).min())

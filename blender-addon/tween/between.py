"""In-betweens as strokes: the library's points, with all attributes of the keys' strokes, on generated frames.

All drawings of a span have the same strokes. The first drawing is a copy of the earlier key; if strokes appear, vanish or split, it
gets a new layout. The other drawings are copies of the first, which costs nothing in Blender as long as they are equal. Then each
drawing gets its points and the attributes that differ. Values that cannot be blended stay those of the earlier key.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from rototoon import tween

from ..blender import grease_pencil as gp
from ..blender import marks
from ..blender import strokes as st
from . import breakdowns, doubted, records
from . import keys as ks
from .sheets import Laid, Sheet

_HANDLES = ("handle_left", "handle_right")
_NEVER = ks.OURS | {"position"}


@dataclass
class Block:
    """The in-betweens of one span on one layer."""

    layer: str
    first: int
    last: int
    frames: list[int]
    content: st.Content
    """The strokes of all frames."""
    alike: bool
    """Whether their layout is that of the earlier key."""
    stands: np.ndarray
    """(S, 2): the stroke of the earlier and of the later key, -1 for none."""
    parts: np.ndarray
    """(S,): whether a stroke is only a part of the earlier key's stroke."""
    shares: np.ndarray
    positions: np.ndarray
    """(F, N, 3)."""
    held: bool = False
    """Whether all frames show the earlier key."""
    exchanged: tuple[int, int] = (0, 0)
    """Number of strokes of the earlier and of the later key that are exchanged half way."""
    ends: dict[str, tuple[np.ndarray, np.ndarray]] = field(default_factory=dict)
    """By attribute: first and last values, which are blended over the frames."""
    changing: dict[str, np.ndarray] = field(default_factory=dict)
    """By attribute: values (F, ...) that differ from frame to frame in another way."""


class _Side:
    """A span's strokes with the values of one of its keys."""

    def __init__(self, sheet: Sheet, laid: Laid, span: int, side: int, layer: int, strokes, sizes, indices, weights):
        self.own = sheet.contents[span + side][layer]
        self.other = sheet.contents[span + 1 - side][layer]
        first = laid.first_stroke
        mine, theirs = strokes[:, side], strokes[:, 1 - side]
        self.there = mine >= 0
        self.stroke = np.where(self.there, mine - first[span + side, layer], theirs - first[span + 1 - side, layer])
        self.points = np.repeat(self.there, sizes)
        self.all = indices[:, 2 * side : 2 * side + 2]
        self.rows = laid.rows[self.all]
        self.weights = weights[:, side]

    def of_points(self, name: str) -> np.ndarray:
        """An attribute of the points."""
        return self._either(name, "point", self.points, self._blend)

    def of_strokes(self, name: str) -> np.ndarray:
        """An attribute of the strokes."""
        return self._either(name, "curve", self.there, lambda values, which: values[self.stroke[which]])

    def _either(self, name: str, domain: str, there: np.ndarray, take) -> np.ndarray:
        own, other = (_values(each, domain, name, like) for each, like in self._both())
        if there.all():
            return take(own, slice(None))
        result = np.empty((len(there), *own.shape[1:]), own.dtype)
        result[there], result[~there] = take(own, there), take(other, ~there)
        return result

    def _both(self):
        return (self.own, self.other), (self.other, self.own)

    def _blend(self, values: np.ndarray, which) -> np.ndarray:
        rows, weights = self.rows[which], self.weights[which]
        if values.dtype.kind != "f":
            return values[np.where(weights < 0.5, rows[:, 0], rows[:, 1])]
        first = values[rows[:, 0]]
        if not weights.any():
            return first
        weights = weights.astype(values.dtype).reshape(-1, *(1,) * (values.ndim - 1))
        return first + (values[rows[:, 1]] - first) * weights

    def flat(self, values: np.ndarray) -> np.ndarray:
        """Values at the strokes' points, from values of all points of the sheet."""
        weights = self.weights.reshape(-1, *(1,) * (values.ndim - 1))
        return values[self.all[:, 0]] * (1 - weights) + values[self.all[:, 1]] * weights


def _values(content: st.Content, domain: str, name: str, like: st.Content) -> np.ndarray:
    """An attribute, or its default values if it is missing."""
    found = getattr(content, domain).get(name)
    if found is not None:
        return found
    count = len(content.sizes) if domain == "curve" else len(content.point["position"])
    shape = getattr(like, domain)[name] if name in getattr(like, domain) else gp.blank(name, 0)
    return np.full((count, *shape.shape[1:]), gp.DEFAULTS.get(name, 0), shape.dtype)


def blocks(sheet: Sheet, laid: Laid, spans: list[int], drawn: tween.InBetweens) -> list[Block]:
    """The blocks to write for the spans of a sheet."""
    frames, offsets = np.asarray(drawn.frame_offsets), np.asarray(drawn.stroke_offsets)
    bounds, strokes = np.asarray(drawn.point_offsets), np.asarray(drawn.strokes).reshape(-1, 3)
    indices, weights = np.asarray(drawn.indices).reshape(-1, 4), np.asarray(drawn.weights).reshape(-1, 2)
    places, opacities = np.asarray(drawn.points).reshape(-1, 2), np.asarray(drawn.opacities)
    shares = np.asarray(drawn.shares)
    result, at, seen = [], 0, 0
    for number, span in enumerate(spans):
        count = frames[number + 1] - frames[number]
        mine = slice(offsets[number], offsets[number + 1])
        own = slice(bounds[mine.start], bounds[mine.stop])
        size, width = own.stop - own.start, mine.stop - mine.start
        points = places[at : at + count * size].reshape(count, size, 2)
        opaque = opacities[seen : seen + count * width].reshape(count, width)
        at, seen = at + count * size, seen + count * width
        if not count or not size:
            continue
        sizes = np.diff(bounds[mine.start : mine.stop + 1])
        span_of = _Span(sheet, laid, span, strokes[mine], sizes, indices[own], weights[own], points, opaque)
        share = shares[frames[number] : frames[number + 1]]
        mine = [block for layer in range(len(sheet.layers)) if (block := span_of.block(layer, share)) is not None]
        for block in mine:
            block.held = bool(drawn.held[number])
        result += mine
    return result


class _Span:
    """The arrays of one span."""

    def __init__(self, sheet, laid, span, strokes, sizes, indices, weights, points, opacities):
        self.sheet, self.laid, self.span = sheet, laid, span
        self.strokes, self.sizes, self.indices, self.weights = strokes, sizes, indices, weights
        self.points, self.opacities = points, opacities

    def _of_layer(self, layer: int) -> np.ndarray:
        """Which strokes are on a layer and have points."""
        mask = np.zeros(len(self.strokes), bool)
        for side in (0, 1):
            first = self.laid.first_stroke[self.span + side, layer]
            count = len(self.sheet.contents[self.span + side][layer].sizes)
            mask |= (self.strokes[:, side] >= first) & (self.strokes[:, side] < first + count)
        return mask & (self.sizes > 0)

    def block(self, layer: int, shares: np.ndarray) -> Block | None:
        """The block of a layer."""
        sheet = self.sheet
        mask = self._of_layer(layer)
        if not mask.any():
            return None
        some = slice(None) if mask.all() else np.repeat(mask, self.sizes)
        strokes, sizes = self.strokes[mask], self.sizes[mask]
        sides = [
            _Side(sheet, self.laid, self.span, s, layer, strokes, sizes, self.indices[some], self.weights[some])
            for s in (0, 1)
        ]
        pixels = self.points[:, some]
        stands = np.stack([np.where(side.there, side.stroke, -1) for side in sides], 1)
        parts = (strokes[:, 2] & tween.PART_BEFORE) != 0
        whole = sheet.contents[self.span][layer]
        alike = (
            len(strokes) == len(whole.sizes)
            and not parts.any()
            and np.array_equal(stands[:, 0], np.arange(len(strokes)))
            and np.array_equal(sizes, whole.sizes)
        )
        away = np.zeros(1)
        if self.laid.away.any():
            ends = [side.flat(self.laid.away) for side in sides]
            away = ends[0] + (ends[1] - ends[0]) * shares[:, None]
        first, last = sheet.frames[self.span], sheet.frames[self.span + 1]
        frames = sheet.wanted[self.span].frames(first, last)
        content = st.Content(sizes.astype(np.int32), _types(sides))
        positions = sheet.plane.back(pixels, away, layer)
        block = Block(
            sheet.layers[layer], first, last, frames, content, alike, stands, parts, shares, positions
        )
        block.exchanged = _exchanged(stands, self.opacities[:, mask])
        _carry(block, sides, (strokes[:, 2] & tween.CLOSED) != 0)
        _fade(block, self.opacities[:, mask], sides)
        if (content.types == st.BEZIER).any():
            _turn_handles(block, sides, sheet, self.laid, layer, pixels)
        return block


def _types(sides) -> np.ndarray:
    before, after = sides
    own = np.where(before.there, before.stroke, 0)
    later = np.where(before.there, 0, before.stroke)
    pick = lambda content, index: content.types[index] if len(content.types) else np.zeros(len(index), np.int8)  # noqa: E731
    return np.where(before.there, pick(before.own, own), pick(before.other, later)).astype(np.int8)


def _carry(block: Block, sides, closed: np.ndarray) -> None:
    """The attributes of the strokes and their points."""
    before, after = sides
    content = block.content
    content.kinds = after.own.kinds | before.own.kinds
    for domain, into in (("point", content.point), ("curve", content.curve)):
        names = dict.fromkeys([*getattr(before.own, domain), *getattr(after.own, domain)])
        for name in names:
            if name in _NEVER or name in _HANDLES:
                continue
            take = (lambda side: side.of_points(name)) if domain == "point" else (lambda side: side.of_strokes(name))  # noqa: B023
            values = take(before)
            into[name] = values
            if values.dtype.kind == "f":
                later = take(after)
                if not np.array_equal(values, later):
                    block.ends[name] = values, later
    if "cyclic" in content.curve or closed.any():
        content.set_strokes("cyclic", closed)
    if "fill_id" in content.curve and not before.there.all():
        content.curve["fill_id"] = _fills(before, after)
    content.point["position"] = block.positions[0]


def _fills(before: _Side, after: _Side) -> np.ndarray:
    """Numbers of fills: those of the earlier key. Strokes that appear get the number of their fill there, or a new one."""
    fills, later = before.of_strokes("fill_id").copy(), after.of_strokes("fill_id")
    there = before.there & after.there & (fills != 0)
    known = {int(j): int(i) for i, j in zip(fills[there][::-1], later[there][::-1]) if j != 0}
    most = max(int(fills.max()), int(later.max()), 0)
    for k in np.flatnonzero(~before.there & (fills != 0)):
        fills[k] = known.setdefault(int(fills[k]), most + int(fills[k]))
    return fills


def _exchanged(stands: np.ndarray, opacities: np.ndarray) -> tuple[int, int]:
    """The number of strokes of either key that show on its half of the span only, so that others take their place."""
    gone = doubted.given_way(opacities)
    return int((gone & (stands[:, 1] < 0)).sum()), int((gone & (stands[:, 0] < 0)).sum())


def _fade(block: Block, opacities: np.ndarray, sides) -> None:
    """Sets the opacity of the lines and fills of strokes that fade."""
    if (opacities >= 1).all():
        return
    content = block.content
    for name, into, share in (
        ("opacity", content.point, np.repeat(opacities, content.sizes, axis=1)),
        ("fill_opacity", content.curve, opacities),
    ):
        if name not in into:
            into[name] = gp.blank(name, share.shape[1])
            content.kinds[name] = gp.TYPES[name][0]
        first, last = block.ends.pop(name, (into[name], into[name]))
        block.changing[name] = ((first + (last - first) * block.shares[:, None]) * share).astype(np.float32)


def _turn_handles(block: Block, sides, sheet: Sheet, laid: Laid, layer: int, pixels: np.ndarray) -> None:
    """Handles of Bézier curves. They keep their direction relative to the line."""
    sizes = block.content.sizes
    given = np.asarray(laid.drawings.strokes.points).reshape(-1, 2)
    ways = [_tangents(side.flat(given)[None], sizes)[0] for side in sides]
    now = _tangents(pixels, sizes)
    plane, shares = sheet.plane, block.shares[:, None]
    for name in _HANDLES:
        if name not in block.content.kinds:
            continue
        ends = []
        for side, way in zip(sides, ways):
            apart, away = plane.flat(side.of_points(name), layer)
            own, level = plane.flat(side.of_points("position"), layer)
            ends.append(((apart - own) @ [1, 1j] * way.conj(), away - level))
        (turned, away), (turned_last, away_last) = ends
        offset = (turned + (turned_last - turned) * shares) * now
        away = away + (away_last - away) * shares
        zero = plane.back(np.zeros((1, 2)), np.zeros(1), layer)
        moved = plane.back(np.stack([offset.real, offset.imag], -1), away, layer) - zero
        block.changing[name] = (block.positions + moved).astype(np.float32)
        block.content.point[name] = block.changing[name][0]


def _tangents(points: np.ndarray, sizes: np.ndarray) -> np.ndarray:
    """Directions (F, N) of lines at their points (F, N, 2), as complex numbers of length 1."""
    ends = np.cumsum(sizes)
    index = np.arange(ends[-1])
    before, after = index - 1, index + 1
    before[ends - sizes] = ends - sizes
    after[ends - 1] = ends - 1
    way = (points[:, after] - points[:, before]) @ [1, 1j]
    length = np.abs(way)
    return np.where(length > 0, way / np.where(length > 0, length, 1), 1)


def write(ob, block: Block, tracks: np.ndarray) -> dict[int, int]:
    """Writes a block. Returns the checksums of its drawings. Earlier generated frames in its place are replaced."""
    layer = gp.find_layer(ob, block.layer)
    wanted = set(block.frames)
    made = [
        number
        for number, (handle, kind) in gp.drawings(layer).items()
        if block.first < number < block.last and (ks.is_tweened(handle, kind) or ks.is_emptied(handle, kind))
    ]
    gp.remove_frames(layer, made)
    start = block.frames[0]
    gp.copy_frame(layer, block.first, start)
    gp.set_keyframe_type(layer, {start: gp.GENERATED})
    _begin(gp.drawings(layer)[start][0], block, tracks)
    for number in block.frames[1:]:
        gp.copy_frame(layer, start, number)
    sums = {}
    drawings = {number: found for number, found in gp.drawings(layer).items() if number in wanted}
    for k, number in enumerate(block.frames):
        handle, _ = drawings[number]
        share = np.float32(block.shares[k])
        gp.put(handle, "position", block.positions[k])
        for name, (first, last) in block.ends.items():
            gp.put(handle, name, first + (last - first) * share)
        for name, values in block.changing.items():
            gp.put(handle, name, values[k])
        gp.points_changed(handle)
        sums[number] = records.checksum(block.positions[k])
    gp.set_keyframe_type(layer, dict.fromkeys(block.frames, gp.GENERATED))
    marks.note(ob.data, block.layer, block.frames)
    return sums


def _begin(handle, block: Block, tracks: np.ndarray) -> None:
    """Makes the first drawing of a span from a copy of the earlier key."""
    count = len(block.content.sizes)
    if not block.alike:
        st.write(handle, block.content)
    for name in (gp.NEXT, gp.BEFORE, gp.KEY):
        if gp.has(handle, name):
            gp.put(handle, name, np.zeros(count, np.int32))
    for name in (*block.ends, *block.changing):
        if not gp.has(handle, name):
            domain = "POINT" if name in block.content.point else "CURVE"
            gp.make(handle, name, block.content.kinds[name], domain)
    gp.put(handle, gp.TRACK, tracks)
    gp.put(handle, gp.SIDES, breakdowns.sides(block.stands, block.held))
    gp.put(handle, gp.TWEENED, np.ones(count, bool))

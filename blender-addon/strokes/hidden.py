"""Remove Hidden Lines: cuts lines where filled strokes in front cover them.

The visible parts of a cut stroke replace it. Each part has all attributes of the stroke, the stroke's number (`rototoon_stroke`)
and its interval of the stroke (`rototoon_interval`). A filled stroke must keep its outline for the fill. It stays with a transparent
line, and its visible parts are added above it without a fill.

Limits: the artist's drawings are cut too, and only undo brings their lines back. In-betweens that are drawn from them later come from what is left.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import product
from typing import Any

import numpy as np
from rototoon import Pieces, Strokes, hidden_lines

from ..blender import grease_pencil as gp
from ..blender import covering, guard, hierarchy, marks, placement, stroke_lines
from ..blender import strokes as st
from ..blender.projection import Projection
from ..blender.seen import Seen, changed
from ..lines import rototoon_changes as traced_changes

SUFFIX = hierarchy.ASIDE
"""Suffix of the name of a layer with hidden lines."""
ROUNDING = 1e-3
"""Intervals are kept in single precision. Ends closer than this to a whole number may have been one."""
_POLYLINE, _SPLINE, _CHAIN = range(3)


@dataclass(frozen=True)
class Choices:
    """Which strokes cover others."""

    closed: bool
    """Whether all closed strokes cover, not only filled ones."""
    by_stroke: bool
    """Whether later strokes of a layer cover earlier ones. Otherwise only layers cover layers."""


Curve = tuple[str, int, int]
"""Layer, frame and index of a stroke that is a curve of a kind that the library does not have."""


@dataclass
class Noted:
    """What is told beside the result."""

    clear: set[str] = field(default_factory=set)
    """Layers with fills through which one sees."""
    uncut: set[Curve] = field(default_factory=set)
    """Curves that are hidden somewhere, and cannot be cut."""


@dataclass
class Cut:
    """A drawing without its hidden lines."""

    layer: str
    frame: int
    source: int
    """Frame of the drawing that was cut."""
    seen: st.Content
    hidden: st.Content
    changed: bool
    """Whether anything was hidden."""
    pieces: int
    """Number of hidden parts."""
    gone: set[int]
    """Numbers (`rototoon_track`) of the strokes of which nothing is left."""


def is_output(layer) -> bool:
    """Whether a layer has hidden lines. A layer that only bears such a name is the artist's. Reads no array."""
    return layer.name.endswith(SUFFIX) and any(gp.has(handle, gp.INTERVAL) for handle in gp.handles(layer))


def frames_between(ob, first: int, last: int) -> list[int]:
    """The frames of a range on which something can change: the frames of all drawings, or all frames if the view moves."""
    if placement.moves(ob, gp.every_layer(ob)):
        return list(range(first, last + 1))
    numbers = {number for layer in gp.every_layer(ob) if not is_output(layer) for number in gp.frame_numbers(layer)}
    return sorted({first, *(number for number in numbers if first < number <= last)})


def next_change(ob, last: int) -> int | None:
    """The first frame after a range on which something can change; `None` if nothing does."""
    if placement.moves(ob, gp.every_layer(ob)):
        return last + 1
    return min((number for layer in gp.every_layer(ob) if not is_output(layer) for number in gp.frame_numbers(layer) if number > last), default=None)


def cut_frame(ob, frame: int, choices: Choices, seen: Seen, noted: Noted) -> Iterator[Cut]:
    """The drawings of the current frame `frame`, without hidden lines. What was read is noted in `seen`, and what is to be told in `noted`."""
    scene = _Scene(ob, frame, choices)
    noted.clear |= scene.clear
    found = hidden_lines(scene.strokes(), scene.forms, scene.depths, scene.fills)
    pieces = _Pieces(found)
    may_change = {layer.name for layer in st.editable_layers(ob, active=False)}
    hidden = set(pieces.strokes[pieces.hidden].tolist())
    noted.uncut |= {curve for index, curve in scene.curves.items() if index in hidden and curve[0] in may_change}
    for entry in scene.entries:
        if entry.layer.name in may_change:
            seen.note(entry.layer.name, entry.source, entry.content)
            yield _cut(ob, frame, entry, pieces)


@dataclass
class _Entry:
    """A visible drawing."""

    layer: Any
    source: int
    content: st.Content
    first_stroke: int
    first_point: int
    fills: np.ndarray
    fine: np.ndarray
    """Strokes with a known curve type and finite points. Others are not cut. Curves of other types cover with their lines."""


class _Scene:
    """The strokes of all visible layers, as the library takes them."""

    def __init__(self, ob, frame: int, choices: Choices):
        view = Projection(ob)
        self.clear: set[str] = set()
        """Layers with fills that are seen, and that hide nothing."""
        self.entries: list[_Entry] = []
        self.curves: dict[int, Curve] = {}
        """By index the lines of curves that cannot be cut."""
        self._columns = {"sizes": [], "points": [], "closed": [], "forms": [], "depths": [], "fills": []}
        self._strokes = self._count = 0
        for depth, layer in enumerate(gp.every_layer(ob)):
            number = st.shown_frame(layer, frame)
            if guard.is_hidden(layer) or is_output(layer) or number is None:
                continue
            content = st.read(gp.drawings(layer)[number][0])
            forms, finite = _forms(content), content.finite()
            fine = finite & (forms >= 0)
            every, lines = st.filled(ob, content), np.arange(len(content.sizes))
            covers = self._covers(ob, layer, content, every, choices)
            self.entries.append(_Entry(layer, number, content, self._strokes, self._count, every, fine))
            depths = np.stack([np.full_like(lines, depth), lines if choices.by_stroke else np.zeros_like(lines)], 1)
            closed = content.strokes("cyclic")
            self._put(content.sizes, _pixels(view, layer, content, fine), closed, np.maximum(forms, 0), depths, np.where(fine, covers, 0))
            lineless = st.lineless(ob, content)
            for i, line in _curves(content, finite & ~fine):
                if not lineless[i]:
                    self.curves[self._strokes] = layer.name, number, i
                self._put([len(line)], view.pixels(layer, line), closed[[i]], [_POLYLINE], depths[[i]], covers[[i]])
        joined = {name: np.concatenate(each) if each else np.zeros(0) for name, each in self._columns.items()}
        self._points = np.ascontiguousarray(joined["points"], np.float64).reshape(-1, 2)
        self._offsets = np.concatenate([[0], np.cumsum(joined["sizes"])]).astype(np.int32)
        self._closed = joined["closed"].astype(np.uint8)
        self.forms = joined["forms"].astype(np.uint8)
        self.depths = np.ascontiguousarray(joined["depths"], np.int32)
        self.fills = joined["fills"].astype(np.int32)

    def _put(self, *columns) -> None:
        """Adds strokes, with the columns in their order."""
        for name, values in zip(self._columns, columns, strict=True):
            self._columns[name].append(values)
        self._strokes += len(columns[0])
        self._count += len(columns[1])

    def _covers(self, ob, layer, content: st.Content, fills: np.ndarray, choices: Choices) -> np.ndarray:
        """For each stroke the number of what it covers with; 0 if it covers nothing."""
        opacity, mixes = covering.of_fills(ob, layer, content), covering.mixes(layer)
        hides = (opacity >= covering.OPAQUE) & (not mixes)
        if ((opacity > 0) & ~hides & (fills != 0)).any():
            self.clear.add(layer.name)
        covers = np.where(hides, fills, 0)
        if choices.closed and not covering.is_masked(layer):
            above = max(fills.max(initial=0), 0) + 1
            closed = content.strokes("cyclic") & covering.of_lines(ob, layer, content)
            covers = np.where((covers == 0) & closed, above + np.arange(len(fills)), covers)
        return covers

    def strokes(self) -> Strokes:
        """The strokes of all layers."""
        return Strokes(self._offsets, self._points, self._closed)


def _forms(content: st.Content) -> np.ndarray:
    """The library's form of each stroke; -1 for curves that the library does not have."""
    order, knots = content.strokes("nurbs_order"), content.strokes("knots_mode")
    quadratic = (content.types == st.NURBS) & (order == 3) & (content.sizes > 2)
    uniform = quadratic & (np.where(content.strokes("cyclic"), 0, st.ENDPOINT) == knots)
    chain = quadratic & ~content.strokes("cyclic") & (knots == st.ENDPOINT_BEZIER)
    return np.select([content.types == st.POLY, uniform, chain], [_POLYLINE, _SPLINE, _CHAIN], -1)


def _curves(content: st.Content, which: np.ndarray) -> Iterator[tuple[int, np.ndarray]]:
    """The lines that Blender draws for the strokes of a mask, with their indices. That of a closed one does not repeat its first point."""
    lines = stroke_lines.lines(content) if which.any() else []
    closed = content.strokes("cyclic")
    for i in np.flatnonzero(which).tolist():
        line = lines[i][:-1] if closed[i] else lines[i]
        if len(line) > 1 and np.isfinite(line).all():
            yield i, line


def _pixels(view: Projection, layer, content: st.Content, fine: np.ndarray) -> np.ndarray:
    points = content.point["position"].astype(np.float64)
    which = np.repeat(fine, content.sizes)
    pixels = np.zeros((len(points), 2))
    if which.any():
        pixels[which] = view.pixels(layer, points[which])
    return pixels


class _Pieces:
    """The visible and hidden parts, as arrays."""

    def __init__(self, found: Pieces):
        self.strokes, self.hidden = np.asarray(found.strokes), np.asarray(found.hidden) != 0
        self.intervals = np.asarray(found.intervals).reshape(-1, 2)
        offsets = np.asarray(found.offsets)
        self.starts, self.sizes = offsets[:-1], np.diff(offsets)
        self.indices = np.asarray(found.indices).reshape(-1, 3)
        self.weights = np.asarray(found.weights).reshape(-1, 3)


def _cut(ob, frame: int, entry: _Entry, pieces: _Pieces) -> Cut:
    content, count = entry.content, len(entry.content.sizes)
    # Outlines without a line stay, since they carry fills.
    carriers = st.lineless(ob, content)
    mine = np.flatnonzero((pieces.strokes >= entry.first_stroke) & (pieces.strokes < entry.first_stroke + count))
    stroke = pieces.strokes[mine] - entry.first_stroke
    mine, stroke = (each[entry.fine[stroke] & ~carriers[stroke]] for each in (mine, stroke))
    touched = np.zeros(count, bool)
    touched[stroke[pieces.hidden[mine]]] = True
    seen = mine[touched[stroke] & ~pieces.hidden[mine]]
    gone = mine[touched[stroke] & pieces.hidden[mine]]
    kept = np.flatnonzero(~touched | (entry.fills != 0))
    content, tracks = _numbered(content, touched), content.strokes(gp.TRACK)
    return Cut(
        entry.layer.name,
        frame,
        entry.source,
        _built(ob, entry, content, kept, seen, pieces, touched),
        _built(ob, entry, content, kept[:0], gone, pieces, touched),
        bool(touched.any()),
        len(gone),
        set(tracks.tolist()) - set(tracks[kept].tolist()) - set(tracks[stroke[~pieces.hidden[mine]]].tolist()),
    )


def _numbered(content: st.Content, touched: np.ndarray) -> st.Content:
    """The content, with numbers for the strokes that are cut."""
    if not touched.any():
        return content
    content = st.Content(content.sizes, content.types, dict(content.point), dict(content.curve), dict(content.kinds))
    numbers = content.strokes(gp.STROKE).copy()
    fresh = np.flatnonzero(touched & (numbers == 0))
    numbers[fresh] = st.unique_numbers(numbers, len(fresh))
    content.set_strokes(gp.STROKE, numbers)
    content.set_strokes(gp.INTERVAL, content.strokes(gp.INTERVAL))
    return content


def _built(ob, entry: _Entry, content: st.Content, kept, parts, pieces: _Pieces, touched) -> st.Content:
    """The strokes `kept`, and `parts` of strokes directly above their stroke."""
    owner = pieces.strokes[parts] - entry.first_stroke
    source = np.concatenate([kept, owner])
    order = np.argsort(source, kind="stable")
    source = source[order]
    part = np.concatenate([np.full(len(kept), -1), parts])[order]
    cut = part >= 0
    cut[cut] = pieces.sizes[part[cut]] > 0
    sizes = content.sizes[source].copy()
    sizes[cut] = pieces.sizes[part[cut]]
    result = st.Content(sizes, content.types[source].copy(), kinds=dict(content.kinds))
    indices, weights = _blends(entry, content, pieces, source, part, cut, result)
    for name, values in content.point.items():
        result.point[name] = _blended(values, indices, weights)
    result.curve = {name: values[source].copy() for name, values in content.curve.items()}
    _mark_parts(result, pieces.intervals[part[cut]], cut, _joints(content, source[cut]))
    _part_fills_from_lines(ob, result, part, entry.fills[source], touched[source])
    if touched.any():
        traced_changes.follow(content, result, source, marks.Slots(ob.data))
    return result


def _blends(entry, content, pieces, source, part, cut, result):
    """For each point of the result three points of the drawing (N, 3) and their weights, of which it is the sum."""
    total = int(result.starts[-1])
    indices, weights = np.zeros((total, 3), np.int64), np.zeros((total, 3))
    weights[:, 0] = 1
    starts = result.starts[:-1]
    there = st.ranges(content.starts[source[~cut]], result.sizes[~cut])
    indices[st.ranges(starts[~cut], result.sizes[~cut])] = there[:, None]
    here = st.ranges(starts[cut], result.sizes[cut])
    rows = st.ranges(pieces.starts[part[cut]], pieces.sizes[part[cut]])
    indices[here] = pieces.indices[rows] - entry.first_point
    weights[here] = pieces.weights[rows]
    return indices, weights


def _blended(values: np.ndarray, indices: np.ndarray, weights: np.ndarray) -> np.ndarray:
    if values.dtype.kind != "f":
        nearest = weights.argmax(1) if len(weights) else np.zeros(0, int)
        return values[indices[np.arange(len(indices)), nearest]]
    # Points of weight 0 do not count, even if they are not finite.
    shaped = weights.reshape(*weights.shape, *(1,) * (values.ndim - 1))
    return np.where(shaped != 0, values[indices] * shaped, 0).sum(1).astype(values.dtype)


def _joints(content: st.Content, strokes: np.ndarray) -> list[np.ndarray | None]:
    """For each of the strokes the parameters, on the stroke that it was cut from, of the joints of its own pieces; `None` of a complete stroke.

    Between two joints a parameter is proportional to that of the complete stroke. What has another number of points since then is taken as
    proportional from end to end.
    """
    forms, known = _forms(content), content.strokes(gp.INTERVAL).astype(np.float64)
    found: list[np.ndarray | None] = []
    for i in strokes.tolist():
        first, last = known[i]
        if first == last:
            found.append(None)
            continue
        points = int(content.sizes[i])
        own = max({_POLYLINE: points - 1, _SPLINE: points - 2}.get(int(forms[i]), points // 2), 1)
        fitting = (joints for joints in _possible_joints(first, last) if len(joints) == own + 1)
        found.append(next(fitting, np.linspace(first, last, own + 1)))
    return found


def _possible_joints(first: float, last: float) -> Iterator[np.ndarray]:
    """The joints of a piece from one parameter to another: both, and the whole numbers between. An end that is one but for rounding may be a joint more."""
    for before, after in product((0.0, ROUNDING, -ROUNDING), repeat=2):
        between = np.arange(np.floor(first - before) + 1, np.ceil(last + after))
        yield np.concatenate([[first], between.clip(first, last), [last]])


def _mark_parts(result: st.Content, parts: np.ndarray, cut: np.ndarray, joints: list[np.ndarray | None]) -> None:
    """Stores the interval of each part, and makes the parts open. `parts` are their intervals on the strokes that are cut now, and `joints` tell
    where these are on complete strokes."""
    if not cut.any():
        return
    intervals = result.strokes(gp.INTERVAL).copy()
    intervals[cut] = [own if on is None else np.interp(own, np.arange(len(on)), on) for own, on in zip(parts, joints, strict=True)]
    result.set_strokes(gp.INTERVAL, intervals)
    cyclic = result.strokes("cyclic").copy()
    cyclic[cut] = False
    result.set_strokes("cyclic", cyclic)
    curves = cut & (result.types == st.NURBS)
    if curves.any():
        knots = result.strokes("knots_mode").copy()
        # For a single piece Blender needs the mode of ordinary knots. The knots are the same.
        knots[curves] = np.where(result.sizes[curves] > 3, st.ENDPOINT_BEZIER, st.ENDPOINT)
        result.set_strokes("knots_mode", knots)


def _part_fills_from_lines(ob, result: st.Content, part, fills, touched) -> None:
    """Makes the lines of strokes that stay for their fill transparent, and removes the fill of their parts."""
    carrier = (part < 0) & touched
    if carrier.any():
        opacity = result.point.get("opacity")
        opacity = gp.blank("opacity", int(result.starts[-1])) if opacity is None else opacity
        opacity[np.repeat(carrier, result.sizes)] = 0
        intervals = result.strokes(gp.INTERVAL).copy()
        whole = carrier & ~intervals.any(1)
        intervals[whole] = np.stack([np.zeros(whole.sum()), result.sizes[whole]], 1)
        result.set_strokes(gp.INTERVAL, intervals)
        result.kinds.setdefault("opacity", "FLOAT")
        result.point["opacity"] = opacity
    lines = (part >= 0) & (fills != 0)
    if not lines.any():
        return
    if gp.FILL_BY_ID:
        numbers = result.strokes("fill_id").copy()
        numbers[lines] = 0
        result.set_strokes("fill_id", numbers)
        return
    index = result.strokes("material_index").copy()
    for each in np.unique(index[lines]):
        index[lines & (index == each)] = st.line_material(ob, int(each))
    result.set_strokes("material_index", index)


def own(ob, cuts: list[Cut], in_place: bool) -> dict[str, set[int]]:
    """By layer the frames of the artist's drawings that `write` will cut. A generated copy of one is not it."""
    found: dict[str, set[int]] = {}
    for each in cuts:
        if each.changed and (in_place or each.frame == each.source):
            found.setdefault(each.layer, set()).add(each.source)
    kinds = {name: gp.drawings(gp.find_layer(ob, name)) for name in found}
    return {name: mine for name, frames in found.items() if (mine := {frame for frame in frames if kinds[name][frame][1] != gp.GENERATED})}


def gone(cuts: list[Cut], in_place: bool) -> dict[str, dict[int, set[int]]]:
    """By layer and frame that `write` will cut the numbers of the strokes of which nothing is left."""
    found: dict[str, dict[int, set[int]]] = {}
    for each in cuts:
        if each.gone:
            found.setdefault(each.layer, {})[each.source if in_place else each.frame] = each.gone
    return found


def need_unchanged(ob, cuts: list[Cut], seen: Seen) -> None:
    """Raises a `Problem` if a drawing that `write` will cut, or copy, is another one now, or another one is shown in its place."""
    names = {each.layer for each in cuts if each.changed}
    mine = [each for each in cuts if each.layer in names]
    seen.need((each.layer, each.source) for each in mine)
    for each in mine:
        if st.shown_frame(gp.find_layer(ob, each.layer), each.frame) != each.source:
            raise changed(each.layer, each.frame)


def write(ob, cuts: list[Cut], move: bool, in_place: bool, after: int | None = None) -> tuple[int, int]:
    """Writes cut drawings. Returns the number of changed drawings and of hidden parts.

    With `move`, hidden parts move to layers of their own. With `in_place`, the visible drawings are cut. Otherwise a drawing that
    shows on several frames gets a new frame where its hidden lines change. From frame `after` on nobody has looked: what shows there stays as it was.
    """
    changed = parts = 0
    by_layer: dict[str, list[Cut]] = {}
    for each in cuts:
        by_layer.setdefault(each.layer, []).append(each)
    for name, group in by_layer.items():
        if not any(each.changed for each in group):
            continue
        layer = gp.find_layer(ob, name)
        aside = _Aside(hierarchy.beside(ob, layer, name + SUFFIX)) if move else None
        group = sorted(group, key=lambda cut: cut.frame)
        kept = after is not None and group[-1].changed and _kept(layer, group[-1].source, after)
        before: Cut | None = None
        for each in group:
            again = before is not None and before.source == each.source
            same = before.seen.equals(each.seen) if again else not each.changed
            number = each.source if in_place else each.frame
            if aside is not None and not (same and again):
                aside.put(number, each.source, each.hidden)
            before = each
            if same:
                continue
            _put(layer, number, each.source, each.seen)
            changed += 1
            parts += each.pieces
        # What is hidden of a drawing ends with it.
        end = after if kept else min((number for number in gp.frame_numbers(layer) if number > group[-1].frame), default=None)
        if aside is not None and end is not None:
            aside.put(end, group[-1].source if kept else end, st.chosen(group[-1].hidden, []))
    return changed, parts


def _kept(layer, source: int, after: int) -> bool:
    """Keeps a drawing that will be cut as it is from frame `after` on, if it shows there. Returns whether it does."""
    if st.shown_frame(layer, after) != source:
        return False
    _put(layer, after, source, st.read(gp.drawings(layer)[source][0]))
    return True


class _Aside:
    """A layer with hidden lines."""

    def __init__(self, layer):
        self._layer = layer
        self._before = {number: st.read(handle) for number, (handle, _) in gp.drawings(layer).items()}

    def put(self, number: int, source: int, hidden: st.Content) -> None:
        """Adds hidden lines of the drawing of frame `source` to a frame. What an earlier run has hidden of it still counts there; the hidden lines of
        an earlier frame of this run do not."""
        shown = max((frame for frame in self._before if source <= frame <= number), default=None)
        if shown is not None:
            hidden = st.joined(self._before[shown], hidden)
        elif not len(hidden.sizes) and st.shown_frame(self._layer, number) is None:
            return
        _put(self._layer, number, None, hidden)


def _put(layer, number: int, source: int | None, content: st.Content) -> None:
    """Writes a drawing on a frame. A new frame is a generated one. It begins as a copy of `source`, for what is not written."""
    if number not in gp.drawings(layer) and source is not None:
        gp.copy_frame(layer, source, number)
        gp.set_keyframe_type(layer, {number: gp.GENERATED})
    gp.make_frames(layer, [number], gp.GENERATED)
    st.write(gp.drawings(layer)[number][0], content)

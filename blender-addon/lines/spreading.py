"""An edit of strokes on one frame, for the same strokes on all frames. Plain NumPy on contents of drawings.

Each point of a traced stroke knows where it was (`rototoon_tracked`), on which stroke (`rototoon_line`), and at which share of its length
(`rototoon_along`). Blender carries these through its own tools. So a drawing tells by itself what the artist did since: points that
moved, strokes that were cut, joined, shortened or deleted.

On another frame a point at share s of the stroke is Q(s); on the edited frame it was P(s) and is P(s) + d. It goes to Q(s) + R(s) d. R(s)
is the similarity (turn and scale) that carries the stroke from the one frame to the other around s best: least squares over the stroke,
weighted by a Gaussian of the distance in share (as in moving least squares, Schaefer, McPhail & Warren 2006). So an edit moves, turns and
grows with its own stretch of the stroke. A frame keeps its own points; d is interpolated between the edited ones.

Limits: curves with handles or knots, on the edited frame or on the other one, give and get looks, and are deleted, but not reshaped: their points
are no points of the line. What Remove Hidden Lines has left of a stroke on the edited frame gives its look only. A stroke that was drawn anew has no such marks: carry it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..blender import grease_pencil as gp
from ..blender import marks
from ..blender import strokes as st
from . import drawings as dr
from . import spread_looks

SIGMA = 0.2
"""Width of the Gaussian in shares of the length."""
SAMPLES = 33
"""Samples of a stroke for the similarity."""
WHOLE = 1e-3
"""A stretch that lacks less than this share of the length is whole."""


@dataclass
class Edit:
    """What happened to strokes on one frame."""

    content: st.Content
    mapping: object
    """Layer points to pixels and back, on that frame."""
    edited: list[int]
    """Indices of the strokes that differ from what was traced."""
    deleted: set[int]
    """Numbers of strokes that are not there any more."""
    slots: marks.Slots
    """The material slots of the object."""
    moved: np.ndarray
    """For each stroke: whether a point was moved."""
    cut: np.ndarray
    """For each stroke: whether it was cut, joined or shortened."""
    same: np.ndarray
    """For each stroke: whether its look is the one that was noted."""
    rigid: np.ndarray
    """For each stroke: whether it only gives its look, since its points do not tell how its line was reshaped."""

    def __bool__(self) -> bool:
        return bool(self.edited or self.deleted)

    def keep(self, shape: bool, looks: bool) -> None:
        """Leaves the strokes of which the shape or the look is wanted: what is not done on other frames stays an edit."""
        reshaped = self.moved | (self.cut & ~self.rigid)
        self.edited = [i for i in self.edited if (shape and reshaped[i]) or (looks and not self.same[i])]

    def reshaped(self) -> list[int]:
        """The edited strokes whose form is done on other frames."""
        return [i for i in self.edited if not self.rigid[i]]

    def not_reshaped(self) -> list[int]:
        """The edited strokes of which points were moved, and that only give their look."""
        return [i for i in self.edited if self.rigid[i] and self.moved[i]]

    def numbers(self, i: int) -> set[int]:
        """Numbers of the strokes that stroke `i` comes from."""
        return _numbers(self.content, i)


@dataclass
class Run:
    """Successive points of an edited stroke that come from one stroke, in its direction or against it."""

    number: int
    shares: np.ndarray
    moved: np.ndarray
    """Complex pixels: how far each point was moved."""
    was: np.ndarray
    """Complex pixels: where each point was."""
    now: np.ndarray
    """The share of each point on the edited stroke as it is now."""


def found(content: st.Content, before: Sequence[int], mapping, slots: marks.Slots, chosen: np.ndarray | None = None) -> Edit:
    """The edit of a drawing. `before` are the numbers of its strokes when it was traced. Of edited strokes only the `chosen` ones
    count."""
    lines = content.point.get(gp.LINE)
    none = np.zeros(len(content.sizes), bool)
    if lines is None:
        return Edit(content, mapping, [], set(), slots, none, none, ~none, none)
    starts, tracks = content.starts, content.strokes(gp.TRACK)
    same, rigid = dr.has_looks(content, slots), _rigid(content)
    away = (content.point[gp.TRACKED] != content.point["position"]).any(1)
    twice = {number for number in tracks.tolist() if (tracks == number).sum() > 1}
    moved, cut, edited = none.copy(), none.copy(), []
    for i, (a, b) in enumerate(zip(starts, starts[1:])):
        own = _numbers(content, i)
        if not own or (chosen is not None and not chosen[i]):
            continue
        moved[i] = away[a:b].any() or (lines[a:b] == 0).any()
        along = content.point[gp.ALONG][a:b]
        cut[i] = own != {int(tracks[i])} or int(tracks[i]) in twice or min(along[0], along[-1]) > 1e-4 or max(along[0], along[-1]) < 1 - 1e-4
        if moved[i] or not same[i] or (cut[i] and not rigid[i]):
            edited.append(i)
    deleted = set(before) - present(content) if chosen is None else set()
    return Edit(content, mapping, edited, deleted, slots, moved, cut, same, rigid)


def present(content: st.Content) -> set[int]:
    """The numbers of the strokes of which a drawing has something, as strokes or joined to others; 0 of those that are not followed yet."""
    return {0, *content.point.get(gp.LINE, np.zeros(0, int)).tolist(), *content.strokes(gp.TRACK).tolist()}


def _numbers(content: st.Content, i: int) -> set[int]:
    return set(content.point[gp.LINE][content.starts[i] : content.starts[i + 1]].tolist()) - {0}


def _rigid(content: st.Content) -> np.ndarray:
    """For each stroke: whether it is a curve or what Remove Hidden Lines has left, or comes from a number of which another stroke is one."""
    rigid = (content.types != st.POLY) | spread_looks.left_by_rototoon(content)
    owns = [_numbers(content, i) for i in range(len(rigid))]
    numbers: set[int] = set()
    while not (whole := set().union(*(owns[i] for i in np.flatnonzero(rigid)))) <= numbers:
        numbers = whole
        rigid = rigid | np.array([bool(own & numbers) for own in owns])
    return rigid


def numbers_after(edit: Edit, fresh: int) -> dict[int, int]:
    """The number of each edited stroke: its own, but that of a second piece is new, from `fresh` on."""
    tracks, taken = edit.content.strokes(gp.TRACK), set()
    result = {i: int(tracks[i]) for i in edit.edited if edit.rigid[i]}
    for i in edit.reshaped():
        number = int(tracks[i])
        if number == 0 or number in taken:
            number, fresh = fresh, fresh + 1
        taken.add(number)
        result[i] = number
    return result


def noted(edit: Edit, numbers: dict[int, int], shape: bool, looks: bool) -> st.Content:
    """The edited drawing with its new numbers, and marks from where the next edit is measured. What was not done on other frames keeps its marks."""
    content = edit.content
    chosen = np.zeros(len(content.sizes), bool)
    chosen[edit.edited] = True
    if shape:
        tracks = content.strokes(gp.TRACK).copy()
        for i, number in numbers.items():
            tracks[i] = number
        content.set_strokes(gp.TRACK, tracks)
        # The points of what only gives its look are where they were on their stroke.
        dr.mark_places(content, chosen, ~edit.rigid)
    if looks:
        dr.mark_looks(content, edit.slots, chosen)
    return content


def spread(edit: Edit, numbers: dict[int, int], content: st.Content, mapping, shape: bool, looks: bool) -> tuple[st.Content, int]:
    """The content of another frame with the edit, and the number of strokes that could not be reshaped there."""
    tracks = content.strokes(gp.TRACK)
    gone = np.isin(tracks, sorted(edit.deleted))
    made: list[tuple[int, st.Content]] = []
    left_out = 0
    if not shape:
        made = _looked(edit, content, edit.edited, gone) if looks else []
        gone[[place for place, _ in made]] = True
    elif edit.edited:
        made = _looked(edit, content, [i for i in edit.edited if edit.rigid[i] and not edit.same[i]], gone) if looks else []
        gone[[place for place, _ in made]] = True
        pixels = to_complex(mapping, content.point["position"])
        touched = set().union(*(edit.numbers(i) for i in edit.reshaped()))
        there = {number: _pieces(content, pixels, number) for number in touched}
        before = to_complex(edit.mapping, edit.content.point[gp.TRACKED])
        now = to_complex(edit.mapping, edit.content.point["position"])
        for i in edit.reshaped():
            new = _made(edit, i, numbers[i], content, there, before, now, mapping, looks)
            if new is None:
                left_out += int(edit.moved[i] or edit.cut[i])
            else:
                made += new
        gone[[piece.index for pieces in there.values() for piece in pieces]] = True
        # Curves with handles or knots, and single points, get the look.
        rest = _looked(edit, content, [i for i in edit.reshaped() if not edit.same[i]], gone) if looks else []
        made += rest
        gone[[place for place, _ in rest]] = True
    # A look that the artist changed there only is still to be done where none came from here.
    known = dr.has_looks(content, edit.slots)
    if looks:
        known |= np.isin(tracks, sorted(set().union(*(edit.numbers(i) for i in edit.edited if not edit.same[i]))))
    return _assembled(content, gone, made, edit.slots, known), left_out


def to_complex(mapping, points: np.ndarray) -> np.ndarray:
    """Pixels of layer points as complex numbers."""
    if not len(points):
        return np.zeros(0, complex)
    xy = mapping.to_pixels(np.asarray(points, np.float64))
    return xy[:, 0] + 1j * xy[:, 1]


@dataclass
class _Piece:
    """A stroke on another frame, or what there is of it in one piece there."""

    index: int
    points: np.ndarray
    """Indices of its points among those of the drawing, by share."""
    shares: np.ndarray
    pixels: np.ndarray
    """Complex pixels."""
    closed: bool


def _pieces(content: st.Content, pixels: np.ndarray, number: int) -> list[_Piece]:
    """All that can be reshaped of a stroke on another frame, by share: the artist may have cut it there only."""
    places = np.flatnonzero((content.strokes(gp.TRACK) == number) & (content.sizes > 1) & (content.types == st.POLY))
    found = []
    for index in places.tolist():
        points = np.arange(*content.starts[index : index + 2])
        for part, shares in _stretches(content.point["position"][points], _along(content, points)):
            found.append(_Piece(index, points[part], shares, pixels[points[part]], bool(content.strokes("cyclic")[index])))
    return sorted(found, key=lambda piece: piece.shares[0])


def _along(content: st.Content, points: np.ndarray) -> np.ndarray | None:
    """The shares of a stroke's points; `None` if some were drawn or joined to it since, and so have none on it."""
    along, lines = content.point.get(gp.ALONG), content.point.get(gp.LINE)
    if along is None or lines is None or not lines[points].all() or np.ptp(lines[points]):
        return None
    return along[points].astype(np.float64)


def _stretches(points: np.ndarray, along: np.ndarray | None) -> list[tuple[np.ndarray, np.ndarray]]:
    """The stretches of a piece along which the share grows, as indices and shares: two if it runs over the seam of a closed stroke."""
    every = np.arange(len(points))
    jumps = [] if along is None else np.flatnonzero(np.abs(np.diff(along)) > 0.5) + 1
    if along is not None and len(jumps) < 2:
        # Few points may be far from each other without a seam.
        for parts in ([every], np.split(every, jumps)):
            turned = [part if along[part[-1]] >= along[part[0]] else part[::-1] for part in parts]
            if all((np.diff(along[part]) >= 0).all() for part in turned):
                return [(part, along[part]) for part in turned]
    return [(every, dr.shares(points))]


def runs(edit: Edit, i: int, before: np.ndarray, now: np.ndarray) -> list[Run]:
    """The runs of an edited stroke. Points that were drawn since belong to the run before them, or to the first one."""
    a, b = edit.content.starts[i : i + 2]
    lines = edit.content.point[gp.LINE][a:b].copy()
    along = edit.content.point[gp.ALONG][a:b].astype(np.float64)
    old, new, after = before[a:b].copy(), now[a:b], dr.shares(edit.content.point["position"][a:b])
    known = np.flatnonzero(lines)
    for k in np.flatnonzero(lines == 0):
        near = known[np.argmin(np.abs(known - k))]
        lines[k], along[k], old[k] = lines[near], along[near], old[near]
    found: list[Run] = []
    start = 0
    for k in range(1, len(lines) + 1):
        if k < len(lines) and lines[k] == lines[k - 1] and not _turns(along, lines, start, k):
            continue
        span = slice(start, k)
        found.append(Run(int(lines[start]), along[span], (new - old)[span], old[span], after[span]))
        start = k
    return found


def _turns(along: np.ndarray, lines: np.ndarray, start: int, k: int) -> bool:
    """Whether the share jumps at point `k`, as at the seam of a closed stroke. A long step between few points goes on in its direction."""
    step = along[k] - along[k - 1]
    after = along[k + 1] - along[k] if k + 1 < len(along) and lines[k + 1] == lines[k] else 0.0
    return (abs(step) > 0.5 and step * after < 0) or (k - start > 1 and step * (along[k - 1] - along[start]) < 0)


def similarity(was: np.ndarray, here: np.ndarray, samples: np.ndarray, where: np.ndarray, closed: bool) -> np.ndarray:
    """The factor (complex) by which displacements at shares `where` turn and grow. `was` and `here` are the stroke at `samples`."""
    away = np.abs(where[:, None] - samples[None])
    away = np.minimum(away, 1 - away) if closed else away
    weights = np.exp(-0.5 * (away / SIGMA) ** 2)
    weights /= weights.sum(1, keepdims=True)
    p = was[None] - (weights @ was)[:, None]
    q = here[None] - (weights @ here)[:, None]
    size = (weights * np.abs(p) ** 2).sum(1)
    return np.where(size > 1e-9, (weights * q * p.conj()).sum(1) / np.maximum(size, 1e-9), 1.0)


def _made(edit, i, number, content, there, before, now, mapping, looks) -> list[tuple[int, st.Content]] | None:
    """What the edited stroke `i` is on another frame, with the indices that it takes: nothing if none of its strokes is there, several
    strokes if it is cut there. `None` if it cannot be reshaped."""
    parts = [run for run in runs(edit, i, before, now) if there.get(run.number)]
    if not parts:
        return None if np.isin(content.strokes(gp.TRACK), sorted(edit.numbers(i))).any() else []
    closed, found = bool(edit.content.strokes("cyclic")[i]), []
    lines = _reshaped(edit, parts, there, before, closed)
    for line in lines:
        if len(line.points) < 2:
            continue
        points = mapping.to_layer(np.stack([line.points.real, line.points.imag], 1)).astype(np.float32)
        made = _like(content, line.piece, line.where, points)
        made.set_strokes("cyclic", np.array([closed and _is_closed(line, lines)]))
        made.set_strokes(gp.TRACK, np.array([number], np.int32))
        dr.mark_places(made)
        if not line.is_whole():
            # The next edit goes on where this one is.
            made.point[gp.ALONG] = line.now.astype(np.float32)
        if looks and not edit.same[i]:
            spread_looks.look_like(made, edit.content, spread_looks.sources(edit.content, [i])[0], spread_looks.changed(content, line.piece.index))
        found.append((line.piece.index, made))
    return found


def _is_closed(line: _Line, lines: list[_Line]) -> bool:
    """Whether a line of a closed stroke is closed on another frame: it is there already, or it is whole."""
    if line.piece.closed:
        return sum(other.piece.index == line.piece.index for other in lines) == 1
    return len(lines) == 1 and line.begins and line.ends


def _looked(edit: Edit, content: st.Content, which: Sequence[int], gone: np.ndarray) -> list[tuple[int, st.Content]]:
    """The strokes of a drawing that get the look of the edited strokes `which` only, with their indices. Those that are `gone` get none."""
    tracks, made = content.strokes(gp.TRACK), {}
    for source in spread_looks.sources(edit.content, which):
        for place in np.flatnonzero(np.isin(tracks, sorted(edit.numbers(source.stroke))) & (content.sizes > 0) & ~gone):
            spread_looks.look_like(made.setdefault(int(place), st.chosen(content, [place])), edit.content, source, spread_looks.changed(content, place))
    return sorted(made.items(), key=lambda each: each[0])


@dataclass
class _Line:
    """A stretch of an edited stroke on another frame."""

    points: np.ndarray
    """Complex pixels."""
    where: np.ndarray
    """The share of each point on its stroke there."""
    now: np.ndarray
    """The share of each point on the edited stroke as it is now."""
    piece: _Piece
    """What gives the attributes."""
    begins: bool
    """Whether it begins where the run begins, and is not cut there on this frame."""
    ends: bool

    def with_next(self, other: _Line) -> _Line:
        """Both in one."""
        rows = (np.concatenate([getattr(self, name), getattr(other, name)]) for name in ("points", "where", "now"))
        return _Line(*rows, self.piece, self.begins, other.ends)

    def turned(self) -> _Line:
        """In the other direction."""
        return _Line(self.points[::-1], self.where[::-1], self.now[::-1], self.piece, self.ends, self.begins)

    def is_whole(self) -> bool:
        """Whether all of the edited stroke is there."""
        return self.now[0] < WHOLE and self.now[-1] > 1 - WHOLE


def _reshaped(edit: Edit, parts: list[Run], there: dict[int, list[_Piece]], before: np.ndarray, closed: bool) -> list[_Line]:
    """The lines of all runs on another frame: one, unless a stroke is cut there."""
    lines: list[_Line] = []
    for run in parts:
        was = _original(edit, run.number, before)
        stretches = [_stretch(run, piece, *was) for piece in there[run.number]]
        stretches = [each for each in stretches if each is not None]
        if run.shares[-1] < run.shares[0]:
            stretches = [each.turned() for each in reversed(stretches)]
        for k, each in enumerate(stretches):
            if lines and k == 0 and lines[-1].ends and each.begins:
                lines[-1] = lines[-1].with_next(each)
            else:
                lines.append(each)
    first = next((k for k, each in enumerate(lines[:-1]) if each.piece.index == lines[-1].piece.index), None) if closed else None
    if first is not None and lines[-1].ends and lines[first].begins:
        # What lies on both sides of the seam of a closed stroke.
        lines[first] = lines.pop().with_next(lines[first])
        lines[first].begins = lines[first].ends = False
    return lines


def _stretch(run: Run, piece: _Piece, known: np.ndarray, was: np.ndarray) -> _Line | None:
    """What of a run is on a piece, by share. `was` is the stroke of the edited frame at the shares that are `known`."""
    order = np.argsort(run.shares, kind="stable")
    shares, moved, here = run.shares[order], run.moved[order], piece.shares
    first, last = max(shares[0], here[0]), min(shares[-1], here[-1])
    if first > last or (first == last and shares[0] < shares[-1]):
        return None
    if shares[0] == shares[-1]:
        # Points that were drawn since, all at one place of the stroke.
        where, delta, now = run.shares, run.moved, run.now
    else:
        where = np.concatenate([[first], here[(here > first) & (here < last)], [last]])
        delta, now = _interpolated(where, shares, moved), np.interp(where, shares, run.now[order])
    # Only what is on both frames tells how the stroke turns and grows.
    low, high = max(known[0], here[0]), min(known[-1], here[-1])
    samples = np.linspace(*((low, high) if low < high else (0, 1)), SAMPLES)
    factor = similarity(*(_interpolated(samples, *each) for each in ((known, was), (here, piece.pixels))), samples, where, piece.closed)
    points = _interpolated(where, here, piece.pixels) + factor * delta
    return _Line(points, where, now, piece, first - shares[0] < WHOLE, shares[-1] - last < WHOLE)


def _original(edit: Edit, number: int, before: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What there is of a stroke on the edited frame, as it was: shares and complex pixels."""
    mine = np.flatnonzero(edit.content.point[gp.LINE] == number)
    along = edit.content.point[gp.ALONG][mine].astype(np.float64)
    order = np.argsort(along, kind="stable")
    return along[order], before[mine][order]


def _interpolated(where: np.ndarray, known: np.ndarray, values: np.ndarray) -> np.ndarray:
    return np.interp(where, known, values.real) + 1j * np.interp(where, known, values.imag)


def _like(content: st.Content, base: _Piece, where: np.ndarray, points: np.ndarray) -> st.Content:
    """A stroke with the attributes of the piece `base`, at shares of the stroke's length."""
    made = st.Content(np.array([len(points)], np.int32), content.types[base.index : base.index + 1].copy())
    made.kinds = dict(content.kinds)
    near = np.clip(np.searchsorted(base.shares, where), 0, len(base.points) - 1)
    for name, values in content.point.items():
        own = values[base.points]
        if values.dtype.kind == "f":
            columns = own.reshape(len(own), -1)
            blended = np.stack([np.interp(where, base.shares, columns[:, k]) for k in range(columns.shape[1])], 1)
            made.point[name] = blended.reshape((len(where), *own.shape[1:])).astype(values.dtype)
        else:
            made.point[name] = own[near]
    made.point["position"] = points
    for name, values in content.curve.items():
        made.curve[name] = values[base.index : base.index + 1].copy()
    return made


def _assembled(content: st.Content, gone: np.ndarray, made: list[tuple[int, st.Content]], slots: marks.Slots, known: np.ndarray) -> st.Content:
    """The content without the strokes `gone`, with new strokes at the places that they take. The looks of new ones are noted where what was there has a
    `known` look."""
    stay = np.flatnonzero(~gone)
    places = [(float(i), 0, k) for k, i in enumerate(stay)]
    places += [(float(place), 1 + k, len(stay) + k) for k, (place, _) in enumerate(made)]
    whole = st.chosen(content, stay)
    for _, each in made:
        whole = st.joined(whole, each)
    if not made:
        return whole
    order = np.array([k for *_, k in sorted(places)])
    result = st.chosen(whole, order)
    note = np.array([False] * len(stay) + [bool(known[place]) for place, _ in made])
    dr.mark_looks(result, slots, note[order])
    return result

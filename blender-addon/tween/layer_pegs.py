"""Pegs from Blender's layers: each layer group, and by choice each layer, moves as one between two keys.

Pegs have the hierarchy of the groups. A peg's movement from key to key is the similarity that fits the matched strokes of its own
layers best. A group without layers of its own moves with its parent. If each layer is a peg, the layer with the longest strokes
leads its group: if the group followed the mean of its layers, no layer would move as it is drawn. A peg's pivot is its joint, the
point that moves least relative to the parent. A peg without a parent turns about that point if the drawing shows it, as the shoulder of an
arm. Strokes change their shape in the peg's frame.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from rototoon import tween

from ..blender import grease_pencil as gp
from ..blender import hierarchy
from .sheets import Laid, Sheet

SAMPLES = 24
"""Number of points per stroke that are compared."""
SCALES = (0.05, 20.0)
"""Least and greatest scale from one key to the next."""
FAR = 4.0
"""Largest distance of a group's pivot from its middle, in sizes of the group."""
NEAR, END, LONG = 0.35, 0.7, 0.35
"""A pivot is a joint at this distance of the strokes at most, and from their middle at least, in root mean square distances of the strokes from
their middle, where the logarithm of the ratio of their length and width is at least this."""
STIFF = 1e-4
"""Weight that pulls a pivot to the middle if nothing turns."""

Path = tuple[str, ...]


@dataclass(frozen=True)
class Similarity:
    """The map z ↦ factor · z + shift on complex numbers. `turn` is the angle of `factor` and may exceed half a turn."""

    factor: complex = 1.0
    shift: complex = 0.0
    turn: float = 0.0

    def after(self, other: Similarity) -> Similarity:
        """The map that applies `other` first and then this one."""
        shift = self.factor * other.shift + self.shift
        return Similarity(self.factor * other.factor, shift, self.turn + other.turn)

    def inverse(self) -> Similarity:
        """The inverse map."""
        return Similarity(1 / self.factor, -self.shift / self.factor, -self.turn)


@dataclass
class Peg:
    """A peg's movement relative to its parent."""

    name: str
    parent: str | None
    pivot: complex
    poses: dict[int, tuple[float, float, complex]]
    """By key: turn in radians, scale, and shift of the pivot."""


def paths_of(ob, layers: list[str], which: str) -> list[Path]:
    """For each layer the names of its pegs, the outermost first."""
    found = []
    for name in layers:
        path = [f"group {group}" for group in hierarchy.groups_of(gp.find_layer(ob, name))]
        found.append((*path, f"layer {name}") if which == "LAYERS" else tuple(path))
    return found


def options(sheet: Sheet, laid: Laid, span: int, progress: tween.Progress | None, threads: int) -> dict[str, Any]:
    """The options `pegs` and `hung` of the library for one span of a sheet."""
    matches = tween.match_strokes(laid.drawings, progress, threads=threads)
    made = pegs(sheet, laid, span, np.asarray(matches.offsets), _rows(matches), np.asarray(matches.values).reshape(-1, 2))
    paths = sheet.pegs_of(span)
    total = len(np.asarray(laid.drawings.strokes.offsets)) - 1
    hung: list[str | None] = [None] * total
    for (key, layer), first in laid.first_stroke.items():
        if key in sheet.contents and paths[layer]:
            count = len(sheet.contents[key][layer].sizes)
            hung[first : first + count] = [_name(paths[layer])] * count
    return {"pegs": [_written(peg, sheet, span) for peg in made], "hung": hung}


def _rows(matches: tween.Matches) -> np.ndarray:
    return np.asarray(matches.rows).reshape(-1, 4)


def _name(path: Path) -> str:
    return "/".join(path)


def pegs(sheet: Sheet, laid: Laid, span: int, offsets, rows, values) -> list[Peg]:
    """The pegs of a sheet's layers around a span, parents before children. They are at rest on the span's first key."""
    paths = sheet.pegs_of(span)
    every = sorted({path[:k] for path in paths for k in range(1, len(path) + 1)}, key=lambda path: (len(path), path))
    around = sheet.around(span)
    worlds: dict[Path, dict[int, Similarity]] = {(): dict.fromkeys(around, Similarity())}
    made = []
    for path in every:
        own = _own(path, paths, sheet, laid, span)
        inner = [k for k, each in enumerate(paths) if each[: len(path)] == path]
        above = worlds[path[:-1]]
        steps = {}
        for key in around[:-1]:
            found = slice(offsets[key], offsets[key + 1])
            step = _step(*_points(sheet, laid, key, own, rows[found], values[found]))
            steps[key] = step or above[key + 1].after(above[key].inverse())
        world = worlds[path] = _chained(steps, span, around)
        local = {key: above[key].inverse().after(world[key]) for key in around}
        drawn = _drawn(sheet, laid, span, inner)
        middle = complex(drawn.mean()) if len(drawn) else 0j
        pivot = _pivot(local[span + 1], middle)
        if abs(pivot - middle) > FAR * float(np.abs(drawn - middle).max(initial=0.0)):
            pivot = middle
        if len(path) == 1 and not _is_joint(pivot, drawn):
            # A drawing seldom shows the pivot of a peg without a parent. So go only part of the way, as with pegs that are found.
            pivot = middle + sheet.choices[span].arcs * (pivot - middle)
        poses = {key: (each.turn, abs(each.factor), each.factor * pivot + each.shift - pivot) for key, each in local.items()}
        made.append(Peg(_name(path), _name(path[:-1]) or None, pivot, poses))
    return made


def _own(path: Path, paths: list[Path], sheet: Sheet, laid: Laid, key: int) -> list[int]:
    """The layers that determine a peg's movement."""
    own = [k for k, each in enumerate(paths) if each == path]
    direct = [k for k, each in enumerate(paths) if each[:-1] == path]
    if own or not direct or sheet.choices[key].pegs != "LAYERS":
        return own
    return [max(direct, key=lambda layer: _length(sheet, laid, key, layer))]


def _length(sheet: Sheet, laid: Laid, key: int, layer: int) -> float:
    """Length of all strokes of a layer on a key."""
    strokes = laid.drawings.strokes
    offsets, points = np.asarray(strokes.offsets), np.asarray(strokes.points).reshape(-1, 2)
    first = laid.first_stroke[key, layer]
    numbers = range(first, first + len(sheet.contents[key][layer].sizes))
    lines = (points[offsets[k] : offsets[k + 1]] for k in numbers)
    return sum(float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum()) for line in lines)


def _points(sheet: Sheet, laid: Laid, key: int, layers: list[int], rows, values) -> tuple[np.ndarray, np.ndarray]:
    """Points of the matched strokes of some layers on a key and on the next one, as complex numbers."""
    offsets = np.asarray(laid.drawings.strokes.offsets)
    points = np.asarray(laid.drawings.strokes.points).reshape(-1, 2) @ [1, 1j]
    closed = np.asarray(laid.drawings.strokes.closed)
    wanted = set()
    for layer in layers:
        first = laid.first_stroke[key, layer]
        wanted |= set(range(first, first + len(sheet.contents[key][layer].sizes)))
    before, after = [np.zeros(0, complex)], [np.zeros(0, complex)]
    for (kind, i, j, flags), (start, _) in zip(rows.tolist(), values.tolist()):
        if kind != tween.PAIR or i not in wanted:
            continue
        one, other = (points[offsets[s] : offsets[s + 1]] for s in (i, j))
        if not len(one) or not len(other):
            continue
        shares = np.linspace(0, 1, SAMPLES, endpoint=not closed[i])
        theirs = -shares if flags & tween.REVERSED else shares
        theirs = (start + theirs) % 1.0 if closed[i] else (1.0 + theirs if flags & tween.REVERSED else theirs)
        before.append(_at(one, bool(closed[i]), shares))
        after.append(_at(other, bool(closed[j]), theirs))
    return np.concatenate(before), np.concatenate(after)


def _at(points: np.ndarray, closed: bool, shares: np.ndarray) -> np.ndarray:
    line = np.append(points, points[0]) if closed else points
    walked = np.append(0.0, np.cumsum(np.abs(np.diff(line))))
    if walked[-1] <= 0:
        return np.full(len(shares), line[0])
    places = shares * walked[-1]
    return np.interp(places, walked, line.real) + 1j * np.interp(places, walked, line.imag)


def _step(before: np.ndarray, after: np.ndarray) -> Similarity | None:
    """The similarity that fits points to other points best; `None` if there are too few."""
    if len(before) < 2:
        return None
    a, b = before - before.mean(), after - after.mean()
    spread = float((np.abs(a) ** 2).sum())
    factor = complex((a.conj() * b).sum() / spread) if spread > 1e-12 else 1.0
    size = min(max(abs(factor), SCALES[0]), SCALES[1])
    factor = factor / abs(factor) * size if factor else 1.0 + 0j
    return Similarity(factor, after.mean() - factor * before.mean(), float(np.angle(factor)))


def _chained(steps: dict[int, Similarity], span: int, around: range) -> dict[int, Similarity]:
    """The maps from the span's first key to each other key."""
    world = {span: Similarity()}
    for key in range(span, around[-1]):
        world[key + 1] = steps[key].after(world[key])
    for key in range(span - 1, around[0] - 1, -1):
        world[key] = steps[key].inverse().after(world[key + 1])
    return world


def _drawn(sheet: Sheet, laid: Laid, key: int, layers: list[int]) -> np.ndarray:
    """The points of some layers on a key, as complex numbers."""
    offsets = np.asarray(laid.drawings.strokes.offsets)
    points = np.asarray(laid.drawings.strokes.points).reshape(-1, 2) @ [1, 1j]
    found = [np.zeros(0, complex)]
    for layer in layers:
        first = laid.first_stroke[key, layer]
        found.append(points[offsets[first] : offsets[first + len(sheet.contents[key][layer].sizes)]])
    return np.concatenate(found)


def _is_joint(pivot: complex, drawn: np.ndarray) -> bool:
    """Whether a pivot is on the drawing, at the end of something long: a shoulder, or feet. The library does the same for pegs that it finds."""
    if not len(drawn):
        return False
    from_middle = drawn - drawn.mean()
    size = math.sqrt(float((np.abs(from_middle) ** 2).mean()))
    # The squares of length and width are size² (1 ± long) / 2.
    long = abs(complex((from_middle**2).mean())) / size**2 if size > 0 else 0.0
    ends = abs(pivot - complex(drawn.mean())) >= END * size
    return long >= math.tanh(LONG) and ends and float(np.abs(drawn - pivot).min()) <= NEAR * size


def _pivot(local: Similarity, middle: complex) -> complex:
    """The point that moves least; the middle if nothing turns."""
    change = local.factor - 1
    return (-np.conj(change) * local.shift + STIFF * middle) / (abs(change) ** 2 + STIFF)


def _written(peg: Peg, sheet: Sheet, span: int) -> dict[str, Any]:
    """The peg in the form of documents."""
    first, last = sheet.frames[span], sheet.frames[span + 1]
    choices = sheet.choices[span]
    if choices.spacing == "SMOOTH":
        frames = [first, *choices.frames(first, last), last]
        rows = _smooth(peg, sheet, span, np.array(frames, float))
        keys = [_key(frame, *row, "linear") for frame, row in zip(frames, rows)]
    else:
        keys = [_key(sheet.frames[k], *_row(peg.poses[k]), sheet.spacing(span)) for k in (span, span + 1)]
    hangs = {"parent": peg.parent} if peg.parent is not None else {}
    return {"name": peg.name, **hangs, "pivot": [peg.pivot.real, peg.pivot.imag], "keys": keys}


def _row(pose: tuple[float, float, complex]) -> tuple[float, float, float, float]:
    turn, scale, shift = pose
    return turn, math.log(scale), shift.real, shift.imag


def _key(frame: int, turn: float, growth: float, x: float, y: float, timing: Any) -> dict[str, Any]:
    scale = math.exp(growth)
    return {"frame": frame, "shift": [x, y], "turn": math.degrees(turn), "scale": scale, "timing": timing}


def _smooth(peg: Peg, sheet: Sheet, span: int, times: np.ndarray) -> np.ndarray:
    """Rows of a peg at some times of a span. The velocity is continuous at keys, and zero where a movement turns back."""
    at = {key: float(sheet.frames[key]) for key in peg.poses}
    rows = {key: np.array(_row(pose)) for key, pose in peg.poses.items()}
    secant = {k: (rows[k + 1] - rows[k]) / (at[k + 1] - at[k]) for k in rows if k + 1 in rows}
    rest = sheet.choices[span].rest

    def slope(key: int) -> np.ndarray:
        if key - 1 not in secant or key not in secant:
            return np.zeros(4) if rest else secant.get(key, secant.get(key - 1))
        one, other = secant[key - 1], secant[key]
        same = one * other > 0
        return np.where(same, 2 * one * other / np.where(same, one + other, 1.0), 0.0)

    length = at[span + 1] - at[span]
    u = ((times - at[span]) / length)[:, None]
    a, b, m, n = rows[span], rows[span + 1], slope(span) * length, slope(span + 1) * length
    eased = u * u * (3 - 2 * u)
    return a + (b - a) * eased + m * u * (1 - u) ** 2 - n * u * u * (1 - u)

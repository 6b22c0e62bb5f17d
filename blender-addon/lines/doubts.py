"""Which traced strokes are in doubt, and where.

Tracing gives each carried stroke a confidence: the probability that it is the stroke of its number. Points keep it as
`rototoon_confidence`, all points of a stroke the same. Whether a stroke is sure, doubtful or lost comes from the core's formula, which
the command line and the tracks of contours use too.

A drawing that the artist has changed is the artist's, and so beyond doubt: but where its picture was drawn anew, and its strokes lie on no line of
it, they are doubtful (see `off_ink`).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from rototoon.lines import doubts

from ..blender import grease_pencil as gp
from ..blender import strokes as st
from ..common.wording import listed
from . import drawings as dr

SURE, DOUBTFUL, LOST = 0, 1, 2
"""What a stroke is."""


@dataclass(frozen=True, order=True)
class Place:
    """A stroke that is in doubt on a frame."""

    frame: int
    """Scene frame."""
    layer: str
    number: int
    """The stroke's number on the layer."""
    index: int
    """Its index in the drawing."""
    lost: bool
    """Whether it is probably another stroke."""
    off: bool = False
    """Whether it is a stroke of the artist that lies on no line of the picture."""


@dataclass(frozen=True)
class Doubt:
    """A stroke that is in doubt somewhere. Frames rise."""

    layer: str
    number: int
    doubtful: tuple[int, ...]
    """Scene frames on which a look at it is worth while."""
    lost: tuple[int, ...]
    """Scene frames on which it is probably another stroke."""

    @property
    def first(self) -> int:
        """The first frame on which it is in doubt."""
        return min((*self.doubtful, *self.lost))

    def __str__(self) -> str:
        """What a person is told."""
        texts = [f"{what} on {listed(list(frames))}" for what, frames in (("doubtful", self.doubtful), ("lost", self.lost)) if frames]
        return f"Stroke {self.number}: {', '.join(texts)}"


def verdicts(confidence: Iterable[float]) -> np.ndarray:
    """What strokes with these confidences are. What is no number is lost."""
    values = np.nan_to_num(np.clip(np.asarray(list(confidence), np.float64), 0, 1), nan=0.0)
    return np.array(_verdicts(values.tobytes()), np.int64)


@lru_cache(maxsize=16)
def _verdicts(values: bytes) -> tuple[int, ...]:
    """`verdicts` of float64 values. The 3D view asks for the same ones whenever it is drawn, so they are kept."""
    found = [SURE] * (len(values) // 8)
    for doubt in doubts({k: {0: value} for k, value in enumerate(np.frombuffer(values).tolist())}):
        found[doubt.track] = LOST if doubt.lost else DOUBTFUL
    return tuple(found)


def of_strokes(values: np.ndarray | None, starts: np.ndarray) -> np.ndarray:
    """The confidence of each stroke: the mean of its points. Without values, and without points, it is 1."""
    found = np.ones(len(starts) - 1)
    if values is None:
        return found
    sizes = np.diff(starts)
    sums = np.concatenate([[0.0], np.cumsum(np.nan_to_num(values.astype(np.float64), nan=0.0))])
    some = sizes > 0
    found[some] = (sums[starts[1:]] - sums[starts[:-1]])[some] / sizes[some]
    return found


def places(ob) -> list[Place]:
    """All strokes of an object that are in doubt, by frame, layer and number."""
    names = [layer.name for layer in st.drawn_layers(ob, active=False) if dr.is_lines(layer)]
    found = []
    for layer in dr.read(ob, names, None):
        for frame, content in layer.made.items():
            tracks = content.strokes(gp.TRACK)
            verdict = verdicts(of_strokes(content.point.get(gp.CONFIDENCE), content.starts))
            found += [Place(frame, layer.name, int(tracks[i]), int(i), bool(verdict[i] == LOST)) for i in np.flatnonzero(verdict)]
        for frame, content in layer.keys.items():
            tracks = content.strokes(gp.TRACK)
            found += [Place(frame, layer.name, int(tracks[i]), int(i), False, True) for i in np.flatnonzero(content.strokes(gp.OFF_INK))]
    return sorted(found)


def summed(found: Iterable[Place]) -> list[Doubt]:
    """The strokes of some places, by layer and number."""
    by_stroke: dict[tuple[str, int], tuple[list[int], list[int]]] = {}
    for place in sorted(found):
        by_stroke.setdefault((place.layer, place.number), ([], []))[place.lost].append(place.frame)
    return [Doubt(layer, number, tuple(a), tuple(b)) for (layer, number), (a, b) in sorted(by_stroke.items())]


def after(found: list[Place], frame: int, layer: str, number: int) -> Place | None:
    """The place behind a stroke on a frame, or the first one behind the last. `None` if there is none."""
    later = (place for place in found if (place.frame, place.layer, place.number) > (frame, layer, number))
    return next(later, found[0] if found else None)


def told(confidence: Mapping[tuple[str, int], Mapping[int, float]]) -> str:
    """What a run of tracing says of the strokes that it has drawn, by layer and number; empty if all are sure."""
    keys = sorted(confidence)
    found = doubts({k: confidence[key] for k, key in enumerate(keys)})
    if not found:
        return ""
    lost = sum(bool(doubt.lost) for doubt in found)
    strokes = "1 stroke is" if len(found) == 1 else f"{len(found)} strokes are"
    probably = f", {lost} of them probably wrong" if lost else ""
    return f"{strokes} in doubt{probably}: press Next Doubtful Stroke"

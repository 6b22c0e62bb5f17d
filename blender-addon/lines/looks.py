"""How traced strokes look: like the artist's strokes of the same number, otherwise like the ink.

A stroke of the artist gives material, radius, opacity, colours, caps and attributes of the artist's own. Values of points are taken at the same share of the length,
and blended in time between two drawings of the artist. Other strokes get the width of the ink as radius, opacity 1, and a material of
the ink's colour.
"""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass, field

import bpy
import numpy as np

from ..blender import grease_pencil as gp
from ..blender import line_materials, own_attributes
from ..blender import strokes as st
from ..capture.contours import CURVE_STYLE, POINT_STYLE
from .drawings import shares

SAME_INK = 0.08
"""Greatest distance of two inks that share a material, in OKLab (Ottosson 2020) with a fifth of the lightness: thin and faint lines of
one ink differ in lightness only."""
LIGHTNESS = 0.2
FEW = 0.03
"""Share of the length of all lines below which an ink that differs in lightness only is none: the ends of lines are often pale."""
_TO_LMS = np.array(
    [[0.4122214708, 0.5363325363, 0.0514459929], [0.2119034982, 0.6806995451, 0.1073969566], [0.0883024619, 0.2817188376, 0.6299787005]]
)
_TO_LAB = np.array(
    [[0.2104542553, 0.7936177850, -0.0040720468], [1.9779984951, -2.4285922050, 0.4505937099], [0.0259040371, 0.7827717662, -0.8086757660]]
)


@dataclass
class Source:
    """A stroke of the artist on one frame."""

    content: st.Content
    index: int
    shares: np.ndarray
    """Share of the stroke's length at each of its points, 0 to 1."""

    @property
    def span(self) -> slice:
        """Its points in the drawing's arrays."""
        starts = self.content.starts
        return slice(int(starts[self.index]), int(starts[self.index + 1]))


@dataclass
class Looks:
    """The artist's strokes by number and frame, on one layer."""

    sources: dict[int, dict[int, Source]] = field(default_factory=dict)

    def add(self, number: int, frame: int, content: st.Content, index: int) -> None:
        """Adds a stroke of the artist."""
        a, b = content.starts[index : index + 2]
        source = Source(content, index, shares(content.point["position"][a:b]))
        self.sources.setdefault(number, {}).setdefault(frame, source)

    def names(self) -> list[str]:
        """The attributes of a look that any of the strokes has."""
        have = {name for content in self._contents() for name in (*content.point, *content.curve)}
        return [name for name in (*POINT_STYLE, *CURVE_STYLE) if name in have]

    def own(self) -> dict[str, own_attributes.Kind]:
        """The artist's own attributes that any of the strokes has."""
        return own_attributes.first_of(_own_of(content) for content in self._contents())

    def _contents(self) -> list[st.Content]:
        """The drawings in the order of their frames."""
        by_frame = sorted(((frame, each.content) for own in self.sources.values() for frame, each in own.items()), key=lambda pair: pair[0])
        return list({id(content): content for _, content in by_frame}.values())

    def around(self, number: int, frame: int) -> tuple[Source, Source, float] | None:
        """The strokes at or before and after a frame, and the share of the way between them."""
        by_frame = self.sources.get(number)
        if not by_frame:
            return None
        frames = sorted(by_frame)
        after = bisect_right(frames, frame)
        if after == 0:
            return by_frame[frames[0]], by_frame[frames[0]], 0.0
        if after == len(frames):
            return by_frame[frames[-1]], by_frame[frames[-1]], 0.0
        before, after = frames[after - 1], frames[after]
        return by_frame[before], by_frame[after], (frame - before) / (after - before)


def sampled(source: Source, name: str, where: np.ndarray) -> np.ndarray:
    """The values of a point attribute at shares of the length."""
    values = source.content.point.get(name)
    if values is None:
        return gp.blank(name, len(where)).astype(np.float64)
    own = np.asarray(values[source.span], np.float64)
    if own.ndim == 1:
        return np.interp(where, source.shares, own)
    return np.stack([np.interp(where, source.shares, own[:, k]) for k in range(own.shape[1])], 1)


def of_points(found: tuple[Source, Source, float], name: str, where: np.ndarray) -> np.ndarray:
    """The values of a point attribute, blended between two strokes of the artist."""
    before, after, share = found
    values = sampled(before, name, where)
    if share == 0.0:
        return values
    return values * (1 - share) + sampled(after, name, where) * share


def of_stroke(source: Source, name: str):
    """The value of a stroke attribute."""
    return source.content.strokes(name)[source.index]


def of_own(found: tuple[Source, Source, float], name: str, kind: own_attributes.Kind, where: np.ndarray):
    """The values of one of the artist's own attributes: of points at shares of the length, or one of the stroke."""
    before, after, share = found
    values = _own_of_source(before, name, kind, where)
    if share == 0.0 or not own_attributes.is_blended(values):
        return values
    return values * (1 - share) + _own_of_source(after, name, kind, where) * share


def _own_of_source(source: Source, name: str, kind: own_attributes.Kind, where: np.ndarray):
    points = kind[1] == "POINT"
    if _own_of(source.content).get(name) != kind:
        return gp.blank(name, len(where) if points else 1, kind[0])
    if not points:
        return source.content.curve[name][source.index : source.index + 1]
    values = source.content.point[name][source.span]
    if own_attributes.is_blended(values):
        return sampled(source, name, where)
    # The nearest point, the earlier one of two.
    middles = (source.shares[1:] + source.shares[:-1]) / 2
    return values[np.searchsorted(middles, where)]


def _own_of(content: st.Content) -> dict[str, own_attributes.Kind]:
    sides = ((content.point, "POINT"), (content.curve, "CURVE"))
    return {name: (content.kinds[name], domain) for side, domain in sides for name in side if own_attributes.is_own(name)}


def ink_lab(colour: np.ndarray) -> np.ndarray:
    """sRGB colours (N, 3) as OKLab, with a fifth of the lightness."""
    c = np.nan_to_num(np.asarray(colour, np.float64)).clip(0, 1)
    linear = line_materials.to_linear(c)
    lab = np.cbrt(linear @ _TO_LMS.T) @ _TO_LAB.T
    return lab * np.array([LIGHTNESS, 1.0, 1.0])


def inks(colours: np.ndarray, lengths: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The ink of each stroke: its index, and the colour of each ink (K, 3).

    The longest stroke begins the first ink. A stroke that is not near any ink begins another one.
    """
    lab, found = ink_lab(colours), np.zeros(len(colours), int)
    centres: list[int] = []
    for i in np.argsort(-lengths, kind="stable"):
        away = [float(np.linalg.norm(lab[i] - lab[c])) for c in centres]
        if away and min(away) <= SAME_INK:
            found[i] = int(np.argmin(away))
        else:
            found[i] = len(centres)
            centres.append(int(i))
    totals = np.bincount(found, lengths, len(centres))
    main = np.flatnonzero(totals >= FEW * totals.sum())
    for k in np.flatnonzero(totals < FEW * totals.sum()):
        away = np.linalg.norm((lab[centres] - lab[centres[k]])[main, 1:], axis=1)
        if len(main) and away.min() <= SAME_INK:
            found[found == k] = main[int(np.argmin(away))]
    used, found = np.unique(found, return_inverse=True)
    return found, np.asarray(colours, np.float64)[centres].reshape(-1, 3)[used]


EXACT = 0.002
"""Greatest difference of the values of a colour that is the same one."""


def exact_material(ob: bpy.types.Object, colour: np.ndarray, fill: bool = False, make: bool = True) -> int | None:
    """Index of the object's material for just this colour, sRGB. If there is none it is made, or, without `make`, `None`."""
    for place, known in line_materials.known(ob, fill):
        if np.abs(known - colour).max() <= EXACT:
            return place
    return line_materials.make(ob, np.nan_to_num(colour).clip(0, 1), fill) if make else None


def filled_material(ob: bpy.types.Object, line: np.ndarray, fill: np.ndarray) -> int:
    """Index of the object's material for a line and its fill, sRGB. It is made if there is none."""
    return line_materials.with_fill(ob, *(np.nan_to_num(colour).clip(0, 1) for colour in (line, fill)), EXACT)


def material(ob: bpy.types.Object, colour: np.ndarray, fill: bool = False) -> int:
    """Index of the object's material for an ink, sRGB, or for a shape that is filled with it. It is made if none is near."""
    wanted = ink_lab(colour[None])[0]
    for place, known in line_materials.known(ob, fill):
        if np.linalg.norm(ink_lab(known[None])[0] - wanted) <= SAME_INK:
            return place
    return line_materials.make(ob, np.nan_to_num(colour).clip(0, 1), fill)

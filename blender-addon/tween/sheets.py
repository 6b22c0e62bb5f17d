"""Sheets: drawings of consecutive keys, laid out for the library.

Layers with the same keys share a sheet, so that lines and the colours on a layer below them move as one. A blank key ends a sheet.
Points are in the plane of the first drawing, at a scale that makes it about a thousand pixels large. The distance from the plane is
blended. So the view does not matter.
"""

from __future__ import annotations

import hashlib
import itertools
import json
import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from rototoon import Strokes, tween

from ..blender import colours, drawn_plane
from ..blender import grease_pencil as gp
from ..blender import strokes as st
from ..blender.seen import Seen
from . import breakdowns, pairs
from . import keys as ks
from .charts import Choices

SIZE = 1000.0
"""Length of a drawing's larger side in pixels, within a factor of √2."""
VERSION = 1
"""It changes when the same drawings give other in-betweens."""


@dataclass
class Plane:
    """The plane of a sheet, and the mapping of layer points to it."""

    axes: np.ndarray
    """(3, 3): the directions right, down, and away from the plane."""
    scale: float
    to_sheet: list[np.ndarray]
    """For each layer 4×4, to the space of the sheet."""
    corner: np.ndarray = field(default_factory=lambda: np.zeros(2))
    """The sheet's origin, in pixels of the plane."""

    @classmethod
    def of(cls, drawings: Iterable[np.ndarray], to_sheet: list[np.ndarray]) -> Plane:
        """The plane of the first drawing, or of more if that is a line. It is rounded, so that it stays the same when a point is
        moved.

        Drawings are points (N, 3) in the space of the sheet. The first one's size is a thousand pixels.
        """
        finite = (points[np.isfinite(points).all(1)] for points in drawings)
        points = next(finite)
        normal = np.round(drawn_plane.normal(itertools.chain([points], finite)) * 32)
        normal = normal / np.linalg.norm(normal) if normal.any() else drawn_plane.FRONT
        extent = float(np.ptp(points, axis=0).max()) if len(points) else 0.0
        scale = 2.0 ** round(math.log2(SIZE / extent)) if 1e-9 < extent < 1e9 else 1.0
        return cls(drawn_plane.axes(normal), scale, to_sheet)

    def flat(self, points: np.ndarray, layer: int) -> tuple[np.ndarray, np.ndarray]:
        """Pixels (N, 2) of layer points, and their distances (N,) from the plane."""
        return self.laid(points, self.to_sheet[layer])

    def laid(self, points: np.ndarray, to: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The same for points in any space. `to` is 4×4, to the space of the sheet."""
        local = (points.astype(np.float64) @ to[:3, :3].T + to[:3, 3]) @ self.axes.T
        return local[:, :2] * self.scale - self.corner, local[:, 2]

    def back(self, pixels: np.ndarray, away: np.ndarray, layer: int) -> np.ndarray:
        """Layer points (..., N, 3) of pixels (..., N, 2) and distances (..., N) or 0."""
        inverse = np.linalg.inv(self.to_sheet[layer])
        axes = self.axes @ inverse[:3, :3].T
        placed = (pixels + self.corner if self.corner.any() else pixels).astype(np.float32)
        points = placed @ (axes[:2] / self.scale).astype(np.float32)
        if np.any(away):
            points += np.asarray(away, np.float32)[..., None] * axes[2].astype(np.float32)
        if inverse[:3, 3].any():
            points += inverse[:3, 3].astype(np.float32)
        return points

    def text(self) -> bytes:
        """Everything that a digest must contain of it."""
        corner = [self.corner] if self.corner.any() else []
        every = (self.axes, np.array(self.scale), *self.to_sheet, *corner)
        return b"".join(np.round(each, 6).tobytes() for each in every)


@dataclass
class Contour:
    """A captured contour on the sheet that strokes may follow."""

    closed: bool
    first: int
    """The frame of its first row."""
    points: np.ndarray
    """Pixels (frames, N, 2), from the first frame on."""

    def written(self) -> dict[str, Any]:
        """The contour as the library takes it."""
        return {"closed": self.closed, "first": self.first, "contours": self.points.tolist()}

    def text(self) -> bytes:
        """Everything that a digest must contain of it."""
        return repr((self.closed, self.first, self.points.shape)).encode() + self.points.tobytes()


@dataclass
class Sheet:
    """Consecutive keys of one or more layers."""

    layers: list[str]
    frames: list[int]
    plane: Plane
    wanted: dict[int, Choices]
    """The choices of the spans to draw, by the index of the earlier key."""
    choices: list[Choices]
    """The choices of all spans."""
    contents: dict[int, list[st.Content]] = field(default_factory=dict)
    """By key and layer, as far as needed."""
    digests: dict[int, str] = field(default_factory=dict)
    """By span the digest of everything on which it depends."""
    pegs: dict[str, list[tuple[str, ...]]] = field(default_factory=dict)
    """By choice, for each layer the names of its pegs, the outermost first."""
    size: tuple[float, float] | None = None
    """Width and height of the picture, if strokes leave it. Its corner is the sheet's origin."""
    captured: dict[int, list[Contour]] = field(default_factory=dict)
    """By span the contours that its strokes may follow."""

    def around(self, span: int) -> range:
        """The keys on which a span depends."""
        smooth = int(self.choices[span].spacing == "SMOOTH")
        return range(max(span - smooth, 0), min(span + 1 + smooth, len(self.frames) - 1) + 1)

    def spacing(self, span: int):
        """The spacing of a span, as the library takes it."""
        return self.choices[span].written(self.frames[span], self.frames[span + 1])

    def pegs_of(self, span: int) -> list[tuple[str, ...]]:
        """For each layer the names of its pegs; an empty list if pegs are found."""
        return self.pegs.get(self.choices[span].pegs, [])

    def leaving(self, span: int):
        """The library's option `leaving` of a span."""
        found = self.choices[span].leaving
        return {"leave": list(self.size)} if found == "LEAVE" else found.lower()

    def given(self, span: int) -> list[list[tuple[int, int]]]:
        """For each layer the pairs that need not be found: the artist's, and those of carried strokes."""
        return [pairs.given(a, b) for a, b in zip(self.contents[span], self.contents[span + 1])]

    def read(self, ob, marks: dict[str, dict[int, breakdowns.Marks]], seen: Seen) -> None:
        """Reads the drawings for the wanted spans, and makes the digest of each span. `marks` are those that `finish` will write, by layer and
        frame. What was read is noted in `seen`."""
        drawings = [gp.drawings(gp.find_layer(ob, name)) for name in self.layers]
        for key in sorted({key for span in self.wanted for key in self.around(span)}):
            self.contents[key] = [st.read(each[self.frames[key]][0]) for each in drawings]
            for name, content in zip(self.layers, self.contents[key]):
                seen.note(name, self.frames[key], content)
                if self.frames[key] in marks[name]:
                    for attribute, values in marks[name][self.frames[key]].values().items():
                        content.set_strokes(attribute, values)
        sums = {key: b"".join(map(ks.digest, each)) for key, each in self.contents.items()}
        materials = colours.palette(ob).tobytes()
        for span, choices in self.wanted.items():
            around = self.around(span)
            summed = hashlib.blake2b(self.plane.text() + materials, digest_size=16)
            for key in around:
                summed.update(sums[key])
            told = [VERSION, self.layers, [self.frames[key] for key in around], choices.shared()]
            told += [self.spacing(key) for key in around[:-1]] + [self.given(key) for key in around[:-1]]
            told.append(choices.frames(self.frames[span], self.frames[span + 1]))
            # Newer choices are added only where they matter, so that digests of earlier versions stay valid.
            told += [self.pegs_of(span)] if self.pegs_of(span) else []
            told += [self.size] if choices.leaving == "LEAVE" else []
            summed.update(json.dumps(told).encode())
            for contour in self.captured.get(span, ()):
                summed.update(contour.text())
            self.digests[span] = summed.hexdigest()


@dataclass
class Laid:
    """The arrays of a sheet, as the library takes them."""

    drawings: tween.Drawings
    first_stroke: dict[tuple[int, int], int]
    """By key and layer the index of the first stroke."""
    away: np.ndarray
    """For each point the distance from the plane."""
    rows: np.ndarray
    """For each point its index in its drawing."""


def lay_out(ob, sheet: Sheet) -> Laid:
    """The arrays of a sheet. Strokes with points that are not finite get no points."""
    columns = {name: [] for name in ("sizes", "points", "closed", "colours", "labels", "away", "rows")}
    first, bounds, strokes = {}, [0], 0
    materials = colours.palette(ob)
    for key in range(len(sheet.frames)):
        for layer, content in enumerate(sheet.contents.get(key, ())):
            first[key, layer] = strokes
            count = len(content.sizes)
            strokes += count
            fine = content.finite()
            some = np.repeat(fine, content.sizes)
            pixels, away = sheet.plane.flat(content.point["position"][some], layer)
            columns["sizes"].append(np.where(fine, content.sizes, 0))
            columns["points"].append(pixels)
            columns["away"].append(away)
            columns["rows"].append(np.flatnonzero(some))
            columns["closed"].append(content.strokes("cyclic"))
            columns["colours"].append(colours.of_strokes(ob, content, materials))
            columns["labels"].append(np.stack([content.strokes("material_index"), np.full(count, layer)], 1))
        bounds.append(strokes)
    empty = {"points": (0, 2), "colours": (0, 3), "labels": (0, 2)}
    joined = {
        name: np.concatenate(each) if each else np.zeros(empty.get(name, 0)) for name, each in columns.items()
    }
    given = _given(sheet, first)
    drawings = tween.Drawings(
        Strokes(
            np.concatenate([[0], np.cumsum(joined["sizes"])]).astype(np.int32),
            np.ascontiguousarray(joined["points"], np.float64),
            joined["closed"].astype(np.uint8),
        ),
        np.array(bounds, np.int32),
        np.array(sheet.frames, np.int32),
        np.ascontiguousarray(joined["colours"], np.float64),
        np.ascontiguousarray(joined["labels"], np.int32),
        np.array(given, np.int32).reshape(-1, 2),
    )
    return Laid(drawings, first, joined["away"], joined["rows"].astype(np.int64))


def _given(sheet: Sheet, first: dict[tuple[int, int], int]) -> list[list[int]]:
    """The given pairs of all spans, by the strokes' indices in the sheet."""
    given = []
    for span in range(len(sheet.frames) - 1):
        if span in sheet.contents and span + 1 in sheet.contents:
            for layer, found in enumerate(sheet.given(span)):
                starts = first[span, layer], first[span + 1, layer]
                given += [[i if i < 0 else i + starts[0], j if j < 0 else j + starts[1]] for i, j in found]
    return given

"""Where the points of a drawing lie for the new footage.

A point has a pixel of the old picture, and this pixel has a place in the new one. The point goes to the ray of that place. On the plane of the
drawing it stays on it. Off the plane it keeps its distance: along the ray if rays are parallel, and as a share of the plane's distance through a
perspective camera.

Radii grow as a pixel of the old picture does. Pixels that strokes keep, such as where Paint Bucket was clicked, are placed as pixels.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from rototoon import Conformed

from ..blender import camera as cameras
from ..blender import grease_pencil as gp
from ..blender import strokes as st
from ..blender.placement import Mapper

STILL = 1e-3
"""Pixels. A drawing whose points all move by less stays as it is, to the last bit: single precision is not finer in a large picture."""
PLACES = (gp.TRACKED, "handle_left", "handle_right")
"""Attributes of points that are places, beside their own."""
PIXELS = (gp.CENTER, gp.CLICK)
"""Attributes of strokes that are pixels (x, y, 1), or (0, 0, 0)."""


class Placing:
    """The places of an object's layers in the new footage. Changes nothing."""

    def __init__(self, ob, names: list[str], points: dict[int, np.ndarray], frames: Iterable[int], new_frames: Iterable[int], found: Conformed, size: tuple[int, int]):
        """`points` are the artist's by the index of the layer; they show the plane on which the artist drew. `size` is that of the new pictures."""
        self._names, self._found = names, found
        self._old = Mapper(ob, frames, points, names)
        self._new = Mapper(ob, new_frames, points, names, size)
        self.still = self._old.still
        """Whether a drawing is placed in the same way on each frame."""

    def changed(self, name: str, content: st.Content, frame: int, new: int) -> dict[str, np.ndarray]:
        """The attributes of a drawing that have other values on the new frame. There are none if it is in its place already."""
        index = self._names.index(name)
        one, other = self._old.at(index, frame), self._new.at(index, new)
        moved = self._pixels(content)
        if not len(content.sizes):
            return moved
        points = content.point["position"]
        placed = self._placed(points, one, other)
        if self._is_still(points, other, one):
            return moved
        moved["position"] = placed
        for each in PLACES:
            if each in content.point:
                values = self._placed(content.point[each], one, other)
                # A point that is where tracking put it is so afterwards too.
                same = (content.point[each] == points).all(1)
                moved[each] = np.where(same[:, None], placed, values)
        if "radius" in content.point:
            moved["radius"] = (content.point["radius"] * self._growth(points, one, other)).astype(np.float32)
        return moved

    def _pixels(self, content: st.Content) -> dict[str, np.ndarray]:
        moved = {}
        for name in PIXELS:
            values = content.curve.get(name)
            if values is not None and (values[:, 2] != 0).any():
                places = self._place(values[:, :2].astype(np.float64))
                new = np.where(values[:, 2:] != 0, np.concatenate([places, values[:, 2:]], 1), values).astype(np.float32)
                if not np.array_equal(new, values):
                    moved[name] = new
        return moved

    def _place(self, pixels: np.ndarray) -> np.ndarray:
        return pixels * self._found.scale + np.array(self._found.shift)

    def _is_still(self, points: np.ndarray, other: cameras.Mapping, one: cameras.Mapping) -> bool:
        fine = points[np.isfinite(points).all(1)]
        if not len(fine):
            return True
        away = other.to_pixels(fine) - self._place(one.to_pixels(fine))
        return bool(np.abs(away).max() < STILL)

    def _placed(self, points: np.ndarray, one: cameras.Mapping, other: cameras.Mapping) -> np.ndarray:
        """Points in layer space, as they will lie. One without a place keeps what it has."""
        result, fine = np.array(points, np.float32), np.isfinite(points).all(1)
        if not fine.any():
            return result
        points = points[fine].astype(np.float64)
        pixels = one.to_pixels(points)
        before, after = one.to_layer(pixels), other.to_layer(self._place(pixels))
        own, plane, view = (_in_view(each, mapping) for each, mapping in ((points, one), (before, one), (after, other)))
        if one.view.perspective:
            view *= (own[:, 2] / plane[:, 2])[:, None]
        else:
            view[:, 2] += own[:, 2] - plane[:, 2]
        result[fine] = view @ other.from_view[:3, :3].T + other.from_view[:3, 3]
        return result

    def _growth(self, points: np.ndarray, one: cameras.Mapping, other: cameras.Mapping) -> np.ndarray:
        """By how much lengths in layer space grow at each point."""
        growth, fine = np.ones(len(points)), np.isfinite(points).all(1)
        if fine.any():
            pixels = one.to_pixels(points[fine])
            before = _pixel(one, pixels, 1.0)
            growth[fine] = _pixel(other, self._place(pixels), self._found.scale) / np.maximum(before, 1e-30)
        return growth


def _in_view(points: np.ndarray, mapping: cameras.Mapping) -> np.ndarray:
    return points @ mapping.to_view[:3, :3].T + mapping.to_view[:3, 3]


def _pixel(mapping: cameras.Mapping, pixels: np.ndarray, length: float) -> np.ndarray:
    """The length in layer space of some pixels' length across and down, at each of `pixels`: the root of the area."""
    here = mapping.to_layer(pixels)
    across, down = (mapping.to_layer(pixels + step) - here for step in ((length, 0.0), (0.0, length)))
    return np.sqrt(np.linalg.norm(np.cross(across, down), axis=1))

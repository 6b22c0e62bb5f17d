"""Strokes that are written into a drawing: their numbers of points, and their attributes as complete arrays.

Whoever generates strokes makes `Rows` of them. `replace_made` puts them in the place of a drawing's generated strokes, and `append` behind all strokes. The
artist's strokes stay as they are, below the generated ones. An attribute that the drawing does not have yet is made, with the default value on the
strokes that were there.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import bpy
import numpy as np

from . import grease_pencil as gp


@dataclass
class Rows:
    """Strokes to write into one drawing: their sizes, and their attributes by name."""

    sizes: np.ndarray
    values: dict[str, np.ndarray] = field(default_factory=dict)
    own: dict[str, tuple[str, str]] = field(default_factory=dict)
    """Data type and domain of attributes that are not in `TYPES` (see `own_attributes`)."""


def has_made(drawing: bpy.types.bpy_struct, rows: Rows) -> bool:
    """Whether the generated strokes of a drawing equal `rows`."""
    starts, made = _made(drawing)
    return _fits(starts, made, rows) and _holds(drawing, rows, len(made) - len(rows.sizes), starts)


def _made(drawing: bpy.types.bpy_struct) -> tuple[np.ndarray, np.ndarray]:
    starts = gp.offsets(drawing)
    return starts, gp.value(drawing, gp.MADE, len(starts) - 1)


def _fits(starts: np.ndarray, made: np.ndarray, rows: Rows) -> bool:
    """Whether generated strokes have the numbers of points of `rows`, and are the last strokes."""
    count = len(rows.sizes)
    first = len(made) - count
    return bool(made.sum() == count and made[first:].all() and np.array_equal(np.diff(starts)[first:], rows.sizes))


def replace_made(drawing: bpy.types.bpy_struct, rows: Rows) -> None:
    """Replaces all generated strokes by `rows`. The artist's strokes stay as they are, below them."""
    starts, made = _made(drawing)
    if not _fits(starts, made, rows):
        if made.any():
            drawing.remove_strokes(indices=np.flatnonzero(made).tolist())
        if len(rows.sizes):
            drawing.add_strokes(rows.sizes.tolist())
    _write_tail(drawing, rows)


def _holds(drawing: bpy.types.bpy_struct, rows: Rows, first: int, starts: np.ndarray) -> bool:
    """Whether the strokes from `first` on equal `rows`."""
    for name, values in rows.values.items():
        if name in rows.own and gp.has(drawing, name) and not _is_of(drawing, name, rows.own[name]):
            continue
        if not gp.has(drawing, name):
            return False
        curve = name != "position" and gp.domain(drawing, name) == "CURVE"
        found = gp.get(drawing, name, len(starts) - 1 if curve else int(starts[-1]))
        if found is None:
            return False
        found = found[first if curve else starts[first] :]
        if not np.array_equal(found, np.asarray(values).astype(found.dtype)):
            return False
    return True


def _is_of(drawing: bpy.types.bpy_struct, name: str, kind: tuple[str, str]) -> bool:
    """Whether an attribute that a drawing has is of a data type and a domain."""
    attribute = drawing.attributes[name]
    return (attribute.data_type, attribute.domain) == kind


def append(drawing: bpy.types.bpy_struct, rows: Rows) -> None:
    """Adds strokes after the existing ones."""
    if len(rows.sizes):
        drawing.add_strokes(rows.sizes.tolist())
    _write_tail(drawing, rows)


def _write_tail(drawing: bpy.types.bpy_struct, rows: Rows) -> None:
    """Sets the attributes of the drawing's last strokes. Attributes that `rows` lacks get their defaults."""
    starts = gp.offsets(drawing)
    strokes, points = len(starts) - 1, int(starts[-1])
    if not len(rows.sizes):
        drawing.tag_positions_changed()
        return
    for name, values in rows.values.items():
        if name in rows.own:
            if not gp.has(drawing, name):
                gp.make(drawing, name, *rows.own[name])
            elif not _is_of(drawing, name, rows.own[name]):
                # Another one of the same name, which is the artist's.
                continue
        total = points if name == "position" or gp.domain(drawing, name) == "POINT" else strokes
        if len(values) < total:
            head = gp.positions(drawing, points) if name == "position" else gp.value(drawing, name, total)
            head[total - len(values) :] = values
            values = head
        gp.put(drawing, name, values)
    for name in gp.DEFAULTS:
        if gp.TYPES[name][1] == "POINT" and name not in rows.values and drawing.attributes.get(name) is not None:
            values = gp.value(drawing, name, points)
            values[points - int(rows.sizes.sum()) :] = gp.DEFAULTS[name]
            gp.put(drawing, name, values)
    drawing.tag_positions_changed()

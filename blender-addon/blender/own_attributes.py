"""Attributes of the artist's own: those that neither Blender nor Rototoon makes, such as a mask for Geometry Nodes or a number of a studio's tool.

What: which attributes these are. Generated strokes get them from the artist's strokes, as they get the look.

How: as in-betweens do. Numbers with a fraction, places and colours are blended, along a stroke and in time. Whole numbers and truth values
cannot be blended: along a stroke they are those of the nearest point, in time those of the key before. A key without the attribute has its
default, 0.

Limits: texts and matrices, which Python cannot read as arrays, stay where they are. If an attribute has one name and two types, the type on the
first drawing counts. A generated drawing on which the artist has made an attribute of this name and another type keeps it.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from . import grease_pencil as gp

Kind = tuple[str, str]
"""Data type and domain, POINT or CURVE."""

_BLENDERS = frozenset({
    "position", "curve_type", "handle_left", "handle_right", "handle_type_left", "handle_type_right", "nurbs_weight", "delta_time", "init_time",
})  # fmt: skip
"""Attributes of Blender that Rototoon does not make."""


def is_own(name: str) -> bool:
    """Whether an attribute is the artist's own. Names that begin with a dot are Blender's, such as those of selections."""
    return not name.startswith((".", "rototoon_")) and name not in gp.TYPES and name not in _BLENDERS


def of(drawing: Any) -> dict[str, Kind]:
    """The artist's own attributes of a drawing."""
    own = (each for each in drawing.attributes if is_own(each.name))
    return {each.name: (each.data_type, each.domain) for each in own if gp.is_numeric(each.data_type)}


def first_of(drawings: Iterable[dict[str, Kind]]) -> dict[str, Kind]:
    """The attributes of several drawings. Of two types the first one counts."""
    found: dict[str, Kind] = {}
    for each in drawings:
        found = each | found
    return found


def is_blended(values: np.ndarray) -> bool:
    """Whether values can be blended."""
    return values.dtype.kind == "f"

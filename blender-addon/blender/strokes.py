"""Complete drawings as arrays: reading and writing everything that Blender knows of their strokes.

A drawing keeps its attributes when it is written with other numbers of strokes and points. Vertex groups are an exception: Blender
keeps them elsewhere, and they stay with the same point indices.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field

import bpy
import numpy as np

from . import grease_pencil as gp
from . import guard, materials, stroke_rows

CATMULL_ROM, POLY, BEZIER, NURBS = range(4)
_TYPE_NAMES = ("CATMULL_ROM", "POLY", "BEZIER", "NURBS")
ENDPOINT, ENDPOINT_BEZIER = 1, 3
"""Knot modes: of a curve from its first to its last control point, and of a chain of Bézier curves."""


@dataclass
class Content:
    """The strokes of a drawing."""

    sizes: np.ndarray
    """Number of points of each stroke."""
    types: np.ndarray
    """Curve type of each stroke."""
    point: dict[str, np.ndarray] = field(default_factory=dict)
    """Attributes of the points by name, with the positions."""
    curve: dict[str, np.ndarray] = field(default_factory=dict)
    """Attributes of the strokes by name."""
    kinds: dict[str, str] = field(default_factory=dict)
    """Data type of each attribute."""

    @property
    def starts(self) -> np.ndarray:
        """Index of each stroke's first point, then the number of points."""
        return np.concatenate([[0], np.cumsum(self.sizes)]).astype(np.int32)

    def strokes(self, name: str) -> np.ndarray:
        """An attribute of the strokes, or its default values if it is missing."""
        found = self.curve.get(name)
        return gp.blank(name, len(self.sizes)) if found is None else found

    def set_strokes(self, name: str, values: np.ndarray) -> None:
        """Sets an attribute of the strokes. A missing attribute is made."""
        self.kinds.setdefault(name, gp.TYPES[name][0])
        self.curve[name] = values

    def finite(self) -> np.ndarray:
        """Which strokes have points, all of them finite."""
        fine = np.isfinite(self.point["position"]).all(1) if len(self.sizes) else np.zeros(0, bool)
        bad = np.zeros(len(self.sizes), bool)
        bad[np.repeat(np.arange(len(self.sizes)), self.sizes)[~fine]] = True
        return ~bad & (self.sizes > 0)

    def equals(self, other: Content) -> bool:
        """Whether both have the same strokes and attributes."""
        if not (np.array_equal(self.sizes, other.sizes) and np.array_equal(self.types, other.types)):
            return False
        mine, theirs = self.point | self.curve, other.point | other.curve
        return mine.keys() == theirs.keys() and all(_same(mine[name], theirs[name]) for name in mine)


def _same(a: np.ndarray, b: np.ndarray) -> bool:
    return a.shape == b.shape and a.tobytes() == b.tobytes()


def read(drawing) -> Content:
    """The content of a drawing, without selections and vertex groups."""
    starts = gp.offsets(drawing)
    strokes, points = len(starts) - 1, int(starts[-1])
    content = Content(np.diff(starts), np.zeros(strokes, np.int8))
    content.point["position"] = gp.positions(drawing, points)
    for attribute in drawing.attributes:
        name, curve = attribute.name, attribute.domain == "CURVE"
        values = None if name.startswith(".") else gp.get(drawing, name, strokes if curve else points)
        if values is None or name == "position":
            continue
        if name == "curve_type":
            content.types = values
            continue
        content.kinds[name] = attribute.data_type
        (content.curve if curve else content.point)[name] = values
    return content


def of_rows(rows: stroke_rows.Rows) -> Content:
    """The content of a drawing that has only these strokes."""
    content = Content(rows.sizes, np.full(len(rows.sizes), POLY, np.int8))
    for name, values in rows.values.items():
        kind, domain = ("", "POINT") if name == "position" else rows.own.get(name) or gp.TYPES[name]
        (content.point if domain == "POINT" else content.curve)[name] = values
        if kind:
            content.kinds[name] = kind
    return content


def write(drawing, content: Content) -> None:
    """Replaces the content of a drawing."""
    count, have = len(content.sizes), len(gp.offsets(drawing)) - 1
    if count > have:
        drawing.add_strokes([1] * (count - have))
    elif count < have:
        drawing.remove_strokes(indices=list(range(count, have)))
    if count:
        set_types(drawing, content.types)
        sizes = np.diff(gp.offsets(drawing))
        if not np.array_equal(sizes, content.sizes):
            drawing.resize_strokes(sizes=content.sizes.tolist(), indices=list(range(count)))
        for domain, values in (("POINT", content.point), ("CURVE", content.curve)):
            for name, each in values.items():
                if drawing.attributes.get(name) is None:
                    gp.make(drawing, name, content.kinds[name], domain)
                gp.put(drawing, name, each)
    drawing.tag_positions_changed()


def set_types(drawing, types: np.ndarray) -> None:
    """Sets the curve type of each stroke."""
    now = gp.get(drawing, "curve_type", len(types))
    now = np.zeros(len(types), np.int8) if now is None else now
    for kind in np.unique(types):
        other = np.flatnonzero((types == kind) & (now != kind))
        if len(other):
            drawing.set_types(type=_TYPE_NAMES[kind], indices=other.tolist())


def add(drawing, content: Content) -> None:
    """Adds strokes to a drawing after its own, with everything that is known of them."""
    write(drawing, joined(read(drawing), content))


def chosen(content: Content, which: Iterable[int] | np.ndarray) -> Content:
    """The strokes with some indices, in that order."""
    which = np.asarray(which if isinstance(which, np.ndarray) else list(which), int)
    points = ranges(content.starts[:-1][which], content.sizes[which])
    made = Content(content.sizes[which], content.types[which], kinds=dict(content.kinds))
    made.point = {name: values[points] for name, values in content.point.items()}
    made.curve = {name: values[which] for name, values in content.curve.items()}
    return made


def joined(one: Content, other: Content) -> Content:
    """The strokes of both contents. Each gets the attributes of both."""
    result = Content(np.concatenate([one.sizes, other.sizes]), np.concatenate([one.types, other.types]))
    result.kinds = one.kinds | other.kinds
    for side in ("point", "curve"):
        mine, theirs, into = getattr(one, side), getattr(other, side), getattr(result, side)
        counts = [len(c.point["position"]) if side == "point" else len(c.sizes) for c in (one, other)]
        for name in mine | theirs:
            values = [_or_blank(name, each, count, mine, theirs) for each, count in zip((mine, theirs), counts)]
            into[name] = np.concatenate(values)
    return result


def _or_blank(name: str, values: dict, count: int, *known: dict) -> np.ndarray:
    if name in values:
        return values[name]
    like = next(each[name] for each in known if name in each)
    return np.full((count, *like.shape[1:]), gp.DEFAULTS.get(name, 0), like.dtype)


def ranges(starts: np.ndarray, sizes: np.ndarray) -> np.ndarray:
    """The numbers from `starts[i]` up to `starts[i] + sizes[i]` for all i, one range after the other."""
    ends = np.cumsum(sizes)
    total = int(ends[-1]) if len(ends) else 0
    return np.repeat(np.asarray(starts, np.int64) - (ends - sizes), sizes) + np.arange(total)


def bottom_layer(ob, name: str):
    """Makes a layer below all others."""
    made = gp.layer(ob, name)
    ob.data.layers.move_bottom(made)
    return made


def shown_frame(layer, frame: int) -> int | None:
    """The frame of the drawing that a layer shows on `frame`; `None` if it shows none."""
    found = layer.get_frame_at(frame)
    return None if found is None else found.frame_number


def editable_layers(ob, active: bool) -> list:
    """The layers whose strokes may be replaced, the lowest first. With `active`, only the active layer.

    Locked and hidden layers are left out (see `guard`), and so are layers with contours, since tracking knows their points by
    index. Raises a `Problem` that names the active layer, or all layers, if it leaves out none but closed ones.
    """
    wanted = drawn_layers(ob, active)
    guard.need_some(wanted)
    return guard.open_layers(wanted)


def drawn_layers(ob, active: bool) -> list:
    """The layers with drawings but for those with contours and paint, closed ones too. With `active`, only the active layer, paint too."""
    layers = [ob.data.layers.active] if active else list(ob.data.layers)
    contours = {layer.name for layer in gp.layers(ob, ob.rototoon.contours_layer)}
    layers = [layer for layer in layers if layer is not None and layer.name not in contours]
    return layers if active else [layer for layer in layers if len(layer.frames) and not is_paint(ob, layer)]


def is_paint(ob, layer) -> bool:
    """Whether Rototoon has painted on a layer. One that only bears the name is the artist's. Reads no array."""
    named = layer.name == ob.rototoon.fills_layer
    return named and any(gp.has(handle, gp.CLICK) for handle in gp.handles(layer))


def filled(ob, content: Content) -> np.ndarray:
    """For each stroke the number of its fill; 0 for no fill. Strokes with one common fill have the same number."""
    if gp.FILL_BY_ID:
        return content.strokes("fill_id")
    index = content.strokes("material_index")
    shown = np.array([_shows_fill(material) for material in materials.of(ob)])
    if not len(shown):
        return np.zeros(len(index), np.int32)
    index = np.clip(index, 0, len(shown) - 1)
    return np.where(shown[index], np.arange(1, len(index) + 1), 0).astype(np.int32)


def solid(ob, content: Content) -> np.ndarray:
    """For each stroke: whether it is the outline of a filled shape and no line is drawn along it."""
    shapes = content.strokes("cyclic") & (filled(ob, content) != 0)
    if gp.FILL_BY_ID:
        return shapes & content.strokes("hide_stroke")
    lined = np.array([_shows_line(material) for material in materials.of(ob)] or [True])
    return shapes & ~lined[np.clip(content.strokes("material_index"), 0, len(lined) - 1)]


def undrawn(content: Content) -> np.ndarray:
    """For each stroke: whether its line is transparent at all points. A fill may be there all the same."""
    opacity = content.point.get("opacity")
    found = np.zeros(len(content.sizes), bool)
    some = content.sizes > 0
    if opacity is not None and some.any():
        found[some] = np.maximum.reduceat(opacity, content.starts[:-1][some]) <= 0
    return found


def lineless(ob, content: Content) -> np.ndarray:
    """For each stroke: whether no line is drawn along it. A fill may be there all the same."""
    if gp.FILL_BY_ID:
        return undrawn(content) | content.strokes("hide_stroke")
    lined = np.array([_shows_line(material) for material in materials.of(ob)] or [True])
    return undrawn(content) | ~lined[np.clip(content.strokes("material_index"), 0, len(lined) - 1)]


def _shows_line(material) -> bool:
    return material is None or material.grease_pencil is None or material.grease_pencil.show_stroke


def _shows_fill(material) -> bool:
    return material is not None and material.grease_pencil is not None and material.grease_pencil.show_fill


def line_material(ob, index: int) -> int:
    """Index of the material that draws only the line of material `index`, without its fill. It is made if it does not exist.

    A material of that name which has a fill is the artist's, and stays as it is.
    """
    shown = materials.of(ob)
    material = shown[min(index, len(shown) - 1)]
    name = f"{material.name} Line"
    for place, other in enumerate(shown):
        if other is not None and _is_line_of(other, name):
            return place
    made = next((other for other in bpy.data.materials if other.library is None and _is_line_of(other, name)), None)
    if made is None:
        made = material.copy()
        made.name = name
        made.grease_pencil.show_fill = False
    return materials.append(ob, made)


def _is_line_of(material, name: str) -> bool:
    """Whether a material has no fill and has a name, maybe with the number that Blender gives where a name is taken."""
    plain = material.grease_pencil is not None and not material.grease_pencil.show_fill
    return plain and re.fullmatch(re.escape(name) + r"(\.\d{3,})?", material.name) is not None


def unique_numbers(used: Iterable[int], count: int) -> np.ndarray:
    """`count` numbers that are larger than all used ones."""
    return np.arange(count, dtype=np.int32) + 1 + max(used, default=0)

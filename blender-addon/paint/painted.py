"""Regions as generated strokes, with the materials of the artist's shapes."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

import bpy
import numpy as np

from ..blender import fill_materials, marks, materials, stroke_rows
from ..blender import grease_pencil as gp
from ..blender import strokes as st
from ..common import polygons
from ..lines import drawings as dr
from . import clicks, sheets, shapes

COVERED = 0.9
"""Share of a region that the artist's own shapes must cover so that it is not painted once more below them."""


@dataclass
class Region:
    """A region on one frame."""

    number: int
    """Its number on the layer, from 1."""
    outline: np.ndarray
    """Footage pixels (N, 2)."""
    holes: list[np.ndarray]
    colour: np.ndarray | None
    """sRGB from 0 to 1; `None` for no paint."""
    confidence: float = 1.0
    name: str | None = None
    """The name of its colour."""

    @property
    def loops(self) -> list[np.ndarray]:
        """Its outline, and those of its holes."""
        return [self.outline, *self.holes]

    def covered(self, own: Iterable[sheets.Shape]) -> bool:
        """Whether shapes cover it."""
        places = shapes.middles(self.loops)
        under = np.zeros(len(places), bool)
        for shape in own:
            under |= polygons.inside(shape.loops, places)
        return len(places) > 0 and under.mean() >= COVERED


@dataclass
class Palette:
    """The material and the tint of each colour: those of the artist's shapes. Other colours get materials of their own. Colours with a name are told
    apart by it, others by their look."""

    looks: dict[tuple[float, ...] | str, tuple[int, np.ndarray]] = field(default_factory=dict)

    def add(self, click: clicks.Click, content: st.Content) -> None:
        """Adds the look of a stroke of the artist. The first one of a colour counts. No paint has its own material."""
        if click.colour is None:
            return
        look = int(content.strokes("material_index")[click.stroke]), content.strokes("fill_color")[click.stroke].copy()
        self.looks.setdefault(click.name or tuple(click.colour), look)

    def add_materials(self, ob, given: Iterable[bpy.types.Material]) -> None:
        """Adds those of the object's materials that are given, as they are, by their names."""
        places = {own: place for place, own in reversed(list(enumerate(materials.of(ob))))}
        for material in given:
            if material in places:
                self.looks.setdefault(material.name, (places[material], np.zeros(4, np.float32)))

    def of(self, ob, region: Region) -> tuple[int, np.ndarray]:
        """Material and tint of a region."""
        colour, name = region.colour, region.name
        if colour is None:
            return fill_materials.nothing(ob), np.zeros(4, np.float32)
        if name is not None:
            if name not in self.looks:
                self.looks[name] = fill_materials.named(ob, name, colour), np.zeros(4, np.float32)
            return self.looks[name]
        for known, look in self.looks.items():
            if not isinstance(known, str) and np.abs(np.array(known) - colour).max() <= fill_materials.SAME:
                return look
        look = fill_materials.material(ob, colour), np.zeros(4, np.float32)
        self.looks[tuple(np.round(colour, 6).tolist())] = look
        return look


def rows(ob, regions: list[Region], mapping, palette: Palette, taken: Iterable[int] = ()) -> stroke_rows.Rows:
    """Regions as attributes of generated strokes. `taken` are the fills of other strokes of the drawing."""
    lines = [shapes.joined(region.outline, region.holes) for region in regions]
    found = stroke_rows.Rows(np.array([len(line) for line in lines], np.int32))
    total, count = int(found.sizes.sum()), len(lines)
    for name in ("radius", "opacity"):
        found.values[name] = gp.blank(name, total)
    places = mapping.to_layer(np.concatenate(lines)) if total else np.zeros((0, 3))
    found.values["position"] = found.values[gp.TRACKED] = places.astype(np.float32)
    found.values["cyclic"] = found.values[gp.MADE] = np.ones(count, bool)
    found.values[gp.CLICK] = gp.blank(gp.CLICK, count)
    found.values[gp.TRACK] = np.array([region.number for region in regions], np.int32)
    found.values[gp.CONFIDENCE] = np.repeat(np.array([region.confidence for region in regions], np.float32), found.sizes)
    looks = [palette.of(ob, region) for region in regions]
    found.values["material_index"] = np.array([material for material, _ in looks], np.int32)
    found.values["fill_color"] = np.array([tint for _, tint in looks], np.float32).reshape(count, 4)
    if gp.FILL_BY_ID:
        found.values["fill_id"] = _fills([region.number for region in regions], set(taken))
        found.values["hide_stroke"] = np.ones(count, bool)
    found.values[gp.LOOK] = dr.painted_looks(st.of_rows(found), marks.Slots(ob.data).now) if count else gp.blank(gp.LOOK, 0)
    marks.remember(ob.data)
    return found


def _fills(numbers: list[int], taken: set[int]) -> np.ndarray:
    """A number for each fill that no other stroke has: strokes with one number are one shape."""
    spare = max([gp.FILL_BASE + max(numbers, default=0), *taken]) + 1
    found: list[int] = []
    for number in numbers:
        own = gp.FILL_BASE + number
        if own in taken:
            own, spare = spare, spare + 1
        taken.add(own)
        found.append(own)
    return np.array(found, np.int32)


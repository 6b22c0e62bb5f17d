"""Colours that become others on some frames: a character gets wet, a lamp is switched on.

What: the object keeps a list of entries, each with the material before, the material after, and the frames. Fill Drawings hands them to the
library, which paints every region of the first material with the second one there. An entry that is added changes what is painted at once, so
nothing has to be painted again: an entry changes what the ones before it have left, and that is what the layer shows.

Why so: the artist's shapes are never written. Those that keep the old material on such frames are told.

Limits: a colour by a tint has no material of its own, and so no entry. Where a drawing of the artist is held across the first frame, only Fill
Drawings can part the two. To take an entry away is up to Fill Drawings, too, because only the library knows which regions had the old colour.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import bpy
import numpy as np
from rototoon.fills import Hue, Recolour

from ..blender import fill_materials, guard, holds, marks, materials
from ..blender import grease_pencil as gp
from ..blender.errors import Problem
from ..common.wording import listed
from ..lines import drawings as dr
from ..lines import plan as lines_plan
from . import sheets


@dataclass(frozen=True)
class Entry:
    """A material that becomes another one."""

    old: bpy.types.Material
    new: bpy.types.Material
    first: int | None = None
    """The first scene frame; `None` for all before `last`."""
    last: int | None = None
    """The last scene frame; `None` for all from `first` on."""

    def is_on(self, frame: int) -> bool:
        """Whether it holds on a scene frame."""
        return (self.first is None or self.first <= frame) and (self.last is None or frame <= self.last)

    def said(self) -> str:
        """In words: Coat → Wet, from 24 on."""
        return f"{self.old.name} → {self.new.name}, {self.when()}"

    def when(self) -> str:
        """Its frames in words."""
        if self.first is None:
            return "on all frames" if self.last is None else f"up to {self.last}"
        if self.last is None:
            return f"from {self.first} on"
        return f"on {self.first}" if self.first == self.last else f"on {self.first} to {self.last}"


@dataclass
class Changed:
    """What an entry has changed of what was painted."""

    regions: int = 0
    frames: set[int] = field(default_factory=set)
    waiting: set[int] = field(default_factory=set)
    """Scene frames on which a drawing of the artist is held, so that only Fill Drawings can change the colour."""


def entries(ob) -> dict[int, Entry]:
    """The entries of an object by their place in its list. Those whose material was removed from the file are left out."""
    found = {}
    for place, own in enumerate(ob.rototoon.recolours):
        if own.old is not None and own.new is not None:
            found[place] = Entry(own.old, own.new, own.first if own.has_first else None, own.last if own.has_last else None)
    return found


def add(ob, entry: Entry) -> Changed:
    """Adds an entry, and changes what Fill Drawings has painted. Raises a `Problem` if the layer may not be written, or for an entry that
    makes no sense."""
    name = ob.rototoon.fills_layer
    guard.need(ob)
    guard.need_named(ob, [name])
    _check(ob, entry)
    place = _slot(ob, entry.new)
    _keep(ob, entry)
    done = Changed()
    layer = gp.find_layer(ob, name)
    if layer is not None:
        _part(ob, layer, entry, done)
        _change(ob, layer, entry, place, done)
        ob.data.update_tag()
    return done


def remove(ob, place: int) -> Entry | None:
    """Removes the entry at a place of the list, and returns it; `None` if its material was gone."""
    guard.need(ob, guard.SETTINGS)
    if not 0 <= place < len(ob.rototoon.recolours):
        raise Problem(f"There is no entry {place}: the list has {len(ob.rototoon.recolours)}")
    entry = entries(ob).get(place)
    ob.rototoon.recolours.remove(place)
    return entry


def unchanged(entries: Iterable[Entry], names: Mapping[int, set[str | None]]) -> set[int]:
    """The scene frames on which shapes of the artist keep the old material. `names` has the materials of these shapes by scene frame."""
    return {frame for entry in entries for frame, own in names.items() if entry.is_on(frame) and entry.old.name in own}


def names_of_own(ob) -> dict[int, set[str | None]]:
    """The names of the colours of the artist's shapes, by scene frame."""
    found = {}
    for frame, sheet in sheets.read(ob, ob.rototoon.fills_layer).items():
        names = fill_materials.names_of_strokes(ob, sheet.content)
        found[frame] = {names[int(i)] for i in sheet.own}
    return found


def told(frames: set[int]) -> str:
    """What is said of shapes that keep the old material; empty without any."""
    if not frames:
        return ""
    on = f"{'frame' if len(frames) == 1 else 'frames'} {listed(sorted(frames))}"
    return f"shapes of yours keep the old colour, on {on}: give them the new material if they are to change"


def fields(ob) -> list[dict[str, Any]]:
    """The entries in the form of a document."""
    offset, found = ob.rototoon.frame_offset, []
    for entry in entries(ob).values():
        old, new = ({"name": own.name, "colour": fill_materials.look(own).clip(0, 1).round(6).tolist()} for own in (entry.old, entry.new))
        ends = {name: frame - offset for name, frame in (("first", entry.first), ("last", entry.last)) if frame is not None}
        found.append({"from": old, "to": new, **ends})
    return found


def edges(ob) -> set[int]:
    """The scene frames on which a colour may differ from the frame before, though the picture is the same."""
    found = set()
    for entry in entries(ob).values():
        found |= {entry.first} if entry.first is not None else set()
        found |= {entry.last + 1} if entry.last is not None else set()
    return found


def take(ob, given: Sequence[Recolour]) -> None:
    """Replaces the entries of an object by those of a document."""
    ob.rototoon.recolours.clear()
    offset = ob.rototoon.frame_offset

    def material(hue: Hue) -> bpy.types.Material:
        colour = np.array(hue.colour)
        place = fill_materials.material(ob, colour) if hue.name is None else fill_materials.named(ob, hue.name, colour)
        return materials.of(ob)[place]

    for own in given:
        ends = [None if frame is None else frame + offset for frame in (own.first, own.last)]
        _keep(ob, Entry(material(own.old), material(own.new), *ends))


def _check(ob, entry: Entry) -> None:
    if entry.old == entry.new:
        raise Problem(f'"{entry.old.name}" becomes itself: choose another material')
    if entry.first is not None and entry.last is not None and entry.first > entry.last:
        raise Problem(f"The last frame, {entry.last}, is before the first one, {entry.first}")
    for material in (entry.old, entry.new):
        if not fill_materials.is_colour(material):
            raise Problem(f'"{material.name}" has no fill, so it is no colour of paint')
    low, high = lines_plan.film(ob) if ob.rototoon.pattern else (None, None)
    if low is not None and not any(entry.is_on(frame) for frame in range(low, high + 1)):
        raise Problem(f"There are no pictures on these frames: the footage is on frames {low} to {high}")


def _keep(ob, entry: Entry) -> None:
    own = ob.rototoon.recolours.add()
    own.old, own.new = entry.old, entry.new
    own.has_first, own.has_last = entry.first is not None, entry.last is not None
    own.first, own.last = entry.first or 0, entry.last or 0


def _slot(ob, material: bpy.types.Material) -> int:
    """Index of a material among the object's. It is appended if it is not there."""
    for place, own in enumerate(materials.of(ob)):
        if own == material:
            return place
    return materials.append(ob, material)


def _masks(ob, sheet: sheets.Sheet, entry: Entry) -> np.ndarray:
    """Which generated strokes of a drawing have the old material."""
    names = fill_materials.names_of_strokes(ob, sheet.content)
    return sheet.made & np.array([name == entry.old.name for name in names], bool)


def _edges(entry: Entry, frames: Sequence[int]) -> Iterator[int]:
    """The frames on which the colour changes, between the first and the last drawing and beyond."""
    for edge in (entry.first, None if entry.last is None else entry.last + 1):
        if edge is not None and edge not in frames:
            yield edge


def _part(ob, layer, entry: Entry, done: Changed) -> None:
    """Gives the frames on which the colour changes drawings of their own."""
    drawn = sheets.read(ob, layer.name)
    film = lines_plan.film(ob) if ob.rototoon.pattern else None
    for edge in list(_edges(entry, list(drawn))):
        before = max((frame for frame in drawn if frame < edge), default=None)
        if before is None or (film is not None and not film[0] <= edge <= film[1]):
            continue
        sheet = drawn[before]
        names = fill_materials.names_of_strokes(ob, sheet.content)
        if len(sheet.own):
            done.waiting |= {edge} if entry.old.name in names else set()
        elif _masks(ob, sheet, entry).any():
            gp.copy_frame(layer, before, edge)
            gp.make_own(layer, [edge])
            gp.set_keyframe_type(layer, {edge: gp.GENERATED})
            holds.note(ob.data, layer.name, (), [edge])


def _change(ob, layer, entry: Entry, place: int, done: Changed) -> None:
    """Gives generated strokes the new material. A number has one colour, so they get other numbers, too."""
    drawn = sheets.read(ob, layer.name)
    masks = {frame: _masks(ob, sheet, entry) for frame, sheet in drawn.items() if entry.is_on(frame)}
    masks = {frame: mask for frame, mask in masks.items() if mask.any()}
    gp.make_own(layer, masks)
    handles, numbers, slots = gp.drawings(layer), {}, marks.Slots(ob.data)
    spare = max((int(sheet.content.strokes(gp.TRACK).max(initial=0)) for sheet in drawn.values()), default=0) + 1
    for frame, mask in sorted(masks.items()):
        content = drawn[frame].content
        index, tracks = content.strokes("material_index").copy(), content.strokes(gp.TRACK).copy()
        for i in np.flatnonzero(mask):
            tracks[i] = numbers.setdefault(int(tracks[i]), spare + len(numbers))
        index[mask] = place
        content.set_strokes("material_index", index)
        looks = np.where(mask, dr.painted_looks(content, slots.now), content.strokes(gp.LOOK))
        for name, values in (("material_index", index), (gp.TRACK, tracks), (gp.LOOK, looks)):
            gp.put(handles[frame][0], name, values)
        done.frames.add(frame)
        done.regions += int(mask.sum())
    marks.remember(ob.data)

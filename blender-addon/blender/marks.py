"""Whether the artist has changed a generated drawing.

What: whoever generates a drawing marks it at the end (`note`). The mark is one number, the checksum of the drawing, on each of its strokes
(`rototoon_mark`). A drawing is as it was generated if all its strokes have its checksum (`untouched`). Any other number is the artist's work:
a moved point, another look, a stroke more or less, another order.

How: the checksum is a CRC over the numbers of points, the curve types, the points, and all attributes by name but for those of Rototoon and
those whose name begins with a dot, which are selections. The names of the strokes' materials are a checksum of their own, combined by exclusive or, so
that they can be compared under other names without a look at the rest.

Why so:

- The mark is in the drawing. It moves along when the drawing is copied or moved in time, when the layer gets another name, when objects are
  joined, and with undo.
- Blender adds attributes with their default values when it opens old files and when a tool needs them. So an attribute whose values are all
  the default counts as none, and so does the sign of zero.
- Blender 5.1 and later keep the fill of a stroke in attributes, which they make when they open a file of an earlier version. So the checksum
  knows which way it was made, and one of an earlier Blender leaves these attributes out.
- Blender numbers materials anew when the artist removes or moves a slot. So their names count, and no numbers. An artist may give a material
  another name, too: `Slots` keeps the names at each marking, and a material that has a new name is compared under those that are gone.
- Colours in bytes are compared as bytes: versions of Blender convert them with different rounding.
- A file of an older version has no marks. `lines.older_files` sets them when it is opened. Without them callers ask what they noted before there
  were marks.

Limits: Blender does not tell weights of vertex groups, so they do not count. Attributes of types that Python cannot read as arrays do not
count. One change in four thousand million has the same checksum.
"""

from __future__ import annotations

import json
import zlib
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from functools import cached_property
from itertools import islice, pairwise, permutations

import numpy as np

from . import grease_pencil as gp
from . import hierarchy
from . import strokes as st

PROPERTY = "rototoon_slots"
"""The names of the material slots at each marking, as one JSON text on the Grease Pencil data."""
THE_ARTISTS = -1
"""The mark of a generated drawing that was changed on the artist's behalf."""
WAYS = 24
"""Largest number of ways to look for materials with another name among those that are gone, where slots were removed."""
_NONE = 0
_FILLS = ("fill_id", "hide_stroke")
_SETTINGS = {True: b"fill by attribute", False: b"fill by material"}


class Slots:
    """The material slots of Grease Pencil data, now and at each marking."""

    def __init__(self, data):
        self.now = _names(data)
        self.then = _known(data)

    @cached_property
    def namings(self) -> list[list[str]]:
        """The names that the materials in the slots may have had: first those that they have."""
        found = [self.now]
        for then in self.then:
            found += [each for each in _namings(self.now, then) if each not in found]
        return found

    def of(self, content: st.Content) -> list[list[str]]:
        """The names that the materials of a drawing's strokes may have had."""
        # Blender numbers nothing anew where all strokes have the first material and no number. To change one it would need numbers.
        return self.namings if "material_index" in content.curve else self.namings + self.then


def _names(data) -> list[str]:
    return ["" if material is None else material.name for material in data.materials]


def _known(data) -> list[list[str]]:
    try:
        kept = json.loads(data.get(PROPERTY, "[]"))
        return [[str(name) for name in names] for names in kept if isinstance(names, list)]
    except (ValueError, TypeError):
        return []


def remember(data) -> None:
    """Keeps the names of the material slots, by which looks that are noted now are told when a material gets another name."""
    now, known = _names(data), _known(data)
    if any(then[: len(now)] == now for then in known):
        return
    known = [then for then in known if now[: len(then)] != then]
    data[PROPERTY] = json.dumps([*known, now], separators=(",", ":"))


def _namings(now: list[str], then: list[str]) -> Iterator[list[str]]:
    """The names that the materials may have had `then`, if some of them have another name now."""
    # A material that is in a second slot has taken the place of another one.
    unknown = [k for k, name in enumerate(now) if name not in then or name in now[:k]]
    gone = [k for k, name in enumerate(then) if name not in now]
    ways: Iterable[tuple[int, ...]] = [tuple(k for k in unknown if k in gone)]
    if len(now) < len(then):
        # Slots were removed, so they are not where they were: each may be each.
        ways = islice(permutations(gone, len(unknown)), WAYS)
    else:
        unknown = [k for k in unknown if k in gone]
    for way in ways:
        names = list(now)
        for k, was in zip(unknown, way):
            names[k] = then[was]
        yield names


def note(data, layer: str, frames: Iterable[int]) -> None:
    """Marks the drawings of a layer on some frames as generated just so."""
    wanted = set(frames)
    if not wanted:
        return
    with gp.copied(data) as copy:
        # Read from a copy, so that drawings with equal arrays go on sharing them.
        drawings = gp.drawings(gp.find_layer_of(copy, layer))
        contents = {frame: st.read(drawings[frame][0]) for frame in wanted & drawings.keys()}
    names = _names(data)
    for frame, (handle, _) in gp.drawings(gp.find_layer_of(data, layer)).items():
        content = contents.get(frame)
        if content is not None and len(content.sizes):
            total = _combined(_rest(content, gp.FILL_BY_ID), content, names)
            gp.put(handle, gp.MARK, np.full(len(content.sizes), total, np.int32))
    remember(data)


def make_the_artists(handle) -> None:
    """Marks a generated drawing as changed by the artist."""
    gp.put(handle, gp.MARK, np.full(len(gp.offsets(handle)) - 1, THE_ARTISTS, np.int32))


def untouched(content: st.Content, slots: Slots) -> bool | None:
    """Whether a drawing is as it was generated; `None` if it has no mark, as in a file of an older version."""
    marks = content.curve.get(gp.MARK)
    if marks is None or not marks.any():
        return None
    known = int(marks[0])
    if known == THE_ARTISTS or (marks != known).any():
        return False
    for by_id in (gp.FILL_BY_ID, not gp.FILL_BY_ID):
        rest = _rest(content, by_id)
        if any(_combined(rest, content, names) == known for names in slots.of(content)):
            return True
    return False


def untouched_frames(data, layer: str) -> set[int]:
    """The frames of a layer whose drawings are as they were generated, for certain."""
    return {frame for frame, same in _told(data, layer).items() if same}


def changed_frames(data, layer: str) -> list[int]:
    """The frames of a layer whose drawings have the keyframe type "Generated", and that the artist has changed since.

    An empty drawing has no stroke to mark. Whoever draws there changes it: its strokes are not generated.
    """
    return sorted(frame for frame, same in _told(data, layer).items() if same is False)


@contextmanager
def kept(ob) -> Iterator[None]:
    """Keeps the marks of snapped drawings, and of their hidden lines, while Rototoon itself changes them: what was as it was generated counts as such
    afterwards too."""
    names = [ob.rototoon.snapped_layer, ob.rototoon.snapped_layer + hierarchy.ASIDE]
    before = {name: untouched_frames(ob.data, name) for name in names if gp.find_layer(ob, name) is not None}
    there = {name: set(gp.frame_numbers(gp.find_layer(ob, name))) for name in before}
    yield
    for name in names:
        if gp.find_layer(ob, name) is not None:
            # New drawings are copies that Rototoon made.
            note(ob.data, name, before.get(name, set()) | set(gp.frame_numbers(gp.find_layer(ob, name))) - there.get(name, set()))


def _told(data, layer: str) -> dict[int, bool | None]:
    slots = Slots(data)
    with gp.copied(data) as copy:
        drawings = gp.drawings(gp.find_layer_of(copy, layer))
        return {frame: _as_generated(handle, slots) for frame, (handle, kind) in drawings.items() if kind == gp.GENERATED}


def _as_generated(handle, slots: Slots) -> bool | None:
    """As `untouched`, but a drawing without a mark is changed if the artist has drawn there."""
    same = untouched(st.read(handle), slots) if gp.has(handle, gp.MARK) else None
    return same if same is not None or all_made(handle) else False


def all_made(handle) -> bool:
    """Whether a drawing has no stroke of the artist."""
    return bool(gp.value(handle, gp.MADE, len(gp.offsets(handle)) - 1).all())


def _rest(content: st.Content, by_id: bool) -> int:
    """The checksum of everything but the materials."""
    total = zlib.crc32(_SETTINGS[by_id])
    for values in (content.sizes.astype(np.int32), content.types.astype(np.int8), content.point["position"]):
        total = zlib.crc32(_bytes(values), total)
    for name, values in _counting(content, by_id):
        total = zlib.crc32(_bytes(values), zlib.crc32(name.encode(), total))
    return total


def _counting(content: st.Content, by_id: bool) -> Iterator[tuple[str, np.ndarray]]:
    """The attributes that count, but for places and materials, with their values."""
    for side in (content.point, content.curve):
        for name in sorted(side):
            if name in ("position", "material_index") or name.startswith("rototoon_") or (name in _FILLS and not by_id):
                continue
            values = side[name]
            if not (values == gp.DEFAULTS.get(name, 0)).all():
                yield name, _as_bytes(values) if content.kinds.get(name) == "BYTE_COLOR" else values


def has_looks(content: st.Content, known: np.ndarray, slots: Slots, rests: Callable[[st.Content, bool], np.ndarray] | None = None) -> np.ndarray:
    """For each stroke: whether its look is the `known` one, noted in this Blender or in one that keeps fills another way. `rests` are the
    checksums of all but the material; by default those of `stroke_looks`."""
    same = np.zeros(len(content.sizes), bool)
    for by_id in (gp.FILL_BY_ID, not gp.FILL_BY_ID):
        found = (rests or _look_rests)(content, by_id)
        for names in slots.of(content):
            same = same | (with_materials(found, content, names) == known)
            if same.all():
                return same
    return same


def stroke_looks(content: st.Content, names: list[str], by_id: bool | None = None) -> np.ndarray:
    """A checksum of each stroke's look alone: int32, never 0. It does not depend on the other strokes of the drawing. `names` are those of the
    material slots.

    With `by_id` the attributes of fills count; by default as this Blender keeps them.
    """
    return with_materials(_look_rests(content, gp.FILL_BY_ID if by_id is None else by_id), content, names)


def with_materials(rests: np.ndarray, content: st.Content, names: list[str]) -> np.ndarray:
    """Checksums of strokes, combined with the names of their materials: int32, never 0."""
    index = content.strokes("material_index").tolist()
    sums = {k: zlib.crc32((names[k] if 0 <= k < len(names) else str(k)).encode()) for k in set(index)}
    totals = rests ^ np.array([sums[k] for k in index], np.uint32)
    return np.where(totals == 0, 1, totals).astype(np.uint32).view(np.int32)


def numbered_looks(content: st.Content, by_id: bool) -> np.ndarray:
    """As `stroke_looks`, with the numbers of the materials in place of their names."""
    index = np.ascontiguousarray(content.strokes("material_index"), np.int32)
    totals = [zlib.crc32(index[i : i + 1], total) or 1 for i, total in enumerate(_look_rests(content, by_id).tolist())]
    return np.array(totals, np.uint32).view(np.int32)


def _look_rests(content: st.Content, by_id: bool) -> np.ndarray:
    """The checksum of each stroke's look but for the material: uint32."""
    totals, starts = [zlib.crc32(_SETTINGS[by_id])] * len(content.sizes), content.starts.tolist()
    for name, values in _counting(content, by_id):
        of_curve, named = name in content.curve, zlib.crc32(name.encode()).to_bytes(4, "little")
        uncommon = (values != gp.DEFAULTS.get(name, 0)).reshape(len(values), -1).any(1)
        values = _bytes(values)
        for i, (a, b) in enumerate(pairwise(starts)):
            if uncommon[i] if of_curve else uncommon[a:b].any():
                totals[i] = zlib.crc32(values[i : i + 1] if of_curve else values[a:b], zlib.crc32(named, totals[i]))
    return np.array(totals, np.uint32)


def _bytes(values: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(values + values.dtype.type(0) if values.dtype.kind == "f" else values)


def _as_bytes(linear: np.ndarray) -> np.ndarray:
    """The bytes of colours, which Blender gives as linear numbers."""
    colour = np.clip(linear[:, :3].astype(np.float64), 0, 1)
    colour = np.where(colour <= 0.0031308, colour * 12.92, 1.055 * colour ** (1 / 2.4) - 0.055)
    return np.round(np.concatenate([colour, linear[:, 3:]], 1) * 255).astype(np.uint8)


def _combined(rest: int, content: st.Content, names: list[str]) -> int:
    """The checksum of everything, with these names of the materials: int32."""
    index = content.strokes("material_index").tolist()
    used = "\0".join(names[k] if 0 <= k < len(names) else str(k) for k in index)
    total = rest ^ zlib.crc32(used.encode())
    total = total - (1 << 32) if total >= 1 << 31 else total
    return 1 if total in (_NONE, THE_ARTISTS) else total

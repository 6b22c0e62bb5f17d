"""Whether the artist has changed a generated drawing.

What: whoever generates a drawing marks it at the end (`note`). The mark is one number, the checksum of the drawing, on each of its strokes
(`rototoon_mark`). A drawing is as it was generated if all its strokes have its checksum (`untouched`). Any other number is the artist's work:
a moved point, another look, a stroke more or less, another order.

How: the checksum is a CRC over the numbers of points, the curve types, the points, and all attributes by name but for those of Rototoon and
those whose name begins with a dot, which are selections. The material is a checksum of its own, combined by exclusive or, so that it can be
compared under another numbering without a look at the rest.

Why so:

- The mark is in the drawing. It moves along when the drawing is copied or moved in time, when the layer gets another name, when objects are
  joined, and with undo.
- Blender adds attributes with their default values when it opens old files and when a tool needs them. So an attribute whose values are all
  the default counts as none, and so does the sign of zero.
- Blender 5.1 and later keep the fill of a stroke in attributes, which they make when they open a file of an earlier version. So the checksum
  knows which way it was made, and one of an earlier Blender leaves these attributes out.
- Blender numbers materials anew when the artist removes or moves a slot. `Slots` keeps the names of the slots at each marking, and the drawing
  is compared under these numbers too. A material that only got another name has its old number.
- Colours in bytes are compared as bytes: versions of Blender convert them with different rounding.
- A file of an older version has no marks. `lines.older_files` sets them when it is opened. Without them callers ask what they noted before there
  were marks.

Limits: Blender does not tell weights of vertex groups, so they do not count. Attributes of types that Python cannot read as arrays do not
count. One change in four thousand million has the same checksum.
"""

from __future__ import annotations

import json
import zlib
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from functools import cached_property
from itertools import islice, permutations

import numpy as np

from . import grease_pencil as gp
from . import strokes as st

PROPERTY = "rototoon_slots"
"""The names of the material slots at each marking, as one JSON text on the Grease Pencil data."""
THE_ARTISTS = -1
"""The mark of a generated drawing that was changed on the artist's behalf."""
WAYS = 24
"""Largest number of ways to find renamed materials among those whose slots were removed."""
_NONE = 0
_FILLS = ("fill_id", "hide_stroke")
_SETTINGS = {True: b"fill by attribute", False: b"fill by material"}


class Slots:
    """The material slots of Grease Pencil data, now and at each marking."""

    def __init__(self, data):
        self._now = _names(data)
        self._then = _known(data)

    @cached_property
    def numberings(self) -> list[np.ndarray]:
        """For each slot the number that it had, at each time: first the present one."""
        found = [np.arange(len(self._now), dtype=np.int32)]
        for then in self._then:
            found += [each for each in _numbers(self._now, then) if not any(np.array_equal(each, other) for other in found)]
        return found


def _names(data) -> list[str]:
    return ["" if material is None else material.name for material in data.materials]


def _known(data) -> list[list[str]]:
    try:
        kept = json.loads(data.get(PROPERTY, "[]"))
        return [[str(name) for name in names] for names in kept if isinstance(names, list)]
    except (ValueError, TypeError):
        return []


def _remember(data) -> None:
    now, known = _names(data), _known(data)
    if any(then[: len(now)] == now for then in known):
        return
    # Slots that were only added leave the numbers of the others.
    known = [then for then in known if now[: len(then)] != then]
    data[PROPERTY] = json.dumps([*known, now], separators=(",", ":"))


def _numbers(now: list[str], then: list[str]) -> Iterator[np.ndarray]:
    """The numbers that the slots may have had `then`. A new one has a number that none had."""
    place = {name: k for k, name in reversed(list(enumerate(then)))}
    numbers = np.array([place.get(name, len(then) + k) for k, name in enumerate(now)], np.int32)
    unknown = [k for k, name in enumerate(now) if name not in place]
    gone = [k for k, name in enumerate(then) if name not in now]
    # Materials with another name are where they were, unless slots were removed: then each may be each.
    ways: Iterable[tuple[int, ...]] = [tuple(k if k in gone else len(then) + k for k in unknown)]
    if len(now) < len(then):
        ways = islice(permutations(gone, len(unknown)), WAYS)
    for way in ways:
        numbers[unknown] = way
        yield numbers.copy()


def note(data, layer: str, frames: Iterable[int]) -> None:
    """Marks the drawings of a layer on some frames as generated just so."""
    wanted = set(frames)
    if not wanted:
        return
    with gp.copied(data) as copy:
        # Read from a copy, so that drawings with equal arrays go on sharing them.
        drawings = gp.drawings(gp.find_layer_of(copy, layer))
        contents = {frame: st.read(drawings[frame][0]) for frame in wanted & drawings.keys()}
    sums = {frame: (len(content.sizes), sum_of(content)) for frame, content in contents.items()}
    for frame, (handle, _) in gp.drawings(gp.find_layer_of(data, layer)).items():
        if frame in sums and sums[frame][0]:
            gp.put(handle, gp.MARK, np.full(*sums[frame], np.int32))
    _remember(data)


def make_the_artists(handle) -> None:
    """Marks a generated drawing as changed by the artist."""
    gp.put(handle, gp.MARK, np.full(len(gp.offsets(handle)) - 1, THE_ARTISTS, np.int32))


def sum_of(content: st.Content) -> int:
    """The checksum of a drawing, as it is marked: int32."""
    return _combined(_rest(content, gp.FILL_BY_ID), content.strokes("material_index"))


def untouched(content: st.Content, slots: Slots) -> bool | None:
    """Whether a drawing is as it was generated; `None` if it has no mark, as in a file of an older version."""
    marks = content.curve.get(gp.MARK)
    if marks is None or not marks.any():
        return None
    known = int(marks[0])
    if known == THE_ARTISTS or (marks != known).any():
        return False
    index, numberings = content.strokes("material_index"), slots.numberings
    renumbered = [np.where(index < len(each), each[np.minimum(index, len(each) - 1)], index) if len(each) else index for each in numberings]
    for by_id in (gp.FILL_BY_ID, not gp.FILL_BY_ID):
        rest = _rest(content, by_id)
        if any(_combined(rest, each) == known for each in renumbered):
            return True
    return False


def untouched_frames(data, layer: str) -> set[int]:
    """The frames of a layer whose drawings are as they were generated, for certain."""
    return {frame for frame, same in _told(data, layer).items() if same}


def changed_frames(data, layer: str) -> list[int]:
    """The frames of a layer whose drawings have the keyframe type "Generated", and that the artist has changed since."""
    return sorted(frame for frame, same in _told(data, layer).items() if same is False)


@contextmanager
def kept(ob) -> Iterator[None]:
    """Keeps the marks of snapped drawings while Rototoon itself changes them: what was as it was generated counts as such afterwards too."""
    name = ob.rototoon.snapped_layer
    layer = gp.find_layer(ob, name)
    if layer is None:
        yield
        return
    before, there = untouched_frames(ob.data, name), set(gp.frame_numbers(layer))
    yield
    # New drawings are copies that Rototoon made.
    note(ob.data, name, before | set(gp.frame_numbers(gp.find_layer(ob, name))) - there)


def _told(data, layer: str) -> dict[int, bool | None]:
    slots = Slots(data)
    with gp.copied(data) as copy:
        drawings = gp.drawings(gp.find_layer_of(copy, layer))
        return {
            frame: untouched(st.read(handle), slots)
            for frame, (handle, kind) in drawings.items()
            if kind == gp.GENERATED and gp.has(handle, gp.MARK)
        }


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


def stroke_looks(content: st.Content) -> np.ndarray:
    """A checksum of each stroke's look alone: int32, never 0. It does not depend on the other strokes of the drawing."""
    totals, starts = [1] * len(content.sizes), content.starts.tolist()
    for name, values in _counting(content, by_id=True):
        of_curve, named = name in content.curve, zlib.crc32(name.encode()).to_bytes(4, "little")
        uncommon = (values != gp.DEFAULTS.get(name, 0)).reshape(len(values), -1).any(1)
        values = _bytes(values)
        for i, (a, b) in enumerate(zip(starts, starts[1:])):
            if uncommon[i] if of_curve else uncommon[a:b].any():
                totals[i] = zlib.crc32(values[i : i + 1] if of_curve else values[a:b], zlib.crc32(named, totals[i]))
    index = np.ascontiguousarray(content.strokes("material_index"), np.int32)
    totals = [zlib.crc32(index[i : i + 1], total) or 1 for i, total in enumerate(totals)]
    return np.array(totals, np.uint32).view(np.int32)


def _bytes(values: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(values + values.dtype.type(0) if values.dtype.kind == "f" else values)


def _as_bytes(linear: np.ndarray) -> np.ndarray:
    """The bytes of colours, which Blender gives as linear numbers."""
    colour = np.clip(linear[:, :3].astype(np.float64), 0, 1)
    colour = np.where(colour <= 0.0031308, colour * 12.92, 1.055 * colour ** (1 / 2.4) - 0.055)
    return np.round(np.concatenate([colour, linear[:, 3:]], 1) * 255).astype(np.uint8)


def _combined(rest: int, materials: np.ndarray) -> int:
    total = rest ^ zlib.crc32(np.ascontiguousarray(materials, np.int32))
    total = total - (1 << 32) if total >= 1 << 31 else total
    return 1 if total in (_NONE, THE_ARTISTS) else total

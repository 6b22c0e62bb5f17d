"""The object's layer of lines as the drawings of a document: see `drawn` for the way in.

The artist's drawings are `drawings`. So are in-betweens that the artist has changed since they were made: *Update In-betweens* makes keys
of them, and until then too no program may take them for generated ones and replace them. Those that were traced or followed are in `traced`
too, where their strokes have numbers. Numbers that only tweening gave are in `matches`. A stroke without a number, or with that of an earlier
stroke of its drawing, gets a new one in the document.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from ..blender import colours, holds, placement
from ..blender import grease_pencil as gp
from ..blender import strokes as st
from ..lines import doubts
from ..lines import drawings as dr
from ..lines import plan
from ..tween import breakdowns, moved_keys
from ..tween import keys as tween_keys
from ..tween import pairs as tween_pairs
from ..tween import records as tween_records
from . import drawn, spacings, stroke_fields
from .further import Further


@dataclass
class Written:
    """What a layer gives a document."""

    fields: dict[str, Any] = field(default_factory=dict)
    keys: int = 0
    traced: int = 0
    """Number of traced drawings."""
    between: int = 0
    lost: set[int] = field(default_factory=set)
    """Scene frames with a stroke that could not be written: one of its points has no place."""
    as_between: dict[str, set[int]] = field(default_factory=dict)
    """By layer the scene frames on which its traced strokes are in `in_betweens`."""
    as_traced: dict[str, set[int]] = field(default_factory=dict)
    """By layer the scene frames on which its in-betweens are in `traced`."""


def of(ob, pegs: set[str], size: tuple[int, int] | None = None) -> Written:
    """The drawings of the object's layer of lines in the form of a document. `pegs` are the names of the document's pegs, `size` is that of the
    picture where there is no footage."""
    if gp.find_layer(ob, ob.rototoon.lines_layer) is None:
        return Written()
    return OfLayer(ob, ob.rototoon.lines_layer, pegs, size).written()


def put(document: dict[str, Any], fields: dict[str, Any]) -> None:
    """Puts the drawings of a layer into a document, in the place of those that it has.

    Earlier versions kept the drawings of an imported document beside the layer. Those on other frames stay.
    """
    kept = document.get("drawings")
    before = {each["frame"]: each for each in kept if isinstance(each, dict) and type(each.get("frame")) is int} if isinstance(kept, list) else {}
    now = {each["frame"]: each for each in fields.get("drawings", ())}
    for name in drawn.FIELDS:
        document.pop(name, None)
    document.update(fields)
    if before.keys() - now.keys():
        every = before | now
        document["drawings"] = [every[frame] for frame in sorted(every)]
        # Pairs are those of neighbouring drawings.
        document.pop("pairs", None)


@dataclass
class _Sheet:
    """The strokes of a drawing."""

    content: st.Content
    strokes: dict[int, dict[str, Any]]
    """The fields of each stroke, by its index in Blender."""
    numbers: dict[int, int]
    """The number of each stroke, from 1."""

    @cached_property
    def carried(self) -> bool:
        """Whether strokes have their numbers since they were traced or followed."""
        lines, tracks = self.content.point.get(gp.LINE), np.repeat(self.content.strokes(gp.TRACK), self.content.sizes)
        return lines is not None and bool(((lines == tracks) & (tracks > 0)).any())

    @property
    def numbered(self) -> bool:
        """Whether any stroke has a number."""
        return bool((self.content.strokes(gp.TRACK) > 0).any())

    @property
    def tracks(self) -> list[int]:
        """The numbers of the document."""
        return [number - 1 for number in self.numbers.values()]


class OfLayer:
    """The drawings of one layer."""

    def __init__(self, ob, name: str, pegs: set[str], size: tuple[int, int] | None):
        self.name = name
        self._ob, self._pegs, self._offset = ob, pegs, ob.rototoon.frame_offset
        (self._drawn,) = dr.read(ob, [name], None)
        self._record = tween_records.read(ob.data).get(self._drawn.name, tween_records.Layer())
        self._adopt(gp.find_layer(ob, self._drawn.name))
        keys = {**self._drawn.keys, **dict.fromkeys(self._drawn.blank, dr.EMPTY)}
        contents = {**keys, **self._drawn.made, **self._drawn.other}
        mapper, palette = placement.Mapper(ob, contents, {}, [name], size), colours.palette(ob)
        self._keys = sorted(keys)
        layer = gp.find_layer(ob, self._drawn.name)
        self._ends = gp.ends(layer)
        self._record = moved_keys.followed(layer, self._record, self._keys).record
        for frame, marks in breakdowns.passed_on(layer, self._keys, self._adopted).items():
            for attribute, values in marks.values().items() if frame in self._drawn.keys else ():
                keys[frame].set_strokes(attribute, values)
        self._fresh = itertools.count(max(self._drawn.highest.values(), default=0) + 1)
        self._pieces: dict[tuple[int | None, int], int] = {}
        self._sheets: dict[int, _Sheet] = {}
        for frame, content in sorted(contents.items()):
            strokes = stroke_fields.written(ob, content, mapper.at(0, frame), palette)
            self._sheets[frame] = _Sheet(content, strokes, self._numbers(frame, content, strokes))
        self._further = Further(ob)
        low, high = plan.film(ob)
        self._held = {frame for frame in holds.read(ob.data, self._drawn.name) if low <= frame <= high}

    def _adopt(self, layer) -> None:
        """Counts in-betweens that the artist has changed as the artist's drawings."""
        self._adopted: set[int] = set()
        if self._drawn.other:
            self._adopted = self._drawn.other.keys() & set(tween_keys.frames_of(layer, self._record).edited)
            for frame in self._adopted:
                self._drawn.keys[frame] = self._drawn.other.pop(frame)

    def _numbers(self, frame: int, content: st.Content, strokes) -> dict[int, int]:
        """The number of each stroke. A copied stroke has its original's number; the second one counts as a new stroke."""
        tracks, taken, found = content.strokes(gp.TRACK).tolist(), {0}, {}
        for i in strokes:
            number = tracks[i] if tracks[i] not in taken else self._new(frame, i)
            taken.add(number)
            found[i] = number
        return found

    def _new(self, frame: int, index: int) -> int:
        """A new number. All in-betweens of two keys have the same strokes: a piece of a stroke has one number on all of them."""
        if frame not in self._drawn.other:
            return next(self._fresh)
        piece = max((key for key in self._keys if key < frame), default=None), index
        if piece not in self._pieces:
            self._pieces[piece] = next(self._fresh)
        return self._pieces[piece]

    def written(self) -> Written:
        fields = {
            "drawings": self._drawings(),
            "pairs": self._pairs(),
            "traced": self._traced(),
            "in_betweens": self._between(),
            "matches": self._matches(),
        }
        drawn = self._drawn
        traced = len(self._shown_as_traced.keys() - set(self._keys))
        return Written({k: v for k, v in fields.items() if v}, len(self._keys), traced, len(drawn.other), self.lost)

    # -- by frame ----------------------------------------------------------------------------------------------------

    @property
    def keys(self) -> list[int]:
        """The frames of the artist's drawings, rising."""
        return self._keys

    @property
    def frames(self) -> list[int]:
        """The frames of all drawings, rising."""
        return list(self._sheets)

    @property
    def traced(self) -> set[int]:
        """The frames that show a traced drawing, or one of the artist that was followed."""
        return set(self._shown_as_traced)

    @property
    def between(self) -> set[int]:
        """The frames of in-betweens."""
        return set(self._drawn.other)

    @property
    def highest(self) -> int:
        """The highest number of a stroke."""
        return max((number for sheet in self._sheets.values() for number in sheet.numbers.values()), default=0)

    @property
    def lost(self) -> set[int]:
        """Frames with a stroke that could not be written."""
        return {frame for frame, sheet in self._sheets.items() if len(sheet.strokes) < len(sheet.content.sizes)}

    def after(self, frame: int) -> int | None:
        """The frame of the next drawing of the artist."""
        return next((key for key in self._keys if key > frame), None)

    def _shown_on(self, frame: int) -> int | None:
        """The frame of the drawing that the layer shows on a frame; `None` also where a drawing has ended by itself."""
        drawn = max((each for each in self._sheets if each <= frame), default=None)
        return None if drawn is None or any(drawn < end <= frame for end in self._ends) else drawn

    def shown_as_traced(self, frame: int) -> list[dict[str, Any]]:
        """The strokes that the layer shows on a frame, in the form of traced ones."""
        drawn = self._shown_on(frame)
        return [] if drawn is None else self._numbered(drawn)

    def shown(self, frame: int) -> list[dict[str, Any]]:
        """The strokes that the layer shows on a frame, in the form of in-betweens."""
        drawn = self._shown_on(frame)
        if drawn is None:
            return []
        if drawn in self._drawn.other:
            return self._between_on(drawn)
        sheet, pegs = self._sheets[drawn], self._pegs if drawn == frame else set()
        return [{"track": sheet.numbers[i] - 1, **stroke, **self._more(sheet, i, pegs), "opacity": 1.0} for i, stroke in sheet.strokes.items()]

    def fields_of(self, key: int) -> dict[str, Any]:
        """The fields of a drawing of the artist but for its strokes."""
        drawing = next(each for each in self._drawings() if each["frame"] == key - self._offset)
        return {name: value for name, value in drawing.items() if name not in ("frame", "strokes")}

    def pairs_of(self, key: int) -> list[dict[str, Any]]:
        """The pairs of a drawing's strokes with those of the next one."""
        return [pair for pair in self._pairs() if pair["frame"] == key - self._offset]

    # -- the fields of a document ------------------------------------------------------------------------------------

    def _more(self, sheet: _Sheet, index: int, pegs: set[str]) -> dict[str, Any]:
        return self._further.of_stroke(int(sheet.content.strokes(gp.FIELDS)[index]), pegs)

    def _drawings(self) -> list[dict[str, Any]]:
        found = []
        for frame, after in itertools.zip_longest(self._keys, self._keys[1:]):
            fields = dict(self._further.of_drawing(frame - self._offset))
            # As Update In-betweens does: a span that a new key divides passes its choices on, and its spacing is divided.
            choices = self._record.choices(frame, after) if after is not None else None
            if choices is not None:
                spacing = spacings.written(choices, frame, after, fields.get("spacing", "smooth"))
                fields = {**fields, "spacing": spacing}
            if fields.get("spacing") in ("smooth", None):
                fields.pop("spacing", None)
            sheet = self._sheets[frame]
            strokes = [stroke | self._more(sheet, i, self._pegs) for i, stroke in sheet.strokes.items()]
            found.append({"frame": frame - self._offset, **fields, "strokes": strokes})
        return found

    def _pairs(self) -> list[dict[str, Any]]:
        found = []
        for frame, after in itertools.pairwise(self._keys):
            one, other = self._sheets[frame], self._sheets[after]
            places = [{index: k for k, index in enumerate(sheet.strokes)} for sheet in (one, other)]
            for i, j in tween_pairs.between(one.content, other.content):
                if i in places[0] and (j < 0 or j in places[1]):
                    found.append({"frame": frame - self._offset, "from": places[0][i], "to": places[1].get(j)})
        return found

    def _traced(self) -> list[dict[str, Any]]:
        return [{"frame": frame - self._offset, "strokes": self._numbered(shown)} for frame, shown in sorted(self._shown_as_traced.items())]

    @cached_property
    def _shown_as_traced(self) -> dict[int, int]:
        """By frame the drawing that it shows, where that is a traced one, or one of the artist that was followed."""
        found = {frame: frame for frame in self._sheets if frame in self._drawn.made or frame in self._keys and self._sheets[frame].carried}
        for frame in self._held - self._sheets.keys():
            before = self._shown_on(frame)
            if before in found:
                found[frame] = before
        return found

    def _numbered(self, frame: int) -> list[dict[str, Any]]:
        sheet, found = self._sheets[frame], []
        # What the artist drew is beyond doubt.
        points = sheet.content.point.get(gp.CONFIDENCE) if frame in self._drawn.made else None
        sure = doubts.of_strokes(points, sheet.content.starts).round(3)
        for i, stroke in sheet.strokes.items():
            found.append({"track": sheet.numbers[i] - 1, **stroke})
            if sure[i] < 1:
                found[-1]["confidence"] = float(sure[i])
        return found

    def _between(self) -> list[dict[str, Any]]:
        return [{"frame": frame - self._offset, "strokes": self._between_on(frame)} for frame in sorted(self._drawn.other)]

    def _between_on(self, frame: int) -> list[dict[str, Any]]:
        sheet, strokes = self._sheets[frame], []
        seen, full = _opacities(sheet.content), self._full(frame)
        # A shape without a line fades by its fill.
        fill = sheet.content.strokes("fill_opacity")
        for i, stroke in sheet.strokes.items():
            number = sheet.numbers[i]
            share = fill[i] if stroke.get("fill") and not seen[i] else seen[i] / max(full.get(number, 1.0), 1e-6)
            share = round(float(np.clip(share, 0.0, 1.0)), 4)
            # Pegs have moved it already.
            strokes.append({"track": number - 1, **stroke, **self._more(sheet, i, set()), "opacity": share})
        return strokes

    def _full(self, frame: int) -> dict[int, float]:
        """By number the opacity of strokes that do not fade: that on the keys around a frame."""
        around = max((k for k in self._keys if k < frame), default=None), min((k for k in self._keys if k > frame), default=None)
        found: dict[int, float] = {}
        for sheet in (self._sheets[key] for key in around if key is not None):
            for i, value in enumerate(_opacities(sheet.content)):
                number = sheet.numbers.get(i, 0)
                found[number] = max(found.get(number, 0.0), float(value))
        return found

    def _matches(self) -> list[dict[str, Any]]:
        """The numbers of keys that tweening has numbered."""
        found = []
        for frame, after in itertools.pairwise(self._keys):
            one, other = self._sheets[frame], self._sheets[after]
            if one.numbered and other.numbered and not (one.carried and other.carried):
                tracks = [one.tracks, other.tracks]
                found.append({"frame": frame - self._offset, "next": after - self._offset, "tracks": tracks})
        return found


def _opacities(content: st.Content) -> np.ndarray:
    """The mean opacity of each stroke."""
    points, some = content.point.get("opacity"), content.sizes > 0
    found = np.ones(len(content.sizes))
    if points is not None and some.any():
        found[some] = np.add.reduceat(points.astype(np.float64), content.starts[:-1][some]) / content.sizes[some]
    return found

"""Further fields of a document's drawings and strokes, which the strokes of Blender have no place for: a stroke's peg, a drawing's corner.

The object keeps them as JSON: those of drawings by picture number, and those of strokes as a list, each kind once. A stroke has the number
of its fields, so they stay with it when strokes are moved, copied or deleted.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from ..common import kept


class Further:
    """The further fields of an object's drawings."""

    def __init__(self, ob):
        found = kept.fields(ob.rototoon.drawn_extra)
        self.drawings = kept.fields(found.get("drawings"))
        strokes = found.get("strokes")
        self._strokes: list[dict[str, Any]] = [kept.fields(each) for each in strokes] if isinstance(strokes, list) else []

    def number(self, fields: dict[str, Any]) -> int:
        """The number of a stroke's fields, from 1; 0 if there are none."""
        if not fields:
            return 0
        if fields not in self._strokes:
            self._strokes.append(fields)
        return self._strokes.index(fields) + 1

    def of_stroke(self, number: int, pegs: set[str]) -> dict[str, Any]:
        """The fields of a number. A peg that is none of `pegs` is left out."""
        found = dict(self._strokes[number - 1]) if 0 < number <= len(self._strokes) else {}
        if found.get("peg") not in pegs:
            found.pop("peg", None)
        return found

    def of_drawing(self, picture: int) -> Mapping[str, Any]:
        """The fields of a drawing."""
        return kept.fields(self.drawings.get(str(picture)))

    def store(self, ob) -> None:
        """Keeps them with the object."""
        drawings = {picture: fields for picture, fields in self.drawings.items() if fields}
        some = drawings or self._strokes
        ob.rototoon.drawn_extra = json.dumps({"drawings": drawings, "strokes": self._strokes}) if some else ""

"""Frames on which a part can probably not be seen, as its tracks say. The parts keep them.

Nearer parts or the edge of the picture hide it there, so its contour is a guess, and the part often needs none. Only the artist knows: it is a question, which
`rototoon.hide_unseen` answers. Frames are pictures here, and scene frames in what is told.

Documents do not hold them: for those that come in, also from a farm, the library finds them again from the tracks.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from rototoon import RototoonError, Unseen

from ..common import kept
from ..common.wording import counted, listed
from . import absence, sessions

NAMED = 3
"""Largest number of parts that a message tells. The panel tells all."""


@dataclass(frozen=True)
class Question:
    """A part that can probably not be seen on some scene frames."""

    index: int
    """Its place in the object's list of parts."""
    part: str
    """Its name."""
    frames: tuple[int, ...]
    """They rise. There is at least one."""

    def __str__(self) -> str:
        return f'"{self.part}" can probably not be seen on {listed(list(self.frames))}'


def note(ob, found: Iterable[Unseen]) -> None:
    """Stores with an object's parts what a run found. They are known by name there."""
    note_pictures(ob, {entry.part: entry.frames for entry in found})


def note_pictures(ob, pictures: Mapping[str, Iterable[int]]) -> None:
    """The same, for pictures by the names of parts."""
    for item in ob.rototoon.parts:
        put(item, pictures.get(item.name, []))


def of_document(project: Mapping[str, Any]) -> dict[str, list[int]]:
    """The pictures on which parts of a document can probably not be seen, by the names of these parts."""
    try:
        # Pictures are not read, so it does not matter where they are.
        with sessions.make(project, ".") as session:
            return {entry.part: entry.frames for entry in session.unseen()}
    except RototoonError:
        # It is a question only: what comes in is there without it.
        return {}


def put(part, pictures: Iterable[int]) -> None:
    """Stores with a part the pictures on which it can probably not be seen."""
    pictures = sorted(set(pictures))
    text = json.dumps(pictures) if pictures else ""
    if part.unseen != text:
        part.unseen = text


def stored(part) -> list[int]:
    """The pictures that `put` stored. A text that is damaged has none."""
    pictures = kept.fields(f'{{"pictures": {part.unseen or "[]"}}}').get("pictures")
    good = isinstance(pictures, list) and all(type(picture) is int for picture in pictures)
    return sorted(set(pictures)) if good else []


def of(part) -> list[int]:
    """The pictures on which a part can probably not be seen, and is not marked as hidden yet."""
    return [picture for picture in stored(part) if not absence.is_hidden(part, picture)]


def questions(ob) -> list[Question]:
    """The parts of an object that can probably not be seen on some frames."""
    offset = ob.rototoon.frame_offset
    found = ((index, item.name, tuple(picture + offset for picture in of(item))) for index, item in enumerate(ob.rototoon.parts))
    return [Question(*entry) for entry in found if entry[2]]


def told(ob) -> list[str]:
    """What a message says of an object's parts."""
    said = [f"{question}: if so, hide it there" for question in questions(ob)]
    more = len(said) - NAMED
    return said[:NAMED] + ([f"{counted(more, 'more part')} that can probably not be seen, in the panel Track"] if more > 0 else [])

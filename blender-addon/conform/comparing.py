"""Both footages compared by the library, and the fields of the object's document for the new one."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from rototoon import Conformed, Session
from rototoon.fills import Recolour

from ..blender import footage, stage
from ..capture import document, ends, exchanged, unseen
from ..common import jobs, kept
from ..exchange import files, further
from ..paint import recolours
from .times import Pictures, Times

make: Callable[[dict[str, Any], str], Any] = Session.from_document
"""Makes a session from a document and its folder. Tests replace it."""


LEAST_SCALE = 0.01
"""The least scale that the library takes."""


@dataclass(frozen=True)
class Asked:
    """What is known of the new footage beside its pictures."""

    scale: float | None = None
    """Pixels of the new picture for each pixel of the old one; `None` if it is to be found."""
    shift: tuple[float, float] | None = None
    """The place of the old picture's corner in the new one, in pixels."""
    frame_offset: int | None = None
    """What is added to the numbers of pictures. Then no pictures are compared."""

    def options(self) -> dict[str, Any]:
        """As the library takes it."""
        return {"scale": self.scale, "shift": self.shift, "frame_offset": self.frame_offset}


@dataclass
class Compared:
    """What the library found."""

    found: Conformed
    document: dict[str, Any] = field(default_factory=dict)
    """The fields for the new footage."""
    recolours: list[Recolour] = field(default_factory=list)
    """The colours that become others, on frames of the new footage."""


def pictures_of(ob) -> Pictures:
    """The numbers of an object's pictures."""
    settings = ob.rototoon
    return Pictures(settings.first, settings.last, settings.frame_offset)


def worker(ob, shot: stage.Shot, asked: Asked) -> jobs.Worker:
    """The comparison of an object's footage with a new one, in a thread. Its result is a `Compared`."""
    settings = ob.rototoon
    # Without a comparison the old pictures may be gone.
    pattern = footage.pattern_of(ob) if asked.frame_offset is None else footage.absolute(ob, settings.pattern)
    known = kept.fields(settings.extra)
    known["rototoon"] = document.VERSION
    known["footage"] = kept.fields(known.get("footage")) | footage.fields(ob, pattern)
    known["parts"] = [_part(item, settings.first) for item in settings.parts]
    known["recolours"] = recolours.fields(ob)
    folder, options = os.path.dirname(pattern), asked.options()
    options |= {"frames": (shot.first, shot.last), "fps": shot.fps, "hold_gaps": shot.hold_gaps}

    def compare(progress) -> Compared:
        progress(0.0, "reading the pictures")
        session = make(known, folder)
        try:
            found = session.conform(shot.pattern, progress=progress, **options)
            return Compared(found, session.document(), session.recolours())
        finally:
            session.close()

    return jobs.Worker(compare)


def _part(item, frame: int) -> dict[str, Any]:
    """The fields of a part that Blender has no place for. Its contours are moved as strokes, so a key stands in for them."""
    points = [[float(k), float(k % 2)] for k in range(max(item.count, 3))]
    fields = {name: value for name, value in kept.fields(item.extra).items() if name != "limbs"}
    return {**fields, "name": item.name, "closed": item.closed, "depth": item.depth, "keys": {str(frame): points}}


def put(ob, compared: Compared, times: Times) -> None:
    """Gives an object and its parts the fields for the new footage."""
    settings = ob.rototoon
    settings.extra = files.unknown_of_document(compared.document)
    for item, entry in zip(settings.parts, compared.document["parts"], strict=True):
        item.extra = files.unknown_of_part(entry)
        there = ((times.picture(picture), reason) for picture, reason in ends.of(item))
        ends.put(item, [(picture, reason) for picture, reason in there if picture is not None])
        asked = (times.picture(picture) for picture in unseen.stored(item))
        unseen.put(item, [picture for picture in asked if picture is not None])
    moved = [(a, b, [times.picture(picture) for picture in pictures]) for a, b, pictures in exchanged.rows_of(ob)]
    exchanged.put(ob, [(a, b, [picture for picture in pictures if picture is not None]) for a, b, pictures in moved])
    if compared.recolours or recolours.entries(ob):
        recolours.take(ob, compared.recolours)
    more = further.Further(ob)
    if more.drawings:
        there = {times.picture(int(picture)): fields for picture, fields in more.drawings.items()}
        more.drawings = {str(picture): fields for picture, fields in there.items() if picture is not None}
        more.store(ob)

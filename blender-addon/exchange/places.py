"""Whether everything of a document has a place where an object is to get it. Import asks before it removes what the object has: what is on the
layers is replaced, so an error half way would leave neither."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from rototoon.documents import by_frame

from ..blender.placement import Mapper
from ..lines import plane
from . import drawn, filled
from .looks import Looks

_SNAPPED, _LINES, _FILLS = range(1, 4)


def need(ob, project: dict[str, Any], looks: Looks) -> None:
    """Raises a `Problem` if there is no camera, or a point has no place on the drawing plane. The object has the document's footage already. `looks` tell
    the layers of its parts."""
    settings = ob.rototoon
    names = [settings.contours_layer, settings.snapped_layer, settings.lines_layer, settings.fills_layer]
    names += sorted({look.layer for look in looks.parts.values()} - {settings.contours_layer})
    home = {entry["name"]: names.index(looks.layer_of(entry["name"], settings.contours_layer)) for entry in project.get("parts", [])}
    found = [(layer, frame + settings.frame_offset, points) for layer, frame, points in _places(project, home)]
    frames = {frame for _, frame, _ in found}
    planes = {**looks.planes, settings.lines_layer: plane.points(ob, settings.lines_layer), settings.fills_layer: plane.points(ob, settings.fills_layer)}
    shown = {index: planes[name] for index, name in enumerate(names) if name in planes}
    # Contours are placed on the frames between their keys too.
    mapper = Mapper(ob, range(min(frames), max(frames) + 1) if frames else (), shown, names)
    for layer, frame, points in found:
        mapper.at(layer, frame).to_layer(np.asarray(points, np.float64))


def _places(project: dict[str, Any], home: dict[str, int]) -> Iterator[tuple[int, int, Any]]:
    """Layer, picture number and pixels of all that a document has."""
    for entry in project.get("parts", []):
        for name in ("keys", "tracks"):
            yield from ((home[entry["name"]], frame, points) for frame, points in by_frame(entry.get(name)).items())
        for frame, segments in by_frame(entry.get("curves")).items():
            yield from ((_SNAPPED, frame, path) for path in segments)
    film = drawn.checked(project)
    for drawings in (film.keys, film.traced, film.between):
        yield from ((_LINES, frame, stroke.points) for frame, strokes in drawings.items() for stroke in strokes)
    clicks, regions = filled.read(project)
    yield from ((_FILLS, frame, [click.at]) for frame, own in clicks.items() for click in own)
    yield from ((_FILLS, frame, loop) for frame, own in regions.items() for region in own for loop in region.loops)

"""What one run asks the library: the artist's clicks as a document, and which frames are painted. Changes nothing."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..blender import colours, fill_materials, footage, guard
from ..blender import grease_pencil as gp
from ..blender.errors import Problem
from ..blender.placement import Mapper
from ..common.wording import listed
from ..lines import plan as lines_plan
from ..lines import plane
from . import clicks, painted, recolours, sheets

NOTHING = (
    "No region is filled yet: go to a drawing and press Paint Bucket, or fill its regions with Blender's Fill tool on the layer "
)


@dataclass
class Plan:
    """A run: what the library gets, and what is written."""

    layer: str
    document: dict[str, Any]
    folder: str
    first: int
    """First scene frame that is painted."""
    last: int
    offset: int
    """The scene shows picture n on frame n + offset."""
    mapper: Mapper
    clicks: dict[int, list[clicks.Click]] = field(default_factory=dict)
    """The artist's clicks by scene frame."""
    palette: painted.Palette = field(default_factory=painted.Palette)
    sums: dict[int, int] = field(default_factory=dict)
    """Checksums of the artist's strokes, to see whether they change during the work."""
    hold: bool = True
    """Whether a frame with the same picture as the one before holds its drawing."""
    held: set[int] = field(default_factory=set)
    """The scene frames of such pictures, once they are known."""

    edges: set[int] = field(default_factory=set)
    """Scene frames on which a colour may differ from the frame before, though the picture is the same."""

    @property
    def pictures(self) -> tuple[int, int]:
        """The numbers of the first and the last picture."""
        return self.first - self.offset, self.last - self.offset


def layer_name(ob) -> str:
    """The name of the layer with paint. Raises a `Problem` if the layer may not be written, or is for something else."""
    name = ob.rototoon.fills_layer
    if name in taken_names(ob):
        raise Problem(f'The layer "{name}" is for lines or contours: give paint a layer of its own, in the panel Paint')
    guard.need_apart(ob, [name])
    return name


def taken_names(ob) -> tuple[str, ...]:
    """Names that the layer with paint can't have."""
    settings = ob.rototoon
    return "", settings.lines_layer, settings.snapped_layer, settings.contours_layer


def make(ob, name: str, first: int, last: int) -> Plan:
    """A plan for the scene frames `first` to `last` and the layer `name`."""
    pattern, offset = footage.pattern_of(ob), ob.rototoon.frame_offset
    low, high = lines_plan.film(ob)
    first, last = max(first, low), min(last, high)
    if first > last:
        raise Problem(f"There are no pictures on these frames: the footage is on frames {low} to {high}")
    drawn = sheets.read(ob, name)
    plan = Plan(name, {}, os.path.dirname(pattern), first, last, offset, mapper_of(ob, name, drawn, range(low, high + 1)))
    plan.sums = {frame: sheet.sum() for frame, sheet in drawn.items() if len(sheet.own)}
    for frame, sheet in drawn.items():
        if low <= frame <= high and len(sheet.own):
            _add(ob, plan, frame, sheet)
    if not plan.clicks:
        raise Problem(_why_nothing(name, drawn, low, high))
    fills = [{"frame": frame - offset, "regions": clicks.asked(own)} for frame, own in sorted(plan.clicks.items())]
    shown = footage.fields(ob, pattern)
    plan.document = {"rototoon": lines_plan.VERSION, "footage": shown, "parts": [], "fills": fills}
    changing = recolours.fields(ob)
    if changing:
        plan.document["recolours"] = changing
        plan.palette.add_materials(ob, [entry.new for entry in recolours.entries(ob).values()])
    plan.edges = recolours.edges(ob)
    if (first, last) != (low, high):
        # The library gives regions the numbers that they have on other frames, and no other region gets one of these.
        plan.document["filled"] = _known(ob, plan.mapper, {frame: sheet for frame, sheet in drawn.items() if low <= frame <= high}, offset)
    return plan


def _known(ob, mapper: Mapper, drawn: dict[int, sheets.Sheet], offset: int) -> list[dict[str, Any]]:
    """The regions that frames have, with their numbers and colours."""
    palette, found = colours.palette(ob), []
    for frame, sheet in sorted(drawn.items()):
        content = sheet.content
        seen = colours.of_strokes(ob, content, palette).clip(0, 1).round(6).tolist()
        names, numbers = fill_materials.names_of_strokes(ob, content), content.strokes(gp.TRACK).tolist()
        painted_ones = np.flatnonzero((content.strokes(gp.TRACK) > 0) & ~fill_materials.are_bare(ob, content))
        outlines = {}
        for shape in sheets.shapes_of(ob, content, mapper.at(0, frame), painted_ones):
            loops = sheets.loops_of(shape)
            outlines[shape.strokes[0]] = loops[0].tolist() if loops else []
        rest = set(numbers[i] for i in painted_ones) - {numbers[i] for i in outlines}
        # A shape that cannot be read has a number all the same.
        outlines |= {i: [] for i in painted_ones.tolist() if numbers[i] in rest}
        regions = [
            {"outline": outline, "track": numbers[i] - 1, "colour": seen[i]} | ({"name": names[i]} if names[i] else {})
            for i, outline in sorted(outlines.items())
        ]
        found.append({"frame": frame - offset, "regions": regions})
    return found


def _add(ob, plan: Plan, frame: int, sheet: sheets.Sheet) -> None:
    found = clicks.of(ob, sheet, plan.mapper.at(0, frame), ob.rototoon.height)
    for click in found:
        plan.palette.add(click, sheet.content)
    if found:
        plan.clicks[frame] = found


def _why_nothing(name: str, drawn: dict[int, sheets.Sheet], low: int, high: int) -> str:
    own = [frame for frame, sheet in drawn.items() if len(sheet.own)]
    outside = [frame for frame in own if not low <= frame <= high]
    if outside:
        return f'The shapes on the layer "{name}" are on {listed(outside)}: the footage is on frames {low} to {high}'
    if own:
        return f'The strokes on the layer "{name}" have no fill: give their material a fill, or use Paint Bucket'
    return f'{NOTHING}"{name}"'


def mapper_of(ob, name: str, drawn: dict[int, sheets.Sheet], frames) -> Mapper:
    """The mapping of a layer with paint."""
    points = [sheet.content.point["position"] for sheet in drawn.values() if len(sheet.made)]
    points = [each[np.isfinite(each).all(1)] for each in points]
    return Mapper(ob, frames, {0: np.concatenate(points) if points else plane.points(ob, name)}, [name])

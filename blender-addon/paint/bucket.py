"""Paint Bucket: one click fills the region of the picture, as a shape of the artist.

Shapes that the bucket made on the drawing and nobody has changed since are drawn again with each click: a click of another colour into a
region that leaks parts it, and the shape before must give way.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from rototoon.fills import Leak

from ..blender import camera, colours, fill_materials, footage, guard
from ..blender import grease_pencil as gp
from ..blender import strokes as st
from ..blender.errors import Problem
from ..blender.line_materials import encoded
from ..common import polygons
from ..lines import plan as lines_plan
from ..lines import properties
from . import clicks, filling, painted, shapes, sheets
from . import plan as pl

MOSTLY = 0.9
"""Share of a shape within a region from which the shape is that region's, and gives way to a new click."""


@dataclass(frozen=True)
class Before:
    """What a click changed: to take it back."""

    frame: int
    content: st.Content | None
    """The drawing before; `None` if there was none."""
    kind: str
    after: int
    """Checksum of the artist's strokes after the click."""
    told: str = ""
    """What the artist should know of the region at once."""


def paint(ob, frame: int, place: tuple[float, float], colour: tuple[float, ...] | None, sensitivity: float) -> Before:
    """Fills the region at a place of the picture (footage pixels) with a colour (sRGB); `None` says that it stays without paint. Raises a
    `Problem` on a line."""
    guard.need(ob)
    name = pl.layer_name(ob)
    pattern = footage.pattern_of(ob)
    low, high = lines_plan.film(ob)
    if not low <= frame <= high:
        raise Problem(f"There is no picture on frame {frame}: the footage is on frames {low} to {high}")
    drawn = sheets.read(ob, name)
    frame = _shown(footage.fields(ob, pattern), drawn, frame, ob.rototoon.frame_offset)
    mapping = pl.mapper_of(ob, name, drawn, [frame]).at(0, frame)
    sheet = drawn.get(frame) or sheets.Sheet(st.of_rows(painted.rows(ob, [], mapping, painted.Palette())), np.zeros(0, bool), gp.KEYFRAME)
    own = clicks.of(ob, sheet, mapping, ob.rototoon.height)
    chosen = None if colour is None else tuple(np.round(colour, 6).tolist())
    new = clicks.Click((float(place[0]), float(place[1])), chosen, -1, _name(ob, own, chosen))
    regions, leak = _regions(ob, pattern, frame, [*own, new], sensitivity)
    if _at(regions, new.at) is None:
        raise Problem("There is a line here, or no picture: click inside of a region")
    _write(ob, name, frame, sheet, mapping, regions, own, new)
    after = sheets.read(ob, name)[frame].sum()
    return Before(frame, sheet.content if frame in drawn else None, sheet.kind, after, _told(leak))


def _name(ob, own: list[clicks.Click], colour: tuple[float, ...] | None) -> str | None:
    """The name of the colour of a new click: the one that was taken last, that of an earlier click, or that of the object's material."""
    if colour is None:
        return None
    names, looks = fill_materials.names_of(ob), colours.palette(ob)[:, 1, :3]
    alike = np.abs(encoded(looks) - colour).max(1) <= fill_materials.SAME
    found = [name for name, same in zip(names, alike) if same and name is not None]
    if ob.rototoon.fill_name in found:
        return ob.rototoon.fill_name
    # The artist may have made another material of this colour: it is no colour of paint yet.
    used = (click.name for click in own if click.name in found)
    return next(used, None) or next((name for name in found if fill_materials.is_paint(name)), None)


def take_back(ob, before: Before) -> None:
    """Brings a drawing back as it was before a click. Raises a `Problem` if something else has changed it since."""
    name = ob.rototoon.fills_layer
    layer, drawn = gp.find_layer(ob, name), sheets.read(ob, name)
    if before.frame not in drawn or drawn[before.frame].sum() != before.after:
        raise Problem(f"The drawing on frame {before.frame} has changed since the click: leave with Esc, and undo there")
    guard.need_open([layer])
    if before.content is None:
        gp.remove_frames(layer, [before.frame])
    else:
        st.write(gp.drawings(layer)[before.frame][0], before.content)
        gp.set_keyframe_type(layer, {before.frame: before.kind})
    ob.data.update_tag()


def _shown(pictures: dict[str, Any], drawn: dict[int, sheets.Sheet], frame: int, offset: int) -> int:
    """The frame of the drawing that is painted: the one that is shown, if its picture is the same."""
    shown = max((each for each in drawn if each <= frame), default=frame)
    if shown == frame or shown < frame - MOST_HELD:
        return frame
    held = lines_plan.held_pictures(pictures, shown, frame, offset)
    return shown if held.issuperset(range(shown + 1, frame + 1)) else frame


MOST_HELD = 100
"""Most frames that a held drawing is looked for."""


def _told(leak: Leak | None) -> str:
    if leak is None:
        return ""
    gap = f"a gap of about {max(leak.width, 1):.0f} px in its outline at ({leak.gap[0]:.0f}, {leak.gap[1]:.0f})"
    if leak.parted:
        return f"{gap} was closed"
    width, height = leak.size
    filled = f"{width} × {height} px up to the picture's edge are filled through {gap}"
    return f"{filled}: if that is not meant, undo, or click around it with No Paint"


def _stand_in(taken: Iterable[tuple[float, ...] | None]) -> tuple[float, ...]:
    """A colour that no click has: that of regions without paint, whose outlines are wanted too."""
    used = set(taken)
    return next(own for own in ((k / 4096, 0.5, 1.0) for k in range(4097)) if own not in used)


def _regions(ob, pattern: str, frame: int, own: list[clicks.Click], sensitivity: float) -> tuple[list[painted.Region], Leak | None]:
    """The regions of clicks, and whether the last one leaks."""
    number = frame - ob.rototoon.frame_offset
    bare = _stand_in(click.colour for click in own)
    asked = [replace(click, colour=bare) if click.colour is None else click for click in own]
    fills = [{"frame": number, "regions": clicks.asked(asked)}]
    shown = footage.fields(ob, pattern)
    document = {"rototoon": lines_plan.VERSION, "footage": shown, "parts": [], "fills": fills}
    session = filling.make(document, os.path.dirname(pattern))
    try:
        found = session.fill(None, sensitivity, (number, number), leave_out=properties.left_out(ob.rototoon))
        leak = next((leak for leak in found.leaking if leak.click == len(asked) - 1), None)
        return filling.regions_on(found, number), leak
    finally:
        session.close()


def _at(regions: list[painted.Region], place: tuple[float, float]) -> painted.Region | None:
    """The region at a place. Regions of a picture do not lie over each other."""
    return next((region for region in regions if polygons.inside(region.loops, np.array([place]))[0]), None)


def _write(ob, name: str, frame: int, sheet: sheets.Sheet, mapping, regions, own: list[clicks.Click], new: clicks.Click) -> None:
    target = _at(regions, new.at)
    again = [click for click in own if _is_buckets(sheet.content, click.stroke) and _at(regions, click.at) not in (None, target)]
    stale = {click.stroke for click in again} | _within(ob, sheet, mapping, target)
    rest = st.chosen(sheet.content, [i for i in range(len(sheet.made)) if i not in stale])
    asked = [*again, new]
    palette = painted.Palette()
    for click in own:
        palette.add(click, sheet.content)
    drawn = [_own_region(_at(regions, click.at), click) for click in asked]
    rows = painted.rows(ob, drawn, mapping, palette, rest.strokes("fill_id").tolist())
    rows.values[gp.MADE] = np.zeros(len(asked), bool)
    # The library has numbered this frame alone. Fill Drawings gives the new shape its number.
    numbers = sheet.content.strokes(gp.TRACK)
    rows.values[gp.TRACK] = np.array([*(numbers[click.stroke] for click in again), 0], np.int32)
    rows.values[gp.CLICK] = np.array([(*click.at, 1.0) for click in asked], np.float32)
    layer = filling.layer_of(ob, name)
    gp.make_frames(layer, [frame], gp.KEYFRAME)
    st.write(gp.drawings(layer)[frame][0], st.joined(rest, st.of_rows(rows)))
    if sheet.kind == gp.GENERATED:
        gp.set_keyframe_type(layer, {frame: gp.KEYFRAME})
    ob.data.update_tag()


def _own_region(region: painted.Region, click: clicks.Click) -> painted.Region:
    colour = None if click.colour is None else np.array(click.colour)
    return painted.Region(region.number, region.outline, region.holes, colour, name=click.name)


def _is_buckets(content: st.Content, stroke: int) -> bool:
    """Whether the bucket made a stroke, and it is where the bucket put it."""
    tracked, span = content.point.get(gp.TRACKED), slice(*content.starts[stroke : stroke + 2])
    same = tracked is not None and np.array_equal(tracked[span], content.point["position"][span])
    return bool(content.strokes(gp.CLICK)[stroke][2] > 0 and same)


def _within(ob, sheet: sheets.Sheet, mapping, region: painted.Region) -> set[int]:
    """The strokes of a drawing that fill only this region: a new click replaces them. Small shapes that the artist drew within it stay."""
    found: set[int] = set()
    for shape in sheets.shapes_of(ob, sheet.content, mapping, range(len(sheet.made))):
        places = shapes.middles(shape.loops)
        if not len(places) or polygons.inside(region.loops, places).mean() < MOSTLY:
            continue
        first = shape.strokes[0]
        if sheet.made[first] or _is_buckets(sheet.content, first) or region.covered([shape]):
            found.update(shape.strokes)
    return found


def pixel_of(ob, frame: int, start: np.ndarray, way: np.ndarray) -> tuple[float, float]:
    """The pixel of the footage that a ray of the world meets on the drawing plane."""
    name = ob.rototoon.fills_layer
    mapping = pl.mapper_of(ob, name, sheets.read(ob, name), [frame]).at(0, frame)
    back = np.linalg.inv(camera.layer_to_world(ob, gp.find_layer(ob, name)))
    start, way = back[:3, :3] @ start + back[:3, 3], back[:3, :3] @ way
    along = float(way @ mapping.normal)
    if abs(along) < 1e-9:
        raise Problem("The drawing plane is seen edge-on: look through the camera (numpad 0)")
    x, y = mapping.to_pixels(start + way * (((mapping.point - start) @ mapping.normal) / along))
    return float(x), float(y)


def colour_at(ob, frame: int, place: tuple[float, float]) -> tuple[float, ...] | None:
    """The colour of the paint at a place (footage pixels) on a frame; `None` if there is none, and an empty one if a shape says that none is
    wanted."""
    found = taken_at(ob, frame, place)
    return None if found is None else found[0]


def taken_at(ob, frame: int, place: tuple[float, float]) -> tuple[tuple[float, ...], str] | None:
    """The same with the name of the colour, which may be empty."""
    name = ob.rototoon.fills_layer
    drawn = sheets.read(ob, name)
    shown = max((each for each in drawn if each <= frame), default=None)
    if shown is None:
        return None
    content = drawn[shown].content
    mapping = pl.mapper_of(ob, name, drawn, [frame]).at(0, frame)
    names = fill_materials.names_of_strokes(ob, content)
    seen, bare = colours.of_strokes(ob, content, colours.palette(ob)), fill_materials.are_bare(ob, content)
    for shape in reversed(sheets.shapes_of(ob, content, mapping, range(len(content.sizes)))):
        if polygons.inside(shape.loops, np.array([place], np.float64))[0]:
            first = shape.strokes[0]
            return ((), "") if bare[first] else (tuple(seen[first].clip(0, 1).tolist()), names[first] or "")
    return None

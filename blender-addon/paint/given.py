"""Clicks and regions that a document gives, as a layer with paint.

A region in which a click has the region's colour is a shape of the artist; all others are generated. A click without a region is a small
disc: Fill Drawings paints its region, or leaves it without paint if the click has no colour.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from rototoon.fills import Click

from ..blender import grease_pencil as gp
from ..blender import guard, holds
from ..blender import strokes as st
from ..blender.placement import Mapper
from ..common import polygons
from ..lines import plane
from . import filling, painted, sheets

DISC = 0.008
"""Radius of a disc, as a share of the picture's height."""


def need_open(ob) -> None:
    """Raises a `Problem` if the layer with paint may not be written."""
    guard.need_apart(ob, [ob.rototoon.fills_layer])


def draw(ob, clicks: Mapping[int, Sequence[Click]], regions: Mapping[int, list[painted.Region]]) -> int:
    """Draws clicks and regions by scene frame, in the place of all generated drawings. The artist's drawings stay. Returns the number of
    frames."""
    name = ob.rototoon.fills_layer
    drawn, layer = sheets.read(ob, name), filling.layer_of(ob, name)
    shown = {0: plane.points(ob, name)}
    kept = {frame for frame, sheet in drawn.items() if len(sheet.own) or sheet.blank}
    gp.remove_frames(layer, sorted(drawn.keys() - kept))
    frames = sorted((clicks.keys() | regions.keys()) - kept)
    mapper, palette = Mapper(ob, frames, shown, [name]), painted.Palette()
    held = [frame for frame in frames if mapper.still and _is_held(frame, frames, clicks, regions)]
    frames = [frame for frame in frames if frame not in set(held)]
    gp.make_frames(layer, frames, gp.GENERATED)
    handles, own = gp.drawings(layer), {}
    for frame in frames:
        asked, found = clicks.get(frame, ()), list(regions.get(frame, ()))
        shown = [_clicked(click, found, ob.rototoon.height) for click in asked]
        rest = [region for region in found if not any(region is each for each in shown)]
        if asked:
            own[frame] = gp.KEYFRAME
        _write(ob, handles[frame][0], mapper.at(0, frame), palette, rest, shown, asked)
    gp.set_keyframe_type(layer, own)
    holds.note(ob.data, name, held, frames)
    ob.data.update_tag()
    return len(frames) + len(held)


def _is_held(frame: int, frames: Sequence[int], clicks: Mapping, regions: Mapping[int, list[painted.Region]]) -> bool:
    """Whether a frame has no click and the regions of the frame before, in all that a document says of them: the library found that the pictures
    show the same drawing."""
    if frame in clicks or frame - 1 not in frames or not {frame - 1, frame} <= regions.keys():
        return False
    one, other = ([_content(region) for region in regions[each]] for each in (frame - 1, frame))
    return one == other


def _content(region: painted.Region) -> tuple:
    return region.number, region.confidence, tuple(region.colour), *(np.asarray(loop).tobytes() for loop in region.loops)


def _clicked(click: Click, regions: list[painted.Region], height: int) -> painted.Region:
    """The region of a click, or a disc."""
    place, colour = np.array([click.at]), None if click.colour is None else np.array(click.colour)
    for region in regions if colour is not None else ():
        same = region.name == click.name if click.name else np.abs(region.colour - colour).max() < SAME
        if same and polygons.inside(region.loops, place)[0]:
            return region
    turn = 2 * np.pi * np.arange(12) / 12
    return painted.Region(0, place + DISC * height * np.stack([np.cos(turn), np.sin(turn)], 1), [], colour, name=click.name)


SAME = 1e-4
"""Largest difference of equal colours."""


def _write(ob, handle, mapping, palette, rest: list[painted.Region], shown: list[painted.Region], asked: Sequence[Click]) -> None:
    # Two clicks may be in one region.
    once = {id(region): (region, click) for region, click in zip(shown, asked)}
    made = painted.rows(ob, rest, mapping, palette)
    own = painted.rows(ob, [region for region, _ in once.values()], mapping, palette, made.values.get("fill_id", np.zeros(0)).tolist())
    count = len(once)
    own.values[gp.MADE] = np.zeros(count, bool)
    own.values[gp.CLICK] = np.array([(*click.at, 1.0) for _, click in once.values()], np.float32).reshape(count, 3)
    own.values[gp.CONFIDENCE] = np.ones(int(own.sizes.sum()), np.float32)
    st.write(handle, st.joined(st.of_rows(made), st.of_rows(own)))

"""Traced strokes and painted regions that are in doubt: the list of them, and how the 3D view shows them.

A doubtful stroke is a black line with a yellow one in it, a lost one has red: so they show on white paper, on dark paint and on the
colours of strokes. The stroke to which Next Doubtful Stroke went is twice as wide.
"""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np

from ..blender import camera, guard, marks
from ..blender import grease_pencil as gp
from ..blender import strokes as st
from ..lines import doubts
from ..paint import doubts as regions
from ..paint import shapes, sheets


@dataclass(frozen=True)
class Marked:
    """A stroke that is marked."""

    points: np.ndarray
    """(N, 3) in the world. A closed one ends where it begins."""
    lost: bool
    chosen: bool
    """Whether Next Doubtful Stroke went to it."""


def marked(ob, frame: int) -> list[Marked]:
    """The strokes of an object that are in doubt on a frame. Strokes that the artist changed are not, unless they lie on no line of the picture."""
    settings, found = ob.rototoon, []
    for layer in st.drawn_layers(ob, active=False):
        shown = gp.shown(layer, frame)
        if guard.is_hidden(layer) or shown is None:
            continue
        at, handle, kind = shown
        traced = kind == gp.GENERATED and gp.has(handle, gp.LINE) and gp.has(handle, gp.CONFIDENCE)
        if not traced and (kind == gp.GENERATED or not gp.has(handle, gp.OFF_INK)):
            continue
        here = settings.doubt_layer == layer.name and settings.doubt_frame == at
        of_drawing = _of_traced if traced else _of_own
        found += of_drawing(handle, camera.layer_to_world(ob, layer), settings.doubt_number if here else 0)
    return found


def _of_own(handle, matrix: np.ndarray, number: int) -> list[Marked]:
    """The strokes of a drawing of the artist that lie on no line of the picture."""
    starts = gp.offsets(handle)
    verdict = np.where(gp.value(handle, gp.OFF_INK, len(starts) - 1), doubts.DOUBTFUL, doubts.SURE)
    return _lines(handle, matrix, number, verdict, np.diff(starts) > 1)


def _of_traced(handle, matrix: np.ndarray, number: int) -> list[Marked]:
    starts = gp.offsets(handle)
    total, count = int(starts[-1]), len(starts) - 1
    points = gp.positions(handle, total)
    moved = (gp.value(handle, gp.TRACKED, total) != points).any(1)
    changed = np.concatenate([[0], np.cumsum(moved)])
    verdict = doubts.verdicts(doubts.of_strokes(gp.value(handle, gp.CONFIDENCE, total), starts))
    wanted = gp.value(handle, gp.MADE, count) & (changed[starts[1:]] == changed[starts[:-1]])
    return _lines(handle, matrix, number, verdict, wanted & (np.diff(starts) > 1))


def _lines(handle, matrix: np.ndarray, number: int, verdict: np.ndarray, wanted: np.ndarray) -> list[Marked]:
    """The wanted strokes of a drawing that are not sure."""
    starts = gp.offsets(handle)
    points, count = gp.positions(handle, int(starts[-1])), len(starts) - 1
    cyclic, tracks = gp.value(handle, "cyclic", count), gp.value(handle, gp.TRACK, count)
    found = []
    for i in np.flatnonzero(wanted & (verdict != doubts.SURE)):
        line = points[starts[i] : starts[i + 1]] @ matrix[:3, :3].T + matrix[:3, 3]
        line = np.concatenate([line, line[:1]]) if cyclic[i] else line
        found.append(Marked(line, bool(verdict[i] == doubts.LOST), bool(tracks[i] == number)))
    return found


def marked_regions(ob, frame: int) -> list[Marked]:
    """The painted regions of an object whose colour is probably wrong on a frame. Regions that the artist changed are not."""
    settings = ob.rototoon
    layer = gp.find_layer(ob, settings.fills_layer)
    shown = None if layer is None or guard.is_hidden(layer) else gp.shown(layer, frame)
    if shown is None:
        return []
    at, handle, kind = shown
    if not gp.has(handle, gp.CONFIDENCE):
        return []
    sheet, matrix = sheets.of_drawing(handle, kind, marks.Slots(ob.data)), camera.layer_to_world(ob, layer)
    starts, numbers = sheet.content.starts, sheet.content.strokes(gp.TRACK)
    chosen = settings.fill_doubt_number if settings.fill_doubt_frame == at else 0
    found = []
    for i in regions.of_sheet(sheet):
        points = sheet.content.point["position"][starts[i] : starts[i + 1]]
        for loop in shapes.parted(points):
            line = points[np.append(loop, loop[:1])] @ matrix[:3, :3].T + matrix[:3, 3]
            found.append(Marked(line, True, bool(numbers[i] == chosen)))
    return found


class ROTOTOON_MT_doubts(bpy.types.Menu):
    """The strokes that are in doubt. They are looked for when the menu opens, so the list is never an old one."""

    bl_idname = "ROTOTOON_MT_doubts"
    bl_label = "Doubtful Strokes"

    def draw(self, context):
        """Called by Blender."""
        layout, ob = self.layout, context.object
        found = doubts.summed(doubts.places(ob)) if gp.is_drawing(ob) else []
        if not found:
            layout.label(text="No stroke is in doubt")
        for doubt in found[:LISTED]:
            entry = layout.operator("rototoon.next_doubt", text=str(doubt), icon="ERROR" if doubt.lost else "QUESTION")
            entry.layer, entry.number = doubt.layer, doubt.number
        if len(found) > LISTED:
            layout.label(text=f"{len(found) - LISTED} more")


LISTED = 40
"""Most entries of the list."""

CLASSES = (ROTOTOON_MT_doubts,)

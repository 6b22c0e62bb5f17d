"""Make Part: traced strokes that bound a part become its contour."""

import bpy
import numpy as np

from ...blender import grease_pencil as gp
from ...blender import guard, placement, selection, stroke_lines, stroke_rows
from ...blender import strokes as st
from ...blender.errors import Problem
from ...capture import contours, document, identity
from ...common.operators import Guarded
from ...common.wording import counted
from .. import outline
from .tracing_base import OnFootage

TOLERANCE = 0.6
"""Greatest distance of the contour from the strokes, in pixels of a picture of 540 lines or less."""
SPACING = 24.0
"""Greatest distance between two control points, likewise."""
GAP = 6.0
"""A gap between two strokes that is said, likewise."""


class ROTOTOON_OT_make_part(Guarded, OnFootage, bpy.types.Operator):
    bl_idname = "rototoon.make_part"
    bl_label = "Make Part"
    bl_description = (
        "Join the selected strokes, which bound a part, into one closed contour, as a key for Track. Order and direction do not matter. "
        "The strokes stay. On a hidden layer of contours too (hidden layers are written), not on a locked one"
    )
    bl_options = {"REGISTER", "UNDO"}

    name: bpy.props.StringProperty(name="Name", description="Name of the new part. Empty: the next free one", default="")
    numbers: bpy.props.StringProperty(
        name="Numbers", description="Numbers of the strokes, separated by commas, for scripts. Empty: the selected strokes", default=""
    )

    def run(self, context) -> str:
        ob, frame = context.object, context.scene.frame_current
        settings = ob.rototoon
        guard.need_named(ob, [settings.contours_layer], hidden=True)
        wanted = self._wanted()
        layers = st.drawn_layers(ob, active=False)
        # Edit Mode keeps the selection of layers on which it neither shows nor selects anything.
        reachable = layers if wanted else guard.open_layers(layers)
        found = _strokes(ob, frame, reachable, wanted)
        if not found and wanted:
            raise Problem(f"numbers: found {self.numbers!r}, expected numbers of strokes on frame {frame}")
        if not found:
            where = " on layers that are neither hidden nor locked" if _strokes(ob, frame, layers, wanted) else ""
            raise Problem(f"No strokes are selected{where}: select the strokes around the part in Edit Mode, then press Make Part")
        unit = max(settings.height / 540, 1.0)
        contour, gap = outline.joined(found)
        contour = outline.thinned(contour, TOLERANCE * unit, SPACING * unit)
        if len(contour) < 3:
            raise Problem("The selected strokes enclose nothing")
        if any(closed for _, closed in found) and len(found) > 1:
            rest = len(found) - 1
            self.warn(
                f"{counted(rest, 'stroke')} {'is' if rest == 1 else 'are'} not used: a closed stroke is a contour by itself, and of several the longest counts"
            )
        if gap > GAP * unit:
            self.warn(f"the largest gap between two strokes is {gap:.0f} pixels: look at the contour there")
        name = self.name.strip()
        if name in {part.name for part in settings.parts}:
            raise Problem(f'There is a part "{name}" already: choose another name')
        index = _draw(ob, frame, contour)
        reading = document.read(ob)
        identity.write(ob, reading.found, reading.decisions)
        ob.data.update_tag()
        part = _part_of(reading.found, settings.contours_layer, frame, index)
        item = next(each for each in settings.parts if each.number == part.number)
        for doubt in reading.decisions.doubts:
            self.warn(doubt)
        if not any(part is each for each in reading.decisions.created):
            unused = f'. The name "{name}" is not used' if name else ""
            return f'The strokes fit "{item.name}", which has a contour already: this is its key on frame {frame}{unused}'
        item.name = name or item.name
        return f'"{item.name}" is a new part with {len(contour)} control points'

    def _wanted(self) -> set[int] | None:
        try:
            return {int(text) for text in self.numbers.split(",")} if self.numbers.strip() else None
        except ValueError as error:
            raise Problem(f"numbers: found {self.numbers!r}, expected whole numbers, separated by commas") from error


def _strokes(ob, frame: int, layers: list, wanted: set[int] | None) -> list[tuple[np.ndarray, bool]]:
    """Pixels of strokes on layers: of the selected ones, or of those with the wanted numbers."""
    found = []
    for layer in layers:
        shown = st.shown_frame(layer, frame)
        if shown is None:
            continue
        handle = gp.drawings(layer)[shown][0]
        content = st.read(handle)
        chosen = selection.selected_strokes(handle) if wanted is None else np.isin(content.strokes(gp.TRACK), sorted(wanted))
        if not chosen.any():
            continue
        mapping = placement.Mapper(ob, [frame], {}, [layer.name]).at(0, frame)
        closed = content.strokes("cyclic")
        for i, line in enumerate(stroke_lines.lines(content)):
            if chosen[i] and len(line) > 1 and np.isfinite(line).all():
                found.append((mapping.to_pixels(line), bool(closed[i])))
    return found


def _part_of(found: contours.Contours, layer: str, frame: int, index: int) -> contours.Part:
    """The part of which a stroke is the key."""
    place = found.layer_names.index(layer), index
    return next(part for part in found.parts if frame in part.keys and (part.keys[frame].layer, part.keys[frame].index) == place)


def _draw(ob, frame: int, contour: np.ndarray) -> int:
    """Adds the contour to the layer of the contours, on the plane of those that are there, as if the artist had drawn it. Returns its index in the
    drawing."""
    name = ob.rototoon.contours_layer
    layer = gp.layer(ob, name)
    found = contours.read(ob)
    mapping = document.mapper_on(ob, found, [frame]).at(found.layer_names.index(name), frame)
    gp.make_frames(layer, [frame], gp.KEYFRAME)
    rows = stroke_rows.Rows(np.array([len(contour)], np.int32))
    rows.values = {
        "position": mapping.to_layer(contour).astype(np.float32),
        "radius": gp.blank("radius", len(contour)),
        "opacity": gp.blank("opacity", len(contour)),
        "cyclic": np.array([True]),
        "material_index": np.zeros(1, np.int32),
        gp.PART: np.zeros(1, np.int32),
        gp.MADE: np.zeros(1, bool),
    }
    handle = gp.drawings(layer)[frame][0]
    stroke_rows.append(handle, rows)
    return len(gp.offsets(handle)) - 2


CLASSES = (ROTOTOON_OT_make_part,)

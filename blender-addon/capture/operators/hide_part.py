"""Part Is Hidden Here: a part has no contour on frames where the picture does not show it."""

import bpy
import numpy as np

from ...blender import grease_pencil as gp
from ...blender import guard, marks
from ...blender.errors import Problem
from ...common.operators import Guarded, OnContours
from ...common.wording import listed
from .. import absence, contours, doubt, live, snapping


class ROTOTOON_OT_hide_part(Guarded, OnContours, bpy.types.Operator):
    bl_idname = "rototoon.hide_part"
    bl_label = "Part Is Hidden Here"
    bl_description = (
        "Say that the picture does not show the part chosen in the list on this frame: Track then draws no contour of it here. "
        "Press again where it is hidden, and it is there again. Keys stay. On hidden layers too, not on locked ones"
    )
    bl_options = {"REGISTER", "UNDO"}

    frames: bpy.props.EnumProperty(
        name="Frames",
        description="Where the part is hidden, or there again",
        items=(
            ("CURRENT", "This Frame", "The current frame"),
            ("STRETCH", "This Stretch", "The frames around this one on which the part is lost or already hidden"),
        ),
    )

    def run(self, context) -> str:
        ob, frame = context.object, context.scene.frame_current
        item = active_part(ob)
        if item is None:
            raise Problem("Choose a part in the list first")
        picture = frame - ob.rototoon.frame_offset
        if not ob.rototoon.first <= picture <= ob.rototoon.last:
            raise Problem(f"Frame {frame} has no picture of the footage")
        found = contours.read(ob)
        part = found.part(item.number)
        need_open(ob, found, part)
        time = absence.time_of(item, picture)
        if frame in part.keys and time is None:
            raise Problem(f'"{item.name}" has a key on frame {frame}: remove the key first if the part is hidden here')
        if time is not None:
            absence.show(item, *(time if self.frames == "STRETCH" else (picture, picture)))
            live.note(ob)
            return f'"{item.name}" is there again' + ("" if ob.rototoon.live else ": press Track")
        return hide(self, ob, found, item, self._stretch(ob, part, frame) if self.frames == "STRETCH" else [picture])

    def _stretch(self, ob, part: contours.Part, frame: int) -> list[int]:
        """The pictures around a frame on which the part is lost."""
        lost = set(doubt.judged(ob, contours.read(ob, (gp.CONFIDENCE,))).of(part.number).lost)
        first = last = frame
        while first - 1 in lost:
            first -= 1
        while last + 1 in lost:
            last += 1
        return [number - ob.rototoon.frame_offset for number in range(first, last + 1)]


def need_open(ob, found: contours.Contours, part: contours.Part) -> None:
    """Raises `Problem` if the layer of a part's contours is locked."""
    guard.need_open([gp.find_layer(ob, found.layer_names[part.layer])], hidden=True)


def hide(operator: Guarded, ob, found: contours.Contours, item, pictures: list[int]) -> str:
    """Marks a part as hidden on some pictures, and removes its generated contours there. Returns what is to be told."""
    part = found.part(item.number)
    absence.hide(item, pictures)
    frames = [picture + ob.rototoon.frame_offset for picture in pictures]
    corrected = [number for number in frames if _is_corrected(found, part, number)]
    _remove(gp.find_layer(ob, found.layer_names[part.layer]), part.number, frames)
    _remove_snapped(operator, ob, part.number, frames)
    if corrected:
        operator.warn(f"your corrections of it on {listed(corrected)} are gone: Undo brings them back")
    ob.data.update_tag()
    live.note(ob)
    return f'"{item.name}" is hidden on {listed(frames)}'


def active_part(ob):
    """The part that is chosen in the list; `None` if there is none."""
    settings = ob.rototoon
    return settings.parts[settings.active_part] if settings.active_part < len(settings.parts) else None


def _is_corrected(found: contours.Contours, part: contours.Part, frame: int) -> bool:
    """Whether the artist has corrected the generated contour of a part on a frame."""
    stroke = part.made.get(frame)
    return stroke is not None and bool(found.drawings[stroke.layer, frame].corrected()[stroke.index])


def _remove_snapped(operator: Guarded, ob, number: int, frames: list[int]) -> None:
    """Removes the snapped and hidden lines of a part. Drawings there that are the artist's stay, and are named."""
    layers = [layer for layer in (gp.find_layer(ob, ob.rototoon.snapped_layer), snapping.aside(ob)) if layer is not None]
    shown = {layer.name: [frame for frame, (_, _, own) in _generated(layer, number, frames).items() if own.any()] for layer in layers}
    layers = [layer for layer in layers if shown[layer.name]]
    operator.warn(guard.left_out(layers))
    left = set()
    for layer in guard.open_layers(layers):
        snapping.keep_edited(ob, frames, layer)
        again = set(shown[layer.name]) & snapping.made_frames(layer)
        left.update(set(shown[layer.name]) - again)
        _remove(layer, number, sorted(again))
    if left:
        operator.warn(f"your snapped lines of it on {listed(sorted(left))} stay")


def _remove(layer, number: int, frames: list[int]) -> None:
    """Removes the generated strokes of a part. A drawing that is empty then stays, so that no earlier one shows there."""
    data, name = layer.id_data, layer.name
    # What Rototoon removes is no change by the artist.
    untouched = marks.untouched_frames(data, name) & set(frames)
    for handle, own in _made(layer, number, frames):
        gp.remove_strokes(handle, np.flatnonzero(own).tolist())
    marks.note(data, name, untouched)


def _made(layer, number: int, frames: list[int]) -> list[tuple]:
    """The drawings on some frames that have generated strokes of a part, each with which strokes these are."""
    found = _generated(layer, number, frames).values()
    # On an artist's frame on which every stroke is marked, the marks are old.
    return [(handle, own) for handle, kind, own in found if own.any() and (kind == gp.GENERATED or not own.all())]


def _generated(layer, number: int, frames: list[int]) -> dict[int, tuple]:
    """By frame the drawing, its keyframe type, and which of its strokes are generated ones of a part."""
    drawings, found = gp.drawings(layer), {}
    for frame in frames:
        if frame in drawings:
            handle, kind = drawings[frame]
            strokes = len(gp.offsets(handle)) - 1
            found[frame] = handle, kind, gp.value(handle, gp.MADE, strokes) & (gp.value(handle, gp.PART, strokes) == number)
    return found


CLASSES = (ROTOTOON_OT_hide_part,)

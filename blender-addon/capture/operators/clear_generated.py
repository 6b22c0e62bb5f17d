"""Clear Generated: removes generated frames."""

import bpy

from ...blender import grease_pencil as gp
from ...blender import guard
from ...common.operators import Guarded
from ...common.wording import counted, joined, stayed
from .. import exchanged, snapping, stand, unseen, writing
from ..polls import WithGenerated


class ROTOTOON_OT_clear_generated(Guarded, WithGenerated, bpy.types.Operator):
    bl_idname = "rototoon.clear_generated"
    bl_label = "Clear Generated"
    bl_description = "Remove the results of Track and Snap to Ink. Your keys stay, and so do locked and hidden layers"
    bl_options = {"REGISTER", "UNDO"}

    frames: bpy.props.EnumProperty(
        name="Frames",
        description="Where",
        items=(("ALL", "All", "All frames"), ("CURRENT", "Current", "The current frame")),
    )
    corrected: bpy.props.BoolProperty(
        name="Corrected Frames Too", description="Remove frames with your corrections too, and snapped drawings that you have changed", default=False
    )
    snapped: bpy.props.BoolProperty(name="Snapped Lines", description="Clear the snapped layer too", default=True)

    def run(self, context) -> str:
        ob, current = context.object, context.scene.frame_current
        layers = [(layer, not self.corrected) for layer in gp.layers(ob, ob.rototoon.contours_layer)]
        aside = snapping.aside(ob)
        snapped = [layer for layer in (gp.find_layer(ob, ob.rototoon.snapped_layer), aside) if layer is not None and self.snapped]
        layers += [(layer, False) for layer in snapped]
        every = [layer for layer, _ in layers if len(layer.frames)]
        guard.need_some(every)
        edited = set() if self.corrected else self._kept(ob, snapped, current)
        # Found before the drawings are gone from which the lines were cut.
        old = snapping.old_aside(ob)
        cleared, kept = 0, 0
        for layer, keep in layers:
            if guard.closed(layer):
                continue
            drawings = gp.drawings(layer)
            candidates = drawings if layer not in snapped else old if layer == aside else snapping.made_frames(layer)
            frames = [f for f in candidates if self.frames == "ALL" or f == current]
            if keep:
                kept += sum(writing.is_corrected(drawings[f][0]) for f in frames)
            cleared += writing.clear(layer, frames, keep_corrected=keep)
        if not stand.has_generated(ob):
            exchanged.put(ob, [])
            unseen.note(ob, [])
        ob.data.update_tag()
        self.warn(guard.left_out(every))
        said = f"{counted(cleared, 'generated drawing')} removed"
        return joined(said, f"{kept} with corrections kept" if kept else "", stayed("snapped drawing", edited))

    def _kept(self, ob, snapped: list, current: int) -> set[int]:
        """Makes snapped drawings that the artist changed the artist's. Returns their frames."""
        frames = None if self.frames == "ALL" else [current]
        return {number for layer in snapped if not guard.closed(layer) for number in snapping.keep_edited(ob, frames, layer)}


CLASSES = (ROTOTOON_OT_clear_generated,)

"""Clear Paint: removes generated regions."""

import bpy
import numpy as np

from ...blender import grease_pencil as gp
from ...blender import guard, holds
from ...common.operators import Guarded, OnDrawing
from ...common.wording import counted
from .. import sheets


class ROTOTOON_OT_clear_fills(Guarded, OnDrawing, bpy.types.Operator):
    bl_idname = "rototoon.clear_fills"
    bl_label = "Clear Paint"
    bl_description = "Remove the regions that Fill Drawings has painted. Your own shapes stay, and so do regions that you have changed"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def lacking(cls, ob, changes: str) -> str:
        """As `OnDrawing.lacking`."""
        why = super().lacking(ob, changes)
        return why or ("" if gp.find_layer(ob, ob.rototoon.fills_layer) else "Nothing is painted yet")

    def run(self, context) -> str:
        ob = context.object
        layer = gp.find_layer(ob, ob.rototoon.fills_layer)
        guard.need_open([layer])
        drawn, removed = sheets.read(ob, layer.name), 0
        mixed = {frame for frame, sheet in drawn.items() if len(sheet.own) and sheet.made.any()}
        gp.make_own(layer, mixed)
        handles = gp.drawings(layer)
        for frame, sheet in drawn.items():
            removed += int(sheet.made.sum())
            if frame in mixed:
                gp.remove_strokes(handles[frame][0], np.flatnonzero(sheet.made).tolist())
        empty = [frame for frame, sheet in drawn.items() if not len(sheet.own) and not sheet.blank]
        gp.remove_frames(layer, empty)
        holds.forget(ob.data, layer.name)
        ob.data.update_tag()
        return f"{counted(removed, 'painted region')} removed"


CLASSES = (ROTOTOON_OT_clear_fills,)

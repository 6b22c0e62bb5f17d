"""Clear Lines: removes traced drawings."""

import bpy

from ...blender import grease_pencil as gp
from ...blender import guard, holds, memo
from ...common.operators import Guarded, OnDrawing
from ...common.wording import counted, joined, stayed
from .. import aside, records
from .. import drawings as dr


class ROTOTOON_OT_clear_lines(Guarded, OnDrawing, bpy.types.Operator):
    bl_idname = "rototoon.clear_lines"
    bl_label = "Clear Lines"
    bl_description = (
        "Remove the drawings that Trace Drawing and Carry Strokes have made. Your own drawings stay, and so do traced drawings that "
        "you have changed"
    )
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def lacking(cls, ob, changes: str) -> str:
        """As `OnDrawing.lacking`."""
        why = super().lacking(ob, changes)
        return why or ("" if memo.kept(ob, any_traced) else "Nothing is traced yet")

    def run(self, context) -> str:
        ob = context.object
        wanted = [layer for layer in dr.layers(ob) if dr.is_lines(layer) and not aside.is_aside(ob, layer)]
        guard.need_some(wanted)
        self.warn(guard.left_out(wanted))
        kept, removed, edited = records.read(ob.data), 0, set()
        for found in dr.read(ob, [layer.name for layer in guard.open_layers(wanted)]):
            dr.keep(ob, found)
            aside.clear(ob, found.name, found.made)
            gp.remove_frames(gp.find_layer(ob, found.name), sorted(found.made))
            removed += len(found.made)
            edited |= found.edited
            kept.pop(found.name, None)
            holds.forget(ob.data, found.name)
        records.write(ob.data, kept)
        ob.data.update_tag()
        return joined(f"{counted(removed, 'traced drawing')} removed", stayed("traced drawing", edited))


def any_traced(ob) -> bool:
    """Whether a layer has traced drawings."""
    return any(dr.is_lines(layer) for layer in dr.layers(ob))


CLASSES = (ROTOTOON_OT_clear_lines,)

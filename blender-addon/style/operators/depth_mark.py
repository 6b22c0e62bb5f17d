"""In Front / Behind: the depth of parts in reshaped drawings."""

import bpy

from ...blender import guard
from ...blender.errors import Problem
from ...common.operators import Guarded, OnContours
from .. import limbs


class ROTOTOON_OT_depth_mark(Guarded, OnContours, bpy.types.Operator):
    bl_idname = "rototoon.depth_mark"
    bl_label = "In Front / Behind"
    bl_description = "Put one part in front of another when the drawing is reshaped. A few such marks are enough for all parts"
    bl_options = {"REGISTER", "UNDO"}
    changes = guard.SETTINGS

    front: bpy.props.StringProperty(name="In Front", description="Name of the part in front")
    behind: bpy.props.StringProperty(name="Behind", description="Name of the part behind it")

    def invoke(self, context, _event):
        settings = context.object.rototoon
        if 0 <= settings.active_part < len(settings.parts):
            self.front = settings.parts[settings.active_part].name
        return context.window_manager.invoke_props_dialog(self)

    def draw(self, context):
        for name in ("front", "behind"):
            self.layout.prop_search(self, name, context.object.rototoon, "parts")

    def run(self, context) -> str:
        ob = context.object
        names = [part.name for part in ob.rototoon.parts]
        for name in (self.front, self.behind):
            if name not in names:
                known = ", ".join(f'"{each}"' for each in names) or "no parts"
                raise Problem(f'No part "{name}"; the object has {known}')
        if self.front == self.behind:
            raise Problem(f'"{self.front}" cannot be in front of itself')
        limbs.add_mark(ob, {"front": self.front, "behind": self.behind})
        return f'"{self.front}" is in front of "{self.behind}"'


CLASSES = (ROTOTOON_OT_depth_mark,)

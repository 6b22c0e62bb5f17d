"""Recolour: a colour of paint becomes another one, from the current frame on."""

import bpy

from ...blender import fill_materials, guard, materials
from ...blender.errors import Problem
from ...common.operators import Guarded, OnDrawing
from ...common.wording import counted, listed
from .. import recolours

FRAMES = (
    ("FROM", "From This Frame On", "The current frame and all after it"),
    ("UP_TO", "Up to This Frame", "All frames before the current one, and the current one"),
    ("RANGE", "Range", "From the first to the last frame that you give"),
)


class ROTOTOON_OT_recolour(Guarded, OnDrawing, bpy.types.Operator):
    bl_idname = "rototoon.recolour"
    bl_label = "Recolour"
    bl_description = (
        "One material of the paint becomes another one from the current frame on, on all regions that have it: a coat that gets wet. Fill "
        "Drawings keeps it, and your own shapes stay as they are"
    )
    bl_options = {"REGISTER", "UNDO"}

    old: bpy.props.StringProperty(name="From", description="The material that the regions have. Without one it is the active one")
    new: bpy.props.StringProperty(name="To", description="The material that they get. Without one a material of the colour below is made")
    colour: bpy.props.FloatVectorProperty(
        name="Colour",
        description="The colour that they get, if there is no material for it yet",
        subtype="COLOR_GAMMA",
        size=3,
        min=0.0,
        max=1.0,
        default=(0.5, 0.5, 0.5),
    )
    frames: bpy.props.EnumProperty(name="Frames", description="On which frames", items=FRAMES)
    first: bpy.props.IntProperty(name="First", description="The first frame of a range", default=1)
    last: bpy.props.IntProperty(name="Last", description="The last frame of a range", default=1)

    def invoke(self, context, _event):
        """Called by Blender: asks for the materials."""
        active = context.object.active_material
        if not self.old and fill_materials.is_colour(active):
            self.old = active.name
        self.first = self.last = context.scene.frame_current
        return context.window_manager.invoke_props_dialog(self)

    def draw(self, context):
        """Called by Blender."""
        layout = self.layout
        layout.use_property_split = True
        layout.prop_search(self, "old", context.object.data, "materials")
        layout.prop_search(self, "new", bpy.data, "materials")
        colour = layout.column()
        colour.active = not self.new
        colour.prop(self, "colour")
        layout.prop(self, "frames")
        if self.frames == "RANGE":
            layout.prop(self, "first")
            layout.prop(self, "last")

    def run(self, context) -> str:
        ob, now = context.object, context.scene.frame_current
        first, last = {"FROM": (now, None), "UP_TO": (None, now), "RANGE": (self.first, self.last)}[self.frames]
        guard.need_named(ob, [ob.rototoon.fills_layer])
        entry = recolours.Entry(_old(ob, self.old), _new(ob, self.new, self.colour), first, last)
        done = recolours.add(ob, entry)
        names = recolours.names_of_own(ob)
        self.warn(recolours.told(recolours.unchanged([entry], names)))
        if done.waiting:
            self.warn(f"a drawing of yours is held on {listed(sorted(done.waiting))}: press Fill Drawings to change the colour there")
        if not any(entry.old.name in own for own in names.values()) and not done.regions:
            self.warn(f'nothing is painted with "{entry.old.name}"')
        return f"{entry.said()}: {counted(done.regions, 'region')} on {counted(len(done.frames), 'frame')}"


def _old(ob, name: str) -> bpy.types.Material:
    """The object's material of a name, or the active one."""
    if not name and ob.active_material is not None:
        return ob.active_material
    found = next((material for material in materials.of(ob) if material is not None and material.name == name), None)
    if found is None:
        raise Problem(f'"{ob.name}" has no material "{name}"' if name else "Choose the material that becomes another one")
    return found


def _new(ob, name: str, colour) -> bpy.types.Material:
    """The material of a name, or one for a colour."""
    if name:
        found = bpy.data.materials.get(name)
        if found is None:
            raise Problem(f'There is no material "{name}"')
        return found
    place = fill_materials.material(ob, colour)
    return materials.of(ob)[place]


CLASSES = (ROTOTOON_OT_recolour,)

"""Properties that a file keeps of an object's lines."""

from __future__ import annotations

import bpy

STYLES = (
    ("AUTO", "Auto", "Found from each drawing"),
    ("CLEAN", "Clean", "Each line is drawn once"),
    ("ROUGH", "Rough", "Lines are sketched with several strokes of the pencil, which become one"),
)


class LineSettings:
    """Settings of lines, in the property `rototoon` of every object."""

    lines_layer: bpy.props.StringProperty(name="Lines", description="Layer on which Trace Drawing draws", default="Lines")
    line_style: bpy.props.EnumProperty(name="Drawing", description="The kind of drawing that is traced", items=STYLES)
    line_sensitivity: bpy.props.FloatProperty(
        name="Sensitivity",
        description="Sensitivity to faint ink: with 2, ink may be half as dark as usual",
        default=1.0,
        min=0.1,
        max=10.0,
        soft_min=0.25,
        soft_max=4.0,
    )
    show_doubts: bpy.props.BoolProperty(
        name="Mark Doubtful Strokes",
        description="Draw strokes that may be another stroke in black and yellow, and those that probably are in black and red",
        default=True,
    )
    drawn_extra: bpy.props.StringProperty(description="Fields of the document's drawings and strokes that have no place in Blender, as JSON")
    doubt_frame: bpy.props.IntProperty(default=0)
    doubt_layer: bpy.props.StringProperty(default="")
    doubt_number: bpy.props.IntProperty(default=0)

"""Properties that a file keeps of an object's lines."""

from __future__ import annotations

import bpy

STYLES = (
    ("AUTO", "Auto", "Found from each drawing"),
    ("CLEAN", "Clean", "Each line is drawn once"),
    ("ROUGH", "Rough", "Lines are sketched with several strokes of the pencil, which become one"),
)


NON_PHOTO_BLUE = (0.643, 0.867, 0.929)


RED = (0.85, 0.2, 0.2)
Pencils = tuple[tuple[float, float, float], ...]


def left_out(settings) -> Pencils:
    """The colours of pencils whose lines are left out of lines and paint, in 256 steps: those of a batch's step."""
    return (_stepped(settings.line_left_out),) if settings.line_leave_out else ()


def left_out_of_lines(settings) -> Pencils:
    """The colours of pencils of which no strokes are made: those that are left out everywhere, and that of lines that only bound paint."""
    borders = (_stepped(settings.line_border),) if settings.line_paint_only else ()
    return tuple(dict.fromkeys(left_out(settings) + borders))


def _stepped(colour) -> tuple[float, float, float]:
    red, green, blue = (round(255 * value) / 255 for value in colour)
    return red, green, blue


def left_out_step(pencils: Pencils) -> dict[str, str]:
    """Pencils that are left out as an option of a batch's step."""
    colours = ["#" + "".join(f"{round(255 * value):02x}" for value in colour) for colour in pencils]
    return {"leave_out": ",".join(colours)} if colours else {}


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
    line_leave_out: bpy.props.BoolProperty(
        name="Leave Out",
        description="Leave out lines of a coloured pencil, such as construction lines, in its lighter and darker shades: they are neither "
        "strokes nor bounds of paint. Lines of other colours stay where they cross them",
        default=False,
    )
    line_left_out: bpy.props.FloatVectorProperty(
        name="Left Out",
        description="The pencil that is left out, as it looks on white paper",
        subtype="COLOR_GAMMA",
        size=3,
        min=0.0,
        max=1.0,
        default=NON_PHOTO_BLUE,
    )
    line_paint_only: bpy.props.BoolProperty(
        name="Paint Only",
        description="Make no strokes of lines of a coloured pencil that only bound paint, such as the border of a shadow. Paint Bucket and Fill "
        "Drawings see them",
        default=False,
    )
    line_border: bpy.props.FloatVectorProperty(
        name="Border",
        description="The pencil of lines that only bound paint, as it looks on white paper",
        subtype="COLOR_GAMMA",
        size=3,
        min=0.0,
        max=1.0,
        default=RED,
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

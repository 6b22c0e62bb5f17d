"""Properties that a file keeps of an object's footage and parts."""

from __future__ import annotations

import bpy

from . import closing, live, part_names

PRESETS = (
    (
        "rototoon",
        "Cartoon",
        "Follows each part as a textured lattice from both keys, and a part with one key as far as it can be trusted. "
        "The most exact method",
    ),
    (
        "zhou2011",
        "Contours and Regions",
        "Shapes, edges and colours of the regions over the whole time between two keys. As published by Zhou and Xiao, 2011",
    ),
    (
        "agarwala2004",
        "Rotoscope",
        "Shape, picture and edges over the whole time between two keys. As published by Agarwala and others, 2004",
    ),
    (
        "liang2012",
        "Rotoscope with Colour",
        "As Rotoscope, with a ribbon on both sides of the line and a penalty on colour. As published by Liang and others, 2012",
    ),
)
PLANES = (
    ("CAMERA", "Camera", "The camera shows the footage in its background"),
    ("REFERENCE", "Reference Image", "A reference image (an empty that shows an image) shows the footage"),
)
MOVED_LINES = (
    ("KEEP", "Keeps Its Shape", "Each of its points holds where you put it, as after turning or scaling the line"),
    (
        "SETTLE",
        "Settles",
        "Only its middle is corrected: Track looks for the part there, and takes its shape from the drawing. "
        "For lines that you push roughly to the right place",
    ),
)


def _is_image_empty(_self, ob) -> bool:
    return ob.type == "EMPTY" and ob.empty_display_type == "IMAGE"


def _is_camera(_self, ob) -> bool:
    return ob.type == "CAMERA"


def _layers_named(settings, _context) -> None:
    # A layer without a name is none: nothing could be drawn on it, and every layer's name would begin like it.
    for name in ("contours_layer", "snapped_layer"):
        if not getattr(settings, name).strip():
            setattr(settings, name, settings.bl_rna.properties[name].default)


def _closed(part, context) -> None:
    closing.follow(part, context)
    live.setting_changed(part, context)


def _named(part, _context) -> None:
    # Documents and masks know parts by their names. Blender numbers objects of one name in the same way.
    name = part.name.strip() or "Part"
    taken = {other.name for other in part.id_data.rototoon.parts if other.as_pointer() != part.as_pointer()}
    free = (name if k == 0 else f"{name}.{k:03}" for k in range(len(taken) + 1))
    name = next(each for each in free if each not in taken)
    if part.name != name:
        part.name = name
        return
    part_names.renamed(part)


class RototoonPart(bpy.types.PropertyGroup):
    """A contour that is tracked. Its strokes carry its number."""

    name: bpy.props.StringProperty(
        name="Name", description="Name of the part in documents and files of shapes. No other part of the object has it", update=_named
    )
    known_as: bpy.props.StringProperty(description="Name by which fields of the object's document, such as limbs, know the part")
    number: bpy.props.IntProperty(name="Number", description="Number that the part's strokes carry")
    depth: bpy.props.FloatProperty(
        name="Depth",
        description="Larger is nearer to the viewer. Nearer parts hide farther ones",
        default=0.0,
        update=live.setting_changed,
    )
    closed: bpy.props.BoolProperty(
        name="Closed",
        description="The last point joins the first. Closes or opens the part's lines on all frames, hidden layers too; "
        "locked ones are not changed",
        default=False,
        update=_closed,
    )
    count: bpy.props.IntProperty(name="Control Points", description="Number of control points on each frame", min=0)
    extra: bpy.props.StringProperty(description="Fields of the document that this version does not know, as JSON")
    ends: bpy.props.StringProperty(
        description="Where the track of a part with one key ends before the footage does: [[picture, reason], ...]"
    )
    unseen: bpy.props.StringProperty(description="Where the part can probably not be seen, as the last Track found: [picture, ...]")


class CaptureSettings:
    """Footage, parts and settings of tracking, in the property `rototoon` of every object."""

    pattern: bpy.props.StringProperty(
        name="Footage",
        description="Files of the picture sequence, with %d or %0Nd for the number",
        default="",
    )
    first: bpy.props.IntProperty(name="First", description="Number of the first picture", default=0)
    last: bpy.props.IntProperty(name="Last", description="Number of the last picture", default=0)
    width: bpy.props.IntProperty(name="Width", description="Width of the pictures in pixels", min=0)
    height: bpy.props.IntProperty(name="Height", description="Height of the pictures in pixels", min=0)
    fps: bpy.props.FloatProperty(name="Frame Rate", description="Pictures per second", default=24.0, min=0.01)
    frame_offset: bpy.props.IntProperty(
        name="Frame Offset", description="The scene shows picture n on frame n + offset", default=0
    )
    hold_gaps: bpy.props.BoolProperty(
        name="Hold Gaps",
        description="A frame without a file shows the picture before it, as in scans that are numbered by their exposure",
        default=False,
    )
    movie: bpy.props.StringProperty(name="Movie", description="The movie from which the pictures come", default="")
    plane: bpy.props.EnumProperty(name="Seen Through", description="What shows the footage in the scene", items=PLANES)
    camera: bpy.props.PointerProperty(
        name="Camera",
        description="Camera that shows the footage. If empty, the scene's camera",
        type=bpy.types.Object,
        poll=_is_camera,
    )
    reference: bpy.props.PointerProperty(
        name="Reference Image",
        description="Empty that shows the footage",
        type=bpy.types.Object,
        poll=_is_image_empty,
    )
    contours_layer: bpy.props.StringProperty(
        name="Contours",
        description="Layer with the contours. Layers whose name begins with this name and a dot or space count too",
        default="Contours",
        update=_layers_named,
    )
    snapped_layer: bpy.props.StringProperty(
        name="Snapped", description="Layer on which Snap to Ink draws", default="Snapped", update=_layers_named
    )
    preset: bpy.props.EnumProperty(
        name="Method", description="Method of tracking", items=PRESETS, update=live.setting_changed
    )
    live: bpy.props.BoolProperty(
        name="Live",
        description="Track by itself whenever you move a point or a part, or set, change or remove a key. "
        "Only what you changed is tracked again. One undo takes back your edit and its result",
        default=False,
        update=live.toggled,
    )
    show_confidence: bpy.props.BoolProperty(
        name="Show Confidence", description="Colour the tracked points by confidence: green is high, red is low", default=False
    )
    show_lost: bpy.props.BoolProperty(
        name="Mark Lost Contours", description="Draw contours that are probably wrong in black and red, on any background", default=True
    )
    moved_line: bpy.props.EnumProperty(
        name="Moved Line",
        description="What it means when you move a tracked line as a whole",
        items=MOVED_LINES,
        update=live.setting_changed,
    )
    show_pins: bpy.props.BoolProperty(
        name="Show Pins", description="Mark the points and centres that you fixed", default=True
    )
    parts: bpy.props.CollectionProperty(
        name="Parts", description="The parts, in the order of the list. Track and the keys make them", type=RototoonPart
    )
    exchanges: bpy.props.StringProperty(
        description="Parts that may have changed places where the last Track followed them: [[number, number, [picture, ...]], ...]"
    )
    active_part: bpy.props.IntProperty(
        name="Active Part", description="Index in the parts of the one that is chosen in the list. Operators for the chosen part work on it", default=0
    )
    next_number: bpy.props.IntProperty(default=1)
    # It tells contours of the object from those that were pasted from another one, whose parts have other numbers. 0: not known yet.
    stamp: bpy.props.IntProperty(default=0)

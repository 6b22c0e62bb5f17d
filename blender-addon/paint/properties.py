"""Properties that a file keeps of an object's paint."""

from __future__ import annotations

import bpy


class RototoonRecolour(bpy.types.PropertyGroup):
    """A material of paint that becomes another one on some scene frames."""

    old: bpy.props.PointerProperty(name="From", description="The material that the regions have", type=bpy.types.Material)
    new: bpy.props.PointerProperty(name="To", description="The material that they get", type=bpy.types.Material)
    has_first: bpy.props.BoolProperty(name="Has a First Frame", description="It does not hold on frames before", default=False)
    first: bpy.props.IntProperty(name="First", description="The first frame, if it has one", default=0)
    has_last: bpy.props.BoolProperty(name="Has a Last Frame", description="It does not hold on frames after", default=False)
    last: bpy.props.IntProperty(name="Last", description="The last frame, if it has one", default=0)


class RototoonPaletteColour(bpy.types.PropertyGroup):
    """A colour of the palette of a document."""

    material: bpy.props.PointerProperty(name="Material", description="The material of the colour", type=bpy.types.Material)


class FillSettings:
    """Settings of paint, in the property `rototoon` of every object."""

    fills_layer: bpy.props.StringProperty(
        name="Paint", description="Layer with the filled regions. Your own shapes on it say which region has which colour", default="Paint"
    )
    fill_colour: bpy.props.FloatVectorProperty(
        name="Colour",
        description="Colour of Paint Bucket. Each colour has one material: change its fill there, and it changes on all frames",
        subtype="COLOR_GAMMA",
        size=3,
        min=0.0,
        max=1.0,
        default=(0.93, 0.76, 0.62),
    )
    fill_name: bpy.props.StringProperty(
        name="Colour's Name",
        description="Name of the material that a Ctrl-click has taken. It counts as long as that material has the colour of Paint Bucket",
        default="",
    )
    fill_nothing: bpy.props.BoolProperty(
        name="No Paint",
        description="Paint Bucket says of a region that it stays without paint, on all drawings: paper that shows between a figure's limbs, or around it",
        default=False,
    )
    fill_confidence: bpy.props.FloatProperty(
        name="Least Confidence",
        description="Regions whose colour is less sure than this stay unpainted. At 0 all regions are painted",
        default=0.0,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
    )
    recolours: bpy.props.CollectionProperty(
        name="Recolours", description="Materials that become others on some frames, in their order. Recolour adds one", type=RototoonRecolour
    )
    palette: bpy.props.CollectionProperty(
        name="Palette",
        description="Colours that came with the palette of a document, whether something is painted with them or not",
        type=RototoonPaletteColour,
    )
    show_fill_doubts: bpy.props.BoolProperty(
        name="Mark Doubtful Regions",
        description="Draw a line in black and red around regions whose colour is probably wrong",
        default=True,
    )
    fill_doubt_frame: bpy.props.IntProperty(default=0)
    fill_doubt_number: bpy.props.IntProperty(default=0)

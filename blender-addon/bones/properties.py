"""Properties that a file keeps of an armature's key points."""

from __future__ import annotations

import bpy


class RototoonBone(bpy.types.PropertyGroup):
    """The place of a key point on an armature. `name` is the name of the key point."""

    bone: bpy.props.StringProperty(name="Bone", description="The bone of the key point")
    along: bpy.props.FloatProperty(
        name="Along",
        description="Place of the key point along the bone: 0 is the head, 1 the tail",
        default=0.0,
        min=0.0,
        max=1.0,
    )


class BoneSettings:
    """The bones of key points, in the property `rototoon` of every object."""

    bones: bpy.props.CollectionProperty(type=RototoonBone)

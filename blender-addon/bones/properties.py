"""What a file keeps of an armature's key points."""

from __future__ import annotations

import bpy


class RototoonBone(bpy.types.PropertyGroup):
    """Where on an armature a key point lies; `name` is the key point's."""

    bone: bpy.props.StringProperty(name="Bone", description="The bone that tells the key point")
    along: bpy.props.FloatProperty(
        name="Along",
        description="How far along the bone the key point lies: 0 at its head, 1 at its tail",
        default=0.0,
        min=0.0,
        max=1.0,
    )


class BoneSettings:
    """The bones of key points; a part of `rototoon` of every object."""

    bones: bpy.props.CollectionProperty(type=RototoonBone)

"""The settings of an object and of the window, put together from the rooms that they belong to."""

import bpy

from .bones.properties import BoneSettings, RototoonBone
from .capture.properties import CaptureSettings, RototoonPart
from .style import clip_browser
from .style.properties import ClipSettings, RototoonBrowser, RototoonClip


class RototoonSettings(BoneSettings, ClipSettings, CaptureSettings, bpy.types.PropertyGroup):
    """What a file keeps of an object beside its strokes."""

    extra: bpy.props.StringProperty(description="Fields of the document that this version does not know, as JSON")


CLASSES = (RototoonPart, RototoonBone, RototoonSettings, RototoonClip, RototoonBrowser)


def attach() -> None:
    """Gives every object its settings, and the window manager its list of clips; after registering the classes."""
    bpy.types.Object.rototoon = bpy.props.PointerProperty(type=RototoonSettings)
    bpy.types.WindowManager.rototoon_clips = bpy.props.PointerProperty(type=RototoonBrowser)


def detach() -> None:
    """Takes them away again; before unregistering the classes."""
    clip_browser.close()
    del bpy.types.WindowManager.rototoon_clips
    del bpy.types.Object.rototoon

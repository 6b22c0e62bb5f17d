"""The properties of objects and of the window. Each package defines its own; this file puts them together."""

import bpy

from .bones.properties import BoneSettings, RototoonBone
from .capture.properties import CaptureSettings, RototoonPart
from .lines.properties import LineSettings
from .paint.properties import FillSettings, RototoonPaletteColour, RototoonRecolour
from .style import clip_browser
from .style.properties import ClipSettings, RototoonBrowser, RototoonClip


class RototoonSettings(BoneSettings, ClipSettings, FillSettings, LineSettings, CaptureSettings, bpy.types.PropertyGroup):
    """Everything that a file keeps of an object beside its strokes."""

    extra: bpy.props.StringProperty(description="Fields of the document that this version does not know, as JSON")
    known_files: bpy.props.StringProperty(description="What the documents held from which the object was read, or to which it was written, as JSON")


CLASSES = (RototoonPart, RototoonBone, RototoonRecolour, RototoonPaletteColour, RototoonSettings, RototoonClip, RototoonBrowser)


def attach() -> None:
    """Adds the property `rototoon` to objects, and the list of clips to the window manager. The classes must be registered."""
    bpy.types.Object.rototoon = bpy.props.PointerProperty(type=RototoonSettings)
    bpy.types.WindowManager.rototoon_clips = bpy.props.PointerProperty(type=RototoonBrowser)


def detach() -> None:
    """Removes what is there of both. The classes must still be registered."""
    clip_browser.close()
    for kind, name in ((bpy.types.WindowManager, "rototoon_clips"), (bpy.types.Object, "rototoon")):
        if hasattr(kind, name):
            delattr(kind, name)

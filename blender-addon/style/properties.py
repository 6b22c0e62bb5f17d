"""What a file keeps of the library that an object uses, and what the window keeps of the list of clips."""

from __future__ import annotations

import bpy

from ..blender import windows
from . import clip_browser


def _offered_characters(_self, _context, text: str) -> list[str]:
    return clip_browser.offered(clip_browser.characters(), text)


def _offered_motions(_self, _context, text: str) -> list[str]:
    return clip_browser.offered(clip_browser.motions(), text)


def _in_view_changed(_self, _context) -> None:
    windows.redraw_views()


class RototoonClip(bpy.types.PropertyGroup):
    """A row of the list; `name` is what it is found by."""

    character: bpy.props.StringProperty(name="Character", description="Who moves")
    motion: bpy.props.StringProperty(name="Motion", description="What is done")
    frames: bpy.props.IntProperty(name="Frames", description="Number of postures")
    trouble: bpy.props.StringProperty(name="Trouble", description="Why the file cannot be used")


class RototoonBrowser(bpy.types.PropertyGroup):
    """The list."""

    folder: bpy.props.StringProperty(description="The library that is listed")
    clips: bpy.props.CollectionProperty(type=RototoonClip)
    active: bpy.props.IntProperty(name="Chosen Clip", default=0)
    character: bpy.props.StringProperty(
        name="Character",
        description="Show clips of characters whose name holds this",
        search=_offered_characters,
        search_options={"SUGGESTION"},
        options={"TEXTEDIT_UPDATE"},
    )
    motion: bpy.props.StringProperty(
        name="Motion",
        description="Show clips of motions whose name holds this",
        search=_offered_motions,
        search_options={"SUGGESTION"},
        options={"TEXTEDIT_UPDATE"},
    )
    in_view: bpy.props.BoolProperty(
        name="Show Beside Drawing",
        description="Let the chosen clip play beside the drawing, in the 3D view, with the scene's frames",
        default=False,
        update=_in_view_changed,
    )


def _clips_folder_changed(self, _context) -> None:
    clip_browser.refresh_for(self.id_data)


class ClipSettings:
    """The library of an object; a part of `rototoon` of every object."""

    clips_folder: bpy.props.StringProperty(
        name="Library",
        description="Folder of the library of skeleton clips; empty takes that of the preferences",
        subtype="DIR_PATH",
        default="",
        options={"ANIMATABLE", "PATH_SUPPORTS_BLEND_RELATIVE"},
        update=_clips_folder_changed,
    )

"""Properties: the library of an object, kept in the file, and the list of clips, kept in the window manager."""

from __future__ import annotations

from collections.abc import Callable

import bpy

from ..blender import windows
from . import clip_browser


def _filter(name: str, names: Callable[[], list[str]]):
    """A filter of the list that offers the names of the listed library."""
    return bpy.props.StringProperty(
        name=name,
        description=f"Show clips of {name.lower()}s whose name contains this text",
        search=lambda _self, _context, text: clip_browser.offered(names(), text),
        search_options={"SUGGESTION"},
        options={"TEXTEDIT_UPDATE"},
    )


def _in_view_changed(_self, _context) -> None:
    windows.redraw_views()


class RototoonClip(bpy.types.PropertyGroup):
    """A row of the list."""

    character: bpy.props.StringProperty(name="Character", description="The character who moves")
    motion: bpy.props.StringProperty(name="Motion", description="Name of the motion")
    frames: bpy.props.IntProperty(name="Frames", description="Number of postures")
    trouble: bpy.props.StringProperty(name="Trouble", description="Why the file cannot be used")


class RototoonBrowser(bpy.types.PropertyGroup):
    """The list of clips, its filter and the chosen clip."""

    folder: bpy.props.StringProperty(description="The listed library")
    clips: bpy.props.CollectionProperty(type=RototoonClip)
    active: bpy.props.IntProperty(name="Chosen Clip", default=0)
    character: _filter("Character", clip_browser.characters)
    motion: _filter("Motion", clip_browser.motions)
    in_view: bpy.props.BoolProperty(
        name="Show Beside Drawing",
        description="Play the chosen clip beside the drawing in the 3D view, with the scene's frames",
        default=False,
        update=_in_view_changed,
    )


def _clips_folder_changed(self, _context) -> None:
    clip_browser.refresh_for(self.id_data)


class ClipSettings:
    """The library, in the property `rototoon` of every object."""

    clips_folder: bpy.props.StringProperty(
        name="Library",
        description="Folder of the library of skeleton clips. If empty, the one in the preferences",
        subtype="DIR_PATH",
        default="",
        options={"ANIMATABLE", "PATH_SUPPORTS_BLEND_RELATIVE"},
        update=_clips_folder_changed,
    )

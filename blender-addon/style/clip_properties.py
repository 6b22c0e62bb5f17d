"""Properties that several operators have: a clip of the library, in whose manner it is re-made, and which library."""

from collections.abc import Callable
from typing import Any

import bpy

from ..rototoon.style import translate_clip
from ..rototoon.types import Progress
from . import clip_browser
from .clip_library import clips_of

PRESETS = (
    ("rototoon", "Rototoon", "Gaussian processes over style and posture"),
    ("bilinear", "Bilinear", "Tenenbaum & Freeman 2000, a style matrix for each character"),
    ("bilinear-symmetric", "Bilinear, Symmetric", "Tenenbaum & Freeman 2000, a style vector for each character"),
    ("liang2012", "Liang et al. 2012", "Non-negative factorisation"),
)


def _any_character(_self):
    return clip_browser.characters()


def _who_shows_it(self):
    return clip_browser.characters(self.motion)


def _any_motion(_self):
    return clip_browser.motions()


_SHARED = {
    "character": (
        bpy.props.StringProperty,
        {"name": "Character", "description": "Whose clip", "names": _who_shows_it},
    ),
    "motion": (
        bpy.props.StringProperty,
        {"name": "Motion", "description": "Which motion", "default": "walk", "names": _any_motion},
    ),
    "style": (
        bpy.props.StringProperty,
        {
            "name": "Style",
            "description": "The character in whose manner; empty takes the clip as it is",
            "names": _any_character,
        },
    ),
    "preset": (
        bpy.props.EnumProperty,
        {"name": "Method", "description": "How it is re-made", "items": PRESETS},
    ),
    "strength": (
        bpy.props.FloatProperty,
        {
            "name": "Strength",
            "description": "How thick the manner is laid on; 1 is the most probable",
            "default": 1.1,
            "min": 0,
            "max": 3,
        },
    ),
    "folder": (
        bpy.props.StringProperty,
        {"name": "Library", "description": "Another folder than the panel's", "subtype": "DIR_PATH"},
    ),
    "performer": (
        bpy.props.StringProperty,
        {"name": "Character", "description": "Who moves; empty takes the object's name"},
    ),
    "performed": (
        bpy.props.StringProperty,
        {"name": "Motion", "description": "What is done", "default": "walk"},
    ),
    "first": (
        bpy.props.IntProperty,
        {"name": "First", "description": "First frame of the scene", "default": 0},
    ),
    "last": (
        bpy.props.IntProperty,
        {"name": "Last", "description": "Last frame of the scene", "default": 0},
    ),
}
"""By what it is: which property, and how it is made."""


def shared(what: str, **other):
    """A property that several operators have; `other` is what one of them has otherwise. Among `names(operator)` a text may be
    chosen."""
    make, usual = _SHARED[what]
    how = {**usual, **other}
    if names := how.pop("names", None):
        how["search"] = lambda self, _context, text: clip_browser.offered(names(self), text)
        how["search_options"] = {"SORT", "SUGGESTION"}
    return make(**how)


class Performance:
    """Who does what in a clip that is saved, and from which frame on."""

    character: shared("performer")
    motion: shared("performed")
    first: shared("first")


class Manner:
    """In whose manner a clip is re-made, and how.

    Blender lists the properties of the base classes from the last to the first. So name this one first.
    """

    style: shared("style")
    preset: shared("preset")
    strength: shared("strength")

    def remake(self, folder: str, motion: str, content: str) -> Callable[[Progress, int], dict[str, Any]]:
        """A function of a progress callback and a number of threads that re-makes the motion of `content` in the manner of `style`.

        It may run in a thread: it has all that the operator says.
        """
        said = {"style": self.style, "motion": motion, "content": content, "preset": self.preset, "strength": self.strength}
        return lambda progress, threads: translate_clip(clips_of(folder), progress=progress, threads=threads, **said)

"""Properties that several operators have: a clip of the library, in whose manner, which library."""

import bpy

from .. import clip_browser

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

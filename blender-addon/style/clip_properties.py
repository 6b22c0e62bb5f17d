"""Properties of several operators: a clip of the library, the style in which it is re-made, and the library."""

from collections.abc import Callable
import bpy
from rototoon.style import Translated, translate_and_judge
from rototoon.types import Progress

from . import clip_browser
from .clip_library import clips_of

PRESETS = (
    ("rototoon", "Rototoon", "Gaussian processes over style and posture"),
    ("bilinear", "Bilinear", "Tenenbaum & Freeman 2000, a style matrix for each character"),
    ("bilinear-symmetric", "Bilinear, Symmetric", "Tenenbaum & Freeman 2000, a style vector for each character"),
    ("liang2012", "Liang et al. 2012", "Non-negative factorisation"),
)


def _any_human(_self):
    return clip_browser.characters(human=True)


def _who_shows_it(self):
    return clip_browser.characters(self.motion)


def _any_motion(_self):
    return clip_browser.motions()


_SHARED = {
    "character": (
        bpy.props.StringProperty,
        {"name": "Character", "description": "The character of the clip", "names": _who_shows_it},
    ),
    "motion": (
        bpy.props.StringProperty,
        {"name": "Motion", "description": "The motion of the clip", "default": "walk", "names": _any_motion},
    ),
    "style": (
        bpy.props.StringProperty,
        {
            "name": "Style",
            "description": "The character whose style the clip gets. If empty, the clip as it is",
            "names": _any_human,
        },
    ),
    "preset": (
        bpy.props.EnumProperty,
        {"name": "Method", "description": "Method that gives the clip the style", "items": PRESETS},
    ),
    "strength": (
        bpy.props.FloatProperty,
        {
            "name": "Strength",
            "description": "Strength of the style: 0 is none, the motion as it is. 1 is the most probable. A little more is recognised better. Only for "
            "the method Rototoon",
            "default": 1.1,
            "min": 0,
            "max": 3,
        },
    ),
    "folder": (
        bpy.props.StringProperty,
        {"name": "Library", "description": "A library instead of the one in the panel", "subtype": "DIR_PATH", "options": {"PATH_SUPPORTS_BLEND_RELATIVE"}},
    ),
    "performer": (
        bpy.props.StringProperty,
        {"name": "Character", "description": "The character who moves. If empty, the object's name"},
    ),
    "performed": (
        bpy.props.StringProperty,
        {"name": "Motion", "description": "Name of the motion", "default": "walk"},
    ),
    "replace": (
        bpy.props.BoolProperty,
        {
            "name": "Replace",
            "description": "Replace a clip of the same character and motion in the library. Otherwise nothing is saved where there is one",
            "default": False,
            # What was chosen once must not replace a clip without being chosen again.
            "options": {"SKIP_SAVE"},
        },
    ),
    "mirror": (
        bpy.props.EnumProperty,
        {
            "name": "Mirror",
            "description": "Whether the clip is mirrored, left for right",
            "items": [
                ("auto", "Automatic", "If what moves and the clip look to different sides"),
                ("on", "On", "Mirror the clip"),
                ("off", "Off", "Leave the clip as it is"),
            ],
            "default": "auto",
        },
    ),
    "first": (
        bpy.props.IntProperty,
        {"name": "First", "description": "First frame of the clip, in scene frames", "default": 0},
    ),
    "last": (
        bpy.props.IntProperty,
        {
            "name": "Last",
            "description": "Last frame of the clip, in scene frames. If it is not after the first, all tracked frames",
            "default": 0,
        },
    ),
}
"""By name: the kind of property, and its arguments."""


def shared(what: str, **other):
    """The property called `what`. `other` are arguments that differ. An argument `names(operator)` gives texts to choose from."""
    make, usual = _SHARED[what]
    how = {**usual, **other}
    if names := how.pop("names", None):
        how["search"] = lambda self, _context, text: clip_browser.offered(names(self), text)
        how["search_options"] = {"SORT", "SUGGESTION"}
    return make(**how)


def mirroring(looks: dict[str, str | None] | None, mirrored: bool) -> str:
    """What a report says about a clip that was mirrored, or perhaps should have been; empty if there is nothing to say.

    `looks` are the sides to which the drawing or the rig, and the clip, look; `None` if they did not decide it.
    """
    if looks is None or (not mirrored and None not in looks.values()):
        return ""
    sides = {who: side or "to a side that cannot be told" for who, side in looks.items()}
    first, second = (f"the {who} {'looks ' if not number else ''}{side}" for number, (who, side) in enumerate(sides.items()))
    return f"; {first} and {second}, so the clip {'is' if mirrored else 'is not'} mirrored: see Mirror"


class Performance:
    """Properties of a clip that is saved."""

    character: shared("performer")
    motion: shared("performed")
    first: shared("first")


class Manner:
    """The style in which a clip is re-made, and the method.

    Blender lists the properties of base classes from the last to the first. Put this one first among them.
    """

    style: shared("style")
    preset: shared("preset")
    strength: shared("strength")

    def remake(self, folder: str, motion: str, content: str) -> Callable[[Progress, int], Translated]:
        """A function of a progress callback and a number of threads. It re-makes the motion of `content` in the style of `style`.

        It may run in a thread, since it does not use the operator any more.
        """
        said = {"style": self.style, "motion": motion, "content": content, "preset": self.preset, "strength": self.strength}

        def made(progress: Progress, threads: int) -> Translated:
            clips = clips_of(folder, rate_of=(content, motion))
            return translate_and_judge(clips, progress=progress, threads=threads, **said)

        return made

"""Rototoon: follows the contours of drawn characters through a film. The Blender extension.

This file only registers. The code is in packages. The `__init__.py` of each package says what belongs there and what it may import:

====================  ==============================================================================
`rototoon`            the Python package; it needs no Blender. It is installed as a wheel, so it is imported by its own name
`blender`             Blender's data
`common`              what operators of all packages share
`capture`             contours: footage, keys, tracking, live, snapping
`strokes`             light curves and hidden lines, for any drawing
`tween`               drawings between keys
`lines`               line drawings as strokes, the same strokes on every frame
`paint`               regions of line drawings, filled on every frame
`style`               a character's motion given to another drawing
`bones`               armatures
`exchange`            documents and masks
`conform`             an object moved to footage that was delivered again
`farm`                many shots sent to a render farm, and their results
`sample`              a small cartoon to try everything on
`scripting`           functions for scripts, beside the operators
`ui`                  panels, lists, overlays, preferences
====================  ==============================================================================

`properties` puts the properties of the packages together. `handlers` runs when files are opened, saved and changed. `build` says which build it is.
"""

import sys


def _refuse_second_copy():
    """Raises an error while another copy of the extension is switched on, from another repository.

    Blender would take the classes of both for one, and call the handlers of both: paths of footage would be changed twice at each save.
    """
    import bpy

    place = ".capture.operators.track"
    operator = getattr(bpy.types, "ROTOTOON_OT_track", None)
    other = getattr(operator, "__module__", __package__ + place).removesuffix(place)
    if other != __package__:
        repository = other.removeprefix("bl_ext.").partition(".")[0]
        raise RuntimeError(
            f'Rototoon is switched on already, from the repository "{repository}": switch that copy off first, or remove one of the two'
        )


def _forget_older_modules():
    """Forgets modules of an earlier version, so that an update takes effect while Blender runs.

    Blender imports this file once, and again after an update. It forgets the extension's own modules then, but not if that version could not be
    switched on, and never those of a wheel, the package `rototoon`.
    """
    is_own = getattr(sys.modules.get("rototoon"), "of_extension", False)
    for name in list(sys.modules):
        if name.startswith(f"{__package__}.") or (is_own and name.partition(".")[0] == "rototoon"):
            del sys.modules[name]
    import rototoon

    rototoon.of_extension = True
    _need_same_build(rototoon)


def _need_same_build(package):
    """Raises an error if the Python package is of another build, which may know other functions, or find other contours without a word.

    A script may have imported its own before, or one is found earlier on the search path; or Blender could not replace an older one, whose library runs.
    """
    from pathlib import Path

    from .build import BUILD

    found = getattr(package, "__version__", "an earlier one")
    if found != BUILD:
        raise RuntimeError(
            f"The extension is Rototoon {BUILD}, but the Python package in {Path(package.__file__).parent} is of another build, {found}: restart Blender. "
            "If it says this again, remove that package, or take its folder off PYTHONPATH"
        )


# Before anything is taken from the other copy.
_refuse_second_copy()
_forget_older_modules()


def _classes():
    from . import properties, ui
    from .bones.operators import CLASSES as bones
    from .capture.operators import CLASSES as capture
    from .conform.operators import CLASSES as conform
    from .exchange.operators import CLASSES as exchange
    from .farm.operators import CLASSES as farm
    from .lines.operators import CLASSES as lines
    from .paint.operators import CLASSES as paint
    from .sample.operators import CLASSES as sample
    from .strokes.operators import CLASSES as strokes
    from .style.operators import CLASSES as style
    from .tween.operators import CLASSES as tween

    own = capture + strokes + tween + lines + paint + style + bones + exchange + conform + farm + sample
    return properties.CLASSES + own + ui.CLASSES


def register():
    """Called by Blender."""
    import bpy

    _refuse_second_copy()
    from . import handlers, properties, ui

    for cls in _classes():
        bpy.utils.register_class(cls)
    properties.attach()
    handlers.register()
    for part in ui.PARTS:
        part.register()


def unregister():
    """Called by Blender."""
    import bpy
    from rototoon.native import library

    from . import handlers, properties, ui

    for part in reversed(ui.PARTS):
        part.unregister()
    handlers.unregister()
    properties.detach()
    for cls in reversed(_classes()):
        # A copy of an earlier version, which did not look for this one, may have taken the class's place.
        if cls.is_registered:
            bpy.utils.unregister_class(cls)
    # So an update can replace the library's file on Windows too. While a job or a script uses the library, it stays.
    library.release()

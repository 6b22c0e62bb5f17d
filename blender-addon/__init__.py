"""Rototoon: contours of drawn characters, followed through a film.

This file only registers. What needs Blender is imported when it does so, so that `session` and `native` can be used
without Blender.
"""


def _classes():
    from . import operators, preferences, properties, ui

    return preferences.CLASSES + properties.CLASSES + operators.CLASSES + ui.CLASSES


def register():
    """Called by Blender."""
    import bpy

    from . import clip_preview, handlers, overlay, properties

    for cls in _classes():
        bpy.utils.register_class(cls)
    properties.attach()
    handlers.register()
    overlay.register()
    clip_preview.register()


def unregister():
    """Called by Blender."""
    import bpy

    from . import clip_preview, handlers, overlay, properties

    clip_preview.unregister()
    overlay.unregister()
    handlers.unregister()
    properties.detach()
    for cls in reversed(_classes()):
        bpy.utils.unregister_class(cls)

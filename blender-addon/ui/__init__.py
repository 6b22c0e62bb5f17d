"""The user interface: panels and lists in the tab "Rototoon" of the 3D view's sidebar, overlays, previews, menus, keys, help, and preferences.

Only the extension's own `__init__.py` imports this package.

May import: every package.
"""

from . import bones, clip_preview, clips, doubts, help, keymap, lists, menus, overlay, panels, preferences, start

CLASSES = (
    preferences.CLASSES
    + lists.CLASSES
    + clips.CLASSES
    + start.CLASSES
    + panels.CLASSES
    + bones.CLASSES
    + menus.CLASSES
    + doubts.CLASSES
    + help.CLASSES
)
PARTS = (overlay, clip_preview, menus, keymap, help)
"""What is added to Blender beside classes."""

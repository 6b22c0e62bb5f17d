"""The user interface: panels and lists in the tab "Rototoon" of the 3D view's sidebar, overlays, previews, and preferences.

Only the extension's own `__init__.py` imports this package.

May import: every package.
"""

from . import bones, clips, lists, panels, preferences

CLASSES = preferences.CLASSES + lists.CLASSES + clips.CLASSES + panels.CLASSES + bones.CLASSES

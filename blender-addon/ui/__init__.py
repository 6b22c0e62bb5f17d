"""The tab "Rototoon" of the 3D view's sidebar, and the menu entries."""

from . import clips, lists, panels

CLASSES = lists.CLASSES + clips.CLASSES + panels.CLASSES

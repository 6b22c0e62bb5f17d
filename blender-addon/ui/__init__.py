"""The tab "Rototoon" of the 3D view's sidebar, and the menu entries."""

from . import lists, panels

CLASSES = lists.CLASSES + panels.CLASSES

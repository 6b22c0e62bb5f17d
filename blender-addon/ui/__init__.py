"""The tab "Rototoon" of the 3D view's sidebar, and the menu entries."""

from . import bones, clips, lists, panels

CLASSES = lists.CLASSES + clips.CLASSES + panels.CLASSES + bones.CLASSES

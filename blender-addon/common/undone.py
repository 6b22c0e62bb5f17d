"""Undo during work that follows the window's events.

Work that runs in a window swallows the keys of that window, and not those of another one. Whatever is undone there, the drawings that the work
knows may not exist any more.
"""

from __future__ import annotations

from collections.abc import Callable

import bpy


class Undone:
    """Notes whether anything is undone. `before` is called then, while Blender's data are still those that the work knows."""

    def __init__(self, before: Callable[[], None] = lambda: None):
        self.happened = False
        self._before = before
        for hooks in self._hooks():
            hooks.append(self._note)

    def stop(self) -> None:
        """Removes the handlers."""
        for hooks in self._hooks():
            if self._note in hooks:
                hooks.remove(self._note)

    def _hooks(self):
        return bpy.app.handlers.undo_pre, bpy.app.handlers.redo_pre

    def _note(self, *_args) -> None:
        if not self.happened:
            self.happened = True
            self._before()

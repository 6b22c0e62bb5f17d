"""Keys of the 3D view: a pie menu, Track and New Key Here. They are Blender's own entries, so an artist may change them."""

from __future__ import annotations

import bpy

KEYS = (
    ("wm.call_menu_pie", "R", {"name": "ROTOTOON_MT_pie"}),
    ("rototoon.track", "T", {}),
    ("rototoon.new_key", "K", {}),
)
"""Operator, key pressed with Shift and Alt, and properties. Blender leaves these free in all modes of Grease Pencil."""

_added: list[tuple[bpy.types.KeyMap, bpy.types.KeyMapItem]] = []


def register() -> None:
    """Adds the keys. Blender has no keys in background."""
    config = bpy.context.window_manager.keyconfigs.addon
    if config is None:
        return
    keymap = config.keymaps.new(name="3D View", space_type="VIEW_3D")
    for name, key, properties in KEYS:
        item = keymap.keymap_items.new(name, key, "PRESS", shift=True, alt=True)
        for prop, value in properties.items():
            setattr(item.properties, prop, value)
        _added.append((keymap, item))


def unregister() -> None:
    """Removes them."""
    for keymap, item in _added:
        keymap.keymap_items.remove(item)
    _added.clear()


def draw(layout, context) -> None:
    """The keys as Blender's preferences show them, with the artist's changes."""
    import rna_keymap_ui

    config = context.window_manager.keyconfigs.user
    keymap = config.keymaps.get("3D View") if config is not None else None
    if keymap is None:
        return
    ours = {(name, properties.get("name", "")) for name, _, properties in KEYS}
    for item in keymap.keymap_items:
        if (item.idname, getattr(item.properties, "name", "")) in ours:
            layout.context_pointer_set("keymap", keymap)
            rna_keymap_ui.draw_kmi([], config, keymap, item, layout, 0)

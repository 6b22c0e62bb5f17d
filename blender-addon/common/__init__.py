"""What operators of all packages share: base classes (`operators`), and work that does not block the window (`jobs`).

May import: `rototoon`, `blender`.
"""

"""What operators of all packages share: base classes (`operators`), work that does not block the window (`jobs`), what operators
reported (`reports`), undo meanwhile (`undone`), and closed lines (`polygons`).

May import: `rototoon`, `blender`.
"""

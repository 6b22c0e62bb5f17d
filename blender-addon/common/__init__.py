"""What operators of all packages share: base classes (`operators`), work that does not block the window (`jobs`), and what operators
reported (`reports`).

May import: `rototoon`, `blender`.
"""

"""What operators of all rooms share: base classes and polls (`operators`), and work that leaves the window alive (`jobs`).

May import: `rototoon`, `blender`.
"""

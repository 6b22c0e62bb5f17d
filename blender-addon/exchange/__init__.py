"""Exchange: project documents into Blender and out again, and contours as masks.

`files` reads, checks and writes documents, `importing` makes strokes of them, `outlines` makes masks' outlines of them.

May import: `rototoon`, `blender`, `common`, `capture`.
"""

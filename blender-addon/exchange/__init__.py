"""Exchange: project documents into Blender and out of it, and contours as masks.

`files` reads, checks and writes documents. `importing` makes strokes from a document, `traced` and `filled` make traced lines and paint
and read them. `outlines` makes outlines for masks.

May import: `rototoon`, `blender`, `common`, `capture`, `lines`, `paint`.
"""

"""Exchange: project documents into Blender and out of it, and contours as masks.

`files` reads and checks documents, and makes their text. `known_files` writes them, but not over what another program wrote. `importing` makes contours from a document, `drawn` drawings, and `filled` paint, which it also
reads. `drawn_out` reads drawings, `layers_out` those of all layers, and `without_footage` gives them
pixels. Both use `stroke_fields`, `further` and `spacings`. `outlines` makes outlines for masks.

May import: `rototoon`, `blender`, `common`, `capture`, `lines`, `paint`, `tween`.
"""

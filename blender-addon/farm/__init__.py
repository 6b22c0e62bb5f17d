"""Farm: many shots tracked elsewhere, and their results taken in.

`sending` makes documents of the scene's contours, lines and paint. `files` reads all `.blend` files of a folder, each in a Blender of its own, which
runs `read_file`. `batch` writes the batch: documents, manifest and jobs. `collecting` takes contours in, into the parts that `same_parts` finds, `tracing` lines, and `painting` paint. `engines/`
has the templates of the jobs; `rototoon job` writes the same, and a test compares them.

May import: `rototoon`, `blender`, `common`, `capture`, `exchange`, `lines`, `paint`.
"""

"""The sample: a small cartoon that this code draws, so that the first five minutes need no footage and no download.

`penguin` has the poses and outlines, `painting` makes pictures of them, `cartoon` writes the pictures and the document with the keys.

May import: `rototoon`, `blender`, `common`, `capture`, `exchange`.
"""

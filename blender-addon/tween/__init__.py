"""Tween: drawings between keys.

`charts` is what the artist chooses, `keys` tells keys from drawings between them, `sheets` lays drawings out for the library, with
`layer_pegs`, `captured` and `surroundings`. `tweening` plans, draws and finishes; `between` writes strokes. `pairs`, `pairing`,
`pair_overlay` and `label_places` are Match Strokes. `records` is what a file keeps.

May import: `rototoon`, `blender`, `common`, `capture`.
"""

"""Tween: drawings between keys.

`charts` are the artist's choices, and `spacing_parts` what a breakdown leaves of a spacing. `keys` tells keys and in-betweens apart. `sheets` lays drawings out for the library;
`layer_pegs`, `captured` and `surroundings` add pegs, captured contours and the picture. `tweening` plans, draws and finishes;
`between` writes the strokes, and `numbers` numbers them. `breakdowns` passes pairs on to in-betweens that became keys.
`pairs`, `pairing`, `doubted`, `pair_overlay` and `label_places` are Match Strokes.
`spacing_curve` is the curve in the panel. `records` are what a file keeps, and `moved_keys` lets them follow keys that are moved in time.

May import: `rototoon`, `blender`, `common`, `capture`.
"""

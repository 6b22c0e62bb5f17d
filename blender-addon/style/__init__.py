"""Style: a character's motion given to another drawing.

`limbs` makes limbs from the lines across contours. `clip_library` and `clip_browser` are the library of skeleton clips and its list.
`clip_properties` are properties of operators that use clips. `reshaping` writes drawings that follow a clip, and `picture_pieces`
cuts pictures for them. `properties` are what a file keeps.

May import: `rototoon`, `blender`, `common`, `capture`.
"""

"""Style: a character's motion given to another drawing.

`limbs` reads the lines across limbs, `clip_library` and `clip_browser` are the library of skeleton clips, `reshaping` writes drawings
that follow a clip, and `picture_pieces` cuts pictures.

May import: `rototoon`, `blender`, `common`, `capture`.
"""

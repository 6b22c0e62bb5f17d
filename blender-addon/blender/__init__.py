"""Blender's data: everything that knows how Blender keeps drawings, layers, cameras, pictures, bones and masks.

`grease_pencil` is the border to Blender's Grease Pencil API. Only this room and the operators use that API. What else the room
has: `strokes` (complete drawings as arrays), `hierarchy` (where layers hang), `camera`, `placement` and `projection` (pixels and
layer points), `footage` and `movie` (picture files), `stage` (objects to begin with), `armatures`, `actions`, `masks`, `picture_source`
and `picture_mesh`, `preferences`, and `errors` (what an artist is told).

May import: `rototoon`.
"""

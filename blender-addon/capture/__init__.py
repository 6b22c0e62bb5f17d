"""Capture: contours of drawn characters, from the footage and the artist's keys to strokes on every frame.

The way of the data: `contours` reads strokes, `correspondence` and `identity` find which stroke is which part, `corrections` finds
what the artist moved, and `document` makes a project document of it all. `sessions` keeps what the library knows of an object.
`tracking` runs Track, `live` runs it after each edit, `writing` and `snapping` put the results into strokes. `properties` is what
a file keeps.

May import: `rototoon`, `blender`, `common`.
"""

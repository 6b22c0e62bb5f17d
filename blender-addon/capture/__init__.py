"""Capture: contours of drawn characters, from footage and the artist's keys to strokes on every frame.

In the order of the data: `contours` reads strokes. `correspondence` and `identity` find the part of each stroke. `corrections`
finds what the artist moved. `document` makes a project document. `sessions` has a session of the library for each object.
`doubt` finds the weakest frame. `tracking` is one run of Track, and `live` starts a run after each edit. `writing` and `snapping` write strokes.
`set_back` says which looks a run has set back. `ends`, `exchanged`, `unseen` and
`properties` are what a file keeps.

May import: `rototoon`, `blender`, `common`.
"""

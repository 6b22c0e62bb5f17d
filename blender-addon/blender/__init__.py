"""Blender's data: drawings, layers, cameras, pictures, bones, masks.

`grease_pencil` wraps Blender's Grease Pencil API. Only this package uses that API. The other modules:

====================================  ==============================================================
`strokes`, `stroke_lines`, `colours`  complete drawings as arrays; strokes as lines; their visible colours
`stroke_rows`                         strokes that are written into a drawing
`marks`                               whether the artist has changed a generated drawing
`hierarchy`                           parents and groups of layers
`camera`, `placement`, `projection`   pixels ↔ layer points
`footage`, `movie`, `stage`           picture files, movies, and objects that show them
`picture_source`, `picture_mesh`      pictures that follow clips
`armatures`, `actions`, `masks`       bones, animation curves, masks
`frames`, `windows`, `preferences`    the current frame, the windows, the settings
`animated`                            animation curves, and values that are not keyed yet
`holds`                               frames that hold the generated drawing before them
`memo`                                answers that panels need not ask for at each redraw
`errors`                              the error that the artist sees
====================================  ==============================================================

May import: `rototoon`.
"""

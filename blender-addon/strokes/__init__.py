"""Strokes: tools for any drawing. `fitting` is Fit Strokes, `hidden` is Remove Hidden Lines.

May import: `rototoon`, `blender`, `common`, `tween`, `lines`: what Rototoon changes in an in-between or a traced stroke is no change of the artist.
"""

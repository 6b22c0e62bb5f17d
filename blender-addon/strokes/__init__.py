"""Strokes: tools for any drawing. `fitting` is Fit Strokes, `hidden` is Remove Hidden Lines.

May import: `rototoon`, `blender`, `common`, `tween`: what Rototoon changes in an in-between is no change of the artist.
"""

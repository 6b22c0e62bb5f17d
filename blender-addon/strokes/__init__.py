"""Strokes: tools for any drawing. `fitting` makes light curves, `hidden` cuts lines where other strokes cover them.

May import: `rototoon`, `blender`, `common`.
"""

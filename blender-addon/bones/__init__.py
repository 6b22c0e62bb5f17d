"""Bones: armatures that give their motion to the library, and that follow its clips.

`names` guesses the bones of key points. `key_points` has the artist's choices, and samples postures. `driving` turns bones.
`properties` are what a file keeps.

May import: `rototoon`, `blender`, `common`, `style`.
"""

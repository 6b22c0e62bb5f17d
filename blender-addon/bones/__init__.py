"""Bones: armatures that give their motion to the library, and that follow its clips.

`names` guesses which bones are key points, `key_points` reads their places, `driving` turns bones.

May import: `rototoon`, `blender`, `common`, `style`.
"""

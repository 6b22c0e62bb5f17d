"""The native library: loading, prototypes, owned handles, errors. Imports nothing of Blender.

`_bindings` is generated from the C header; nothing outside this package calls a C function itself.
"""

"""The native library: loading, prototypes, owned handles, errors.

`_bindings` is generated from the C header. Only this package calls C functions.
"""

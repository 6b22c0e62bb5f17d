"""Exceptions of the package."""


class RototoonError(Exception):
    """Bad input, a missing picture, a busy session, ... The message names it and says what was expected."""


class LibraryError(RototoonError):
    """The native library is missing, cannot be loaded, or does not fit this Python package."""


class Cancelled(Exception):
    """The progress callback stopped the work. Nothing was changed."""

"""What can go wrong, as exceptions."""


class RototoonError(Exception):
    """Bad input, a missing picture, a busy session, ...; the message says which and what was expected."""


class LibraryError(RototoonError):
    """The native library is not there, cannot be loaded, or does not fit this Python package."""


class Cancelled(Exception):
    """The progress callback asked to stop; nothing was changed."""

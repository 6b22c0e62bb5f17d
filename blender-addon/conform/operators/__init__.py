"""The operators of conforming."""

from . import conform

CLASSES = conform.CLASSES
"""All of them, to register."""

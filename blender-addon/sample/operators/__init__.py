"""The operators of this package, one a file."""

from . import open_sample

CLASSES = open_sample.CLASSES

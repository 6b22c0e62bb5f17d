"""The operators of this package, one a file."""

from . import collect_results, send_to_farm

_MODULES = (send_to_farm, collect_results)

CLASSES = tuple(cls for module in _MODULES for cls in module.CLASSES)

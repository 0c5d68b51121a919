"""A contact as an element of a time integration: states in, forces, tangents and status out; accepted states as start.

`ContactElement` serves the vehicle of this package and, as `wheelrail.Wheelset(...).element()`, programs of others.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

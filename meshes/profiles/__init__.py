"""Wheel and rail profiles: standard ones by name, measured ones from files, both checked.

`load_profile` takes a name or a file and returns a `Profile`.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

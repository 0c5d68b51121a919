"""Contact forces from a table: compiled look-up in place of a solve, for runs and for other programs.

`TableContact` is the model, `ForceTable` its data; tables are made by `wheelrail.contact.tables`.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

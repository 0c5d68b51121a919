"""Construction of tables of contact forces: nodes refined where a contact model and the table differ.

`TableBuilder` makes the `ForceTable` of one side within a `TableRange`; its solves are tasks, which may run in other
processes.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

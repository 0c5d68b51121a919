"""Wear and fatigue of profiles by contact: laws by cell, and rates along the arc length of wheel and rail.

A law gives the removed volume of a cell per contact area and length of travel (`laws`); cells are summed to strips,
balanced to the frictional power of their patch, and put on the cells of a profile with their volume (`strips`), beside
measures of fatigue (`fatigue`).
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

"""Depth of a contact pair, or position of a wheelset, at which given loads are carried.

`find_depth_for_load` searches the depth of one pair or of a whole wheelset; `hertz_under_load` is for quadrics,
`wheel_under_load`, `wheels_under_load` and `axle_under_load` are for a wheelset on its rails, `FlexibleWheelset` for
one whose axle bends on rails that move on their pads.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

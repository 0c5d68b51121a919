"""Contact of two elastic bodies: a pose and rigid motions in; forces, patches and fields out.

A contact model is built from surfaces, compliances and laws (`models`), and called with a pose and a motion
(`kinematics`); it returns a result (`results`). Loads are reached by a search over the depth (`loading`). Stresses
below the surface (`stress`) and closed-form solutions (`analytical`) are independent of the models.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

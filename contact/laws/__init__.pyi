from .material import Steel as Steel
from .parameters import FallingFriction as FallingFriction
from .parameters import Laws as Laws

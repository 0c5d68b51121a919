from .curve import Curve as Curve

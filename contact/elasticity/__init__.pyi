from .compliance import Compliance as Compliance
from .solid_compliance import SurfaceCompliance as SurfaceCompliance

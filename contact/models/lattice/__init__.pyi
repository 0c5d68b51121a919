from .model import LatticeContact as LatticeContact
from .resolution import LatticeResolution as LatticeResolution

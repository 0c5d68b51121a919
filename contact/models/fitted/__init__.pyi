from .model import FittedContact as FittedContact
from .resolution import Fineness as Fineness

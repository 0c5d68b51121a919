from .model import FittedContact as FittedContact
from .resolution import Resolution as Resolution

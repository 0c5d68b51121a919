from .model import FullContact as FullContact

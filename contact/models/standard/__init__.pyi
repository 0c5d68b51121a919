from .model import StandardContact as StandardContact

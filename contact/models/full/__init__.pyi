from .model import Full as Full

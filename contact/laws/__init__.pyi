from .material import Material as Material
from .parameters import ContactLaws as ContactLaws
from .parameters import FallingFriction as FallingFriction

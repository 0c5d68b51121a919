from .bodies import block_waveguide as block_waveguide
from .bodies import profile_waveguide as profile_waveguide
from .compliance import WaveguideCompliance as WaveguideCompliance

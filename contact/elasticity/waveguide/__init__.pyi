from .bodies import block_waveguide as block_waveguide
from .bodies import rail_waveguide as rail_waveguide
from .bodies import wheel_waveguide as wheel_waveguide
from .compliance import WaveguideCompliance as WaveguideCompliance

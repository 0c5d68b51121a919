from .outlines import rail_outline as rail_outline
from .outlines import wheel_outline as wheel_outline
from .solids import block as block
from .solids import profiled as profiled
from .wheel_web import WheelShape as WheelShape

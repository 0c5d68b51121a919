from .outlines import rail_outline as rail_outline
from .outlines import wheel_outline as wheel_outline
from .solids import block as block
from .solids import rail as rail
from .solids import wheel as wheel
from .wheel_web import WheelShape as WheelShape

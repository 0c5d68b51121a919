from .bodies.outlines import rail_outline as rail_outline
from .bodies.outlines import wheel_outline as wheel_outline
from .bodies.wheel_web import WheelShape as WheelShape
from .profiles.library import load_profile as load_profile
from .profiles.named import named_profile as named_profile
from .profiles.profile import Profile as Profile
from .profiles.reader import read_profile as read_profile

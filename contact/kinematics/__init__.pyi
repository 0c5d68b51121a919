from .creepage import NotRolling as NotRolling
from .frames import Pose as Pose
from .frames import RigidMotion as RigidMotion
from .frames import Twist as Twist
from .hertz_state import HertzState as HertzState
from .wheelset_state import Mounting as Mounting
from .wheelset_state import WheelsetState as WheelsetState

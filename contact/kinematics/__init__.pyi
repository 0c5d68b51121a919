from .creepage import NotRolling as NotRolling
from .frames import Motion as Motion
from .frames import Pose as Pose
from .frames import Twist as Twist
from .wheelset_state import Mounting as Mounting
from .wheelset_state import WheelsetState as WheelsetState

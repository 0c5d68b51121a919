from .alignment import Segment as Segment
from .irregularity import Irregularities as Irregularities
from .speed_profile import SpeedProfile as SpeedProfile
from .track import Track as Track

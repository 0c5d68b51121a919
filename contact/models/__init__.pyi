from .builders import hertz_pair as hertz_pair
from .builders import wheel_rail_pair as wheel_rail_pair
from .condensed import CondensedContact as CondensedContact
from .fitted.model import FittedContact as FittedContact
from .full.model import FullContact as FullContact
from .standard.model import StandardContact as StandardContact
from .wheelset import ContactModel as ContactModel
from .wheelset import WheelsetContact as WheelsetContact

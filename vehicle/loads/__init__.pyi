from .applied_loads import AppliedLoads as AppliedLoads
from .applied_loads import BodyForce as BodyForce
from .applied_loads import WheelsetTorque as WheelsetTorque
from .load_table import LoadTable as LoadTable

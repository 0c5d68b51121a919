from .profile_pair import WheelRail as WheelRail
from .quadric_pair import Quadrics as Quadrics
from .rigid_surfaces import RigidQuadrics as RigidQuadrics
from .rigid_surfaces import RigidWheelRail as RigidWheelRail
from .surface_grid import ContactGrid as ContactGrid
